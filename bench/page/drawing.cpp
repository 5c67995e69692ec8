#include "bench/page/drawing.h"

#include <algorithm>
#include <cmath>

#include "bench/page/camera.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

constexpr double margin = 14, disc = 9.5;  // [user units]

const char* const joint_mark = "M-2.6,0a2.6,2.6 0 1,0 5.2,0a2.6,2.6 0 1,0 -5.2,0z";
const char* const ring_mark = "M-4.6,0a4.6,4.6 0 1,0 9.2,0a4.6,4.6 0 1,0 -9.2,0z";
const char* const contact_mark = "M0,0l3.4,6h-6.8z";
const char* const end_mark = "M0,-4.2l4.2,4.2l-4.2,4.2l-4.2,-4.2z";

/// World poses of the bodies of a scene.
std::vector<Pose<double>> world_poses(const Scene& scene) {
  Poses<double> relative;
  poses(scene.model, scene.q, relative);
  std::vector<Pose<double>> out;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i)
    out.push_back({relative.rotation[i],
                   relative.position[i] + relative.reference[static_cast<std::size_t>(relative.tree[i])]});
  return out;
}

struct Surface {
  double nearness;
  std::vector<Patch> patches;
  std::string style;
};

struct Mark {
  Point at;
  const char *path, *style;
};

struct Line {
  Point from, to;
  std::string style;
};

struct Label {
  Point anchor, at;  // on paper, then in user units
  std::string text;
};

/// Moves labels off each other, none far from its anchor, all within [disc, high]. Same input, same places.
void spread(std::vector<Label>& labels, const Point& high) {
  for (int step = 0; step < 300; ++step) {
    for (std::size_t i = 0; i < labels.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        Point apart = labels[i].at - labels[j].at;
        const double distance = apart.norm(), wanted = 2 * disc + 2;
        if (distance >= wanted) continue;
        if (distance < 1e-6) apart = Point(std::cos(static_cast<double>(i)), std::sin(static_cast<double>(i)));
        const Point move = 0.5 * (wanted - distance) * apart.normalized();
        labels[i].at += move;
        labels[j].at -= move;
      }
    for (Label& l : labels) {
      if (step < 250) l.at += 0.02 * (l.anchor - l.at);
      l.at = l.at.cwiseMax(Point(disc + 1, disc + 1)).cwiseMin(high);
    }
  }
}

/// Collects what is to be drawn, then writes it in the order far to near, marks last.
class Picture {
 public:
  Picture(const Scene& scene, const Annotation& annotation)
      : scene_(scene), annotation_(annotation), pose_(world_poses(scene)), camera_(Camera::from(-0.95, 0.36)) {
    for (std::size_t i = 0; i < pose_.size(); ++i) add_body(i);
    add_standing();
    for (const Constraint& c : scene.model.constraints) add_constraint(c);
    std::stable_sort(surfaces_.begin(), surfaces_.end(),
                     [](const Surface& a, const Surface& b) { return a.nearness < b.nearness; });
    frame();
    add_labels();
  }

  std::string svg() const {
    const double top = annotation_.header_height;
    std::string s = format("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"picture\" role=\"img\" viewBox=\"0 %.0f %.0f %.0f\" "
                           "aria-label=\"", top > 0 ? -top : 0, picture_width, height_ + top) +
                    escape("Picture of the scene " + scene_.name) + "\">" + annotation_.header;
    if (scene_.has_ground) s += ground_lines();
    for (const Surface& surface : surfaces_)
      for (const Patch& p : surface.patches) s += polygon(p, surface.style);
    for (const Line& l : lines_) s += line(l);
    for (const Mark& m : marks_) s += mark(m);
    for (const Label& l : labels_) s += leader(l);
    for (const Label& l : labels_) s += label(l);
    return s + scale_bar() + "</svg>";
  }

 private:
  void add_body(std::size_t i) {
    const Body& body = scene_.model.bodies[i];
    const std::string style = annotation_.bodies.empty() ? "" : " " + annotation_.bodies[i].style;
    for (const Shape& shape : body.shapes) {
      const Pose<double> at = pose_[i] * shape.placement;
      surfaces_.push_back({camera_.nearness(at.translation), patches(shape, at, camera_), style});
    }
    const Point here = camera_(pose_[i].translation);
    corners_.push_back(here);
    const bool free = body.joint.type == JointType::floating;
    if (!free) marks_.push_back({here, joint_mark, "joint"});
    if (body.parent != ground) lines_.push_back({camera_(pose_[static_cast<std::size_t>(body.parent)].translation), here, "link" + style});
    if (body.shapes.empty() && body.com.norm() > 0) lines_.push_back({here, camera_(pose_[i] * body.com), "link" + style});
  }

  void add_standing() {
    for (const Standing& s : scene_.motion.search.standing)
      surfaces_.push_back({camera_.nearness(s.shape.placement.translation), patches(s.shape, s.shape.placement, camera_), ""});
  }

  Point end_point(const Frame& f) const {
    return camera_(f.body == ground ? f.placement.translation
                                    : pose_[static_cast<std::size_t>(f.body)] * f.placement.translation);
  }

  /// A link from its joint to the point that is held: what has no shape, or none there, reaches that far.
  void add_reach(const Frame& f) {
    if (f.body == ground) return;
    const auto i = static_cast<std::size_t>(f.body);
    const Body& body = scene_.model.bodies[i];
    if (!body.shapes.empty() && body.joint.type == JointType::floating) return;
    lines_.push_back({camera_(pose_[i].translation), end_point(f), "link" + (annotation_.bodies.empty() ? "" : " " + annotation_.bodies[i].style)});
  }

  void add_constraint(const Constraint& c) {
    using Kind = Constraint::Kind;
    if (c.kind == Kind::coupling || c.kind == Kind::general) return;
    if (!acts_on_joint(c.kind))
      for (const Frame* f : {&c.a, &c.b}) add_reach(*f);
    if (acts_on_joint(c.kind)) {
      const Point at = camera_(pose_[static_cast<std::size_t>(c.a.body)].translation);
      marks_.push_back({at, ring_mark, "friction"});
    } else if (c.kind == Kind::contact) {
      marks_.push_back({end_point(c.a.body == ground ? c.b : c.a), contact_mark, "contact"});
    } else {
      lines_.push_back({end_point(c.a), end_point(c.b), "loop"});
      for (const Frame* f : {&c.a, &c.b}) marks_.push_back({end_point(*f), end_mark, "loop"});
    }
  }

  /// Chooses the scale so that everything fits the width, and the height that follows.
  void frame() {
    for (const Surface& s : surfaces_)
      for (const Patch& p : s.patches) corners_.insert(corners_.end(), p.outline.begin(), p.outline.end());
    for (const Mark& m : marks_) corners_.push_back(m.at);
    if (corners_.empty()) corners_.push_back({0, 0});
    low_ = high_ = corners_.front();
    for (const Point& p : corners_) low_ = low_.cwiseMin(p), high_ = high_.cwiseMax(p);
    const Point size = (high_ - low_).cwiseMax(Point::Constant(1e-3));
    scale_ = std::min((picture_width - 2 * margin) / size.x(), (340 - 2 * margin) / size.y());
    shift_ = {picture_width / 2 - scale_ * (low_.x() + high_.x()) / 2, margin - scale_ * low_.y()};
    height_ = std::max(90.0, scale_ * size.y() + 2 * margin + 26);
    if (scale_ * size.y() < 40) shift_.y() += 20;
  }

  /// At the middle of the body's primitives, or its centre of mass.
  void add_labels() {
    for (std::size_t i = 0; i < annotation_.bodies.size(); ++i) {
      if (annotation_.bodies[i].label.empty()) continue;
      const Body& body = scene_.model.bodies[i];
      Vector3<double> middle = body.shapes.empty() ? body.com : Vector3<double>::Zero();
      for (const Shape& shape : body.shapes) middle += shape.placement.translation / static_cast<double>(body.shapes.size());
      const Point at = paper(camera_(pose_[i] * middle));
      labels_.push_back({at, at, annotation_.bodies[i].label});
    }
    spread(labels_, Point(picture_width - disc - 1, height_ - disc - 22));
  }

  Point paper(const Point& p) const { return scale_ * p + shift_; }

  std::string path(const Outline& outline, bool closed) const {
    std::string d;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Point p = paper(outline[i]);
      d += format("%c%.1f,%.1f", i ? 'L' : 'M', p.x(), p.y());
    }
    return closed ? d + "z" : d;
  }

  std::string polygon(const Patch& p, const std::string& style) const {
    return format("<path class=\"t%d%s\" d=\"", p.tone, style.c_str()) + path(p.outline, true) + "\"/>";
  }
  std::string line(const Line& l) const {
    return "<path class=\"" + l.style + "\" d=\"" + path({l.from, l.to}, false) + "\"/>";
  }
  std::string mark(const Mark& m) const {
    const Point p = paper(m.at);
    return format("<path class=\"%s\" transform=\"translate(%.1f %.1f)\" d=\"%s\"/>", m.style, p.x(), p.y(), m.path);
  }

  std::string leader(const Label& l) const {
    if ((l.at - l.anchor).norm() < disc) return "";
    return format("<path class=\"leader\" d=\"M%.1f,%.1fL%.1f,%.1f\"/>", l.anchor.x(), l.anchor.y(), l.at.x(), l.at.y());
  }
  std::string label(const Label& l) const {
    return format("<circle class=\"disc\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/><text class=\"disc\" x=\"%.1f\" y=\"%.1f\">",
                  l.at.x(), l.at.y(), disc, l.at.x(), l.at.y() + 4.5) + escape(l.text) + "</text>";
  }

  /// Lines on the plane of the ground below everything that is drawn.
  std::string ground_lines() const {
    Eigen::Vector2d low(1e300, 1e300), high = -low;
    for (const Pose<double>& p : pose_) {
      low = low.cwiseMin(p.translation.head<2>());
      high = high.cwiseMax(p.translation.head<2>());
    }
    if (pose_.empty()) return "";
    const double reach = 0.18 * (high - low).maxCoeff() + 0.15 / std::max(scale_ / 400, 0.2);
    low.array() -= reach, high.array() += reach;
    const double step = std::pow(2.0, std::round(std::log2((high - low).maxCoeff() / 8)));
    std::string d;
    const double z = scene_.ground_height;
    const auto stroke = [&](double x0, double y0, double x1, double y1) {
      d += path({camera_({x0, y0, z}), camera_({x1, y1, z})}, false);
    };
    for (double x = std::ceil(low.x() / step) * step; x <= high.x(); x += step) stroke(x, low.y(), x, high.y());
    for (double y = std::ceil(low.y() / step) * step; y <= high.y(); y += step) stroke(low.x(), y, high.x(), y);
    return "<path class=\"ground\" d=\"" + d + "\"/>";
  }

  /// A bar of 1, 2 or 5 times a power of ten metres, valid in every direction parallel to the paper.
  std::string scale_bar() const {
    const double most = 90 / scale_;
    double length = std::pow(10.0, std::floor(std::log10(most)));
    if (5 * length <= most) length *= 5;
    else if (2 * length <= most) length *= 2;
    const double y = height_ - 8;
    return format("<path class=\"scale\" d=\"M%.1f,%.1fv4h%.1fv-4\"/>", margin, y - 4, length * scale_) +
           format("<text class=\"scale\" x=\"%.1f\" y=\"%.1f\">%g m</text>", margin + length * scale_ + 6, y, length);
  }

  const Scene& scene_;
  const Annotation& annotation_;
  const std::vector<Pose<double>> pose_;
  const Camera camera_;
  std::vector<Surface> surfaces_;
  std::vector<Line> lines_;
  std::vector<Mark> marks_;
  std::vector<Label> labels_;
  std::vector<Point> corners_;
  Point low_{0, 0}, high_{0, 0}, shift_{0, 0};
  double scale_ = 1, height_ = 100;
};

}  // namespace

std::string draw(const Scene& scene, const Annotation& annotation) { return Picture(scene, annotation).svg(); }

std::string drawing_legend() {
  const auto entry = [](const std::string& body, const char* text) {
    return "<li><svg class=\"picture key\" viewBox=\"-12 -7 24 14\" aria-hidden=\"true\">" + body + "</svg> " + text + "</li>";
  };
  const auto mark = [](const char* style, const char* d) {
    return "<path class=\"" + std::string(style) + "\" d=\"" + d + "\"/>";
  };
  return "<ul class=\"legend\">" + entry("<path class=\"t2\" d=\"M-9,-5h18v10h-18z\"/>", "collision primitive") +
         entry("<path class=\"link\" d=\"M-11,0h22\"/>" + mark("joint", joint_mark), "joint and link") +
         entry(mark("joint", joint_mark) + mark("friction", ring_mark), "joint with friction rows") +
         entry("<g transform=\"translate(0 -3)\">" + mark("contact", contact_mark) + "</g>", "contact point") +
         entry("<path class=\"loop\" d=\"M-11,0h22\"/>" + mark("loop", end_mark), "loop closure or other constraint") +
         "</ul>";
}

}  // namespace delassus::bench
