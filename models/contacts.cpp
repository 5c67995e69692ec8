#include "models/contacts.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include <Eigen/Geometry>

#include "models/shapes/box_contacts.h"
#include "models/shapes/capsule_box.h"
#include "models/shapes/convex_contacts.h"
#include "models/shapes/farthest.h"
#include "models/shapes/hull.h"
#include "models/shapes/near_pairs.h"
#include "models/shapes/segments.h"

namespace delassus {

/// Of each hull its surface, where one is found.
struct HullSurfaces {
  struct Entry {
    std::shared_ptr<const std::vector<Vector3<double>>> points;
    Polytope surface;
  };
  std::vector<Entry> all;  // by address of the points
};

namespace {

using V3 = Vector3<double>;

/// A primitive at the configuration; positions from the reference point of its tree, the world's origin for what stands.
struct Placed {
  Index body;
  const Shape* shape;
  Pose<double> pose;
  double radius;        // of a sphere around pose.translation that holds the shape
  Index number;         // among the shapes of its body
  Index standing = -1;  // its number there
};

double bounding_radius(const Shape& s) {
  switch (s.kind) {
    case Shape::Kind::sphere: return s.size[0];
    case Shape::Kind::capsule: return s.size[0] + s.size[1];
    case Shape::Kind::cylinder: return std::hypot(s.size[0], s.size[1]);
    case Shape::Kind::box:
    case Shape::Kind::hull: return s.size.norm();
  }
  return 0;
}

V3 reference_of(const Poses<double>& poses, Index body) {
  return body == ground ? V3(V3::Zero()) : poses.reference[static_cast<std::size_t>(poses.tree[static_cast<std::size_t>(body)])];
}

double margin_of(const ContactSearch& s, Index body) { return s.ahead.empty() || body == ground ? s.margin : s.margin + s.ahead[static_cast<std::size_t>(body)]; }
double margin_of(const ContactSearch& s, Index a, Index b) { return std::max(margin_of(s, a), margin_of(s, b)); }

bool rests(const ContactSearch& s, Index body) { return body == ground || (s.resting != nullptr && (*s.resting)[static_cast<std::size_t>(body)] != 0); }

/// By the shapes of two bodies (the plane is none), and the place among those they share.
Index feature_of(const Placed& a, const Placed* b, std::size_t place) {
  return (a.number << 40) + ((b == nullptr ? 0 : b->number + 1) << 20) + static_cast<Index>(place);
}

double smaller_friction(double a, double b) { return a < 0 ? b : b < 0 ? a : std::min(a, b); }

/// Lowest points of a shape, candidates only: the caller drops those above the margin.
std::vector<V3> low_points(const Placed& p, double margin) {
  const V3 &size = p.shape->size, down(0, 0, -1);
  const V3 axis = p.pose.rotation.col(2);
  std::vector<V3> out;
  switch (p.shape->kind) {
    case Shape::Kind::sphere: return {p.pose.translation + size[0] * down};
    case Shape::Kind::capsule:
      for (const double s : {-1.0, 1.0}) out.push_back(p.pose.translation + s * size[1] * axis + size[0] * down);
      return out;
    case Shape::Kind::box:
      for (int k = 0; k < 8; ++k)
        out.push_back(p.pose * V3(k & 1 ? size[0] : -size[0], k & 2 ? size[1] : -size[1], k & 4 ? size[2] : -size[2]));
      return out;
    case Shape::Kind::hull:
      for (const V3& x : *p.shape->points) out.push_back(p.pose * x);
      return out;
    case Shape::Kind::cylinder: break;
  }
  const V3 slope = down - axis.dot(down) * axis;  // towards the lowest point of a rim
  const bool flat = 2 * size[0] * slope.norm() <= margin;  // the whole rim is near; its lowest point is among the four
  const V3 u = slope.norm() <= 1e-6 ? V3(p.pose.rotation.col(0)) : V3(slope.normalized());
  for (const double s : {-1.0, 1.0}) {
    const V3 centre = p.pose.translation + s * size[1] * axis;
    out.push_back(centre + size[0] * u);
    if (!flat) continue;
    const V3 v = axis.cross(u);
    for (const V3& w : {v, V3(-u), V3(-v)}) out.push_back(centre + size[0] * w);
  }
  return out;
}

/// Shapes of zero thickness, length or radius give the same point more than once.
void drop_repeated(std::vector<ContactPoint>& found) {
  std::vector<ContactPoint> out;
  for (const ContactPoint& c : found)
    if (std::none_of(out.begin(), out.end(), [&](const ContactPoint& o) { return o.point == c.point && o.gap == c.gap; })) out.push_back(c);
  found = std::move(out);
}

/// Those that reach farthest, in the order found.
void keep_farthest(std::vector<ContactPoint>& found) {
  std::vector<V3> at;
  std::vector<double> gap;
  for (const ContactPoint& c : found) at.push_back(c.point), gap.push_back(c.gap);
  std::vector<ContactPoint> out;
  for (const std::size_t i : farthest(at, gap)) out.push_back(found[i]);
  found = std::move(out);
}

void ground_contacts(const Placed& p, double height, double margin, std::vector<ContactPoint>& out) {
  if (p.pose.translation[2] - (1 + 1e-12) * p.radius > height + margin) return;
  std::vector<ContactPoint> found;
  for (V3 x : low_points(p, margin)) {
    const double gap = x[2] - height;
    if (gap > margin) continue;
    x[2] = height;
    found.push_back({p.body, ground, x, {0, 0, 1}, gap, p.shape->friction});
  }
  drop_repeated(found);
  if (found.size() > 4 && p.shape->kind == Shape::Kind::hull) {
    keep_farthest(found);
  } else if (found.size() > 4) {  // the 4 deepest, in the order found
    std::vector<double> gaps;
    for (const ContactPoint& c : found) gaps.push_back(c.gap);
    std::nth_element(gaps.begin(), gaps.begin() + 3, gaps.end());
    std::size_t kept = 0;
    std::erase_if(found, [&](const ContactPoint& c) { return c.gap > gaps[3] || ++kept > 4; });
  }
  for (std::size_t k = 0; k < found.size(); ++k) found[k].feature = feature_of(p, nullptr, k);
  out.insert(out.end(), found.begin(), found.end());
}

/// Half the axis of a sphere (zero) or capsule.
V3 half_axis(const Placed& p) {
  return p.shape->kind == Shape::Kind::capsule ? V3(p.shape->size[1] * p.pose.rotation.col(2)) : V3::Zero();
}

std::vector<ShapeContact> round_round(const Placed& a, const Placed& b, const V3& shift) {
  const V3 u = half_axis(a), v = half_axis(b), q0 = b.pose.translation + shift;
  const auto [s, t] = closest_on_segments(a.pose.translation, u, q0, v);
  const V3 p = a.pose.translation + s * u, q = q0 + t * v, d = p - q;
  const double distance = d.norm(), gap = distance - a.shape->size[0] - b.shape->size[0];
  const V3 n = distance > 0 ? V3(d / distance) : V3(0, 0, 1);
  return {{q + (b.shape->size[0] + gap / 2) * n, n, gap}};
}

const Polytope* surface_of(const HullSurfaces& hulls, const Shape& s) {
  const auto it = std::lower_bound(hulls.all.begin(), hulls.all.end(), s.points, [](const auto& e, const auto& points) { return e.points < points; });
  return it != hulls.all.end() && it->points == s.points ? &it->surface : nullptr;
}

ConvexShape convex(const Placed& p, const V3& shift, const HullSurfaces& hulls) {
  const V3& size = p.shape->size;
  const Pose<double> at{p.pose.rotation, p.pose.translation + shift};
  switch (p.shape->kind) {
    case Shape::Kind::cylinder: return placed_cylinder(size[0], size[1], at);
    case Shape::Kind::sphere: return placed(segment_polytope(0), at, size[0]);
    case Shape::Kind::capsule: return placed(segment_polytope(size[1]), at, size[0]);
    case Shape::Kind::box: return placed(box_polytope(size), at, 0);
    case Shape::Kind::hull: break;
  }
  return placed(*surface_of(hulls, *p.shape), at, 0);
}

bool is(const Placed& p, Shape::Kind kind) { return p.shape->kind == kind; }

/// Contacts of a pair; `shift` takes positions of b's tree into a's.
std::vector<ShapeContact> pair_contacts(const Placed& a, const Placed& b, const V3& shift, double margin, const HullSurfaces& hulls) {
  for (const Shape::Kind kind : {Shape::Kind::cylinder, Shape::Kind::hull})
    if (is(a, kind) || is(b, kind)) return convex_contacts(convex(a, V3::Zero(), hulls), convex(b, shift, hulls), margin);
  const bool box_a = a.shape->kind == Shape::Kind::box, box_b = b.shape->kind == Shape::Kind::box;
  const PlacedBox A{a.shape->size, a.pose}, B{b.shape->size, {b.pose.rotation, b.pose.translation + shift}};
  if (box_a && box_b) return box_box(A, B, margin);
  if (!box_a && !box_b) return round_round(a, b, shift);
  const Placed& round = box_a ? b : a;
  const V3 centre = round.pose.translation + (box_a ? shift : V3::Zero());
  const PlacedBox& box = box_a ? A : B;
  std::vector<ShapeContact> out;
  if (round.shape->kind == Shape::Kind::sphere)
    out.push_back(sphere_box(centre, round.shape->size[0], box));
  else
    out = capsule_box(centre, half_axis(round), round.shape->size[0], box, margin);
  if (box_a)
    for (ShapeContact& c : out) c.normal = -c.normal;
  return out;
}

/// Bounding spheres, in the world.
std::vector<Ball> balls_of(const std::vector<Placed>& shapes, const Poses<double>& poses, const ContactSearch& search) {
  std::vector<Ball> out;
  out.reserve(shapes.size());
  for (const Placed& p : shapes) {
    const Index object = p.body == ground ? search.standing[static_cast<std::size_t>(p.standing)].object : search.object.empty() ? 0 : search.object[static_cast<std::size_t>(p.body)];
    out.push_back({reference_of(poses, p.body) + p.pose.translation, p.radius, margin_of(search, p.body), object, rests(search, p.body)});
  }
  return out;
}

}  // namespace

Matrix3<double> frame_about(const Vector3<double>& z) {
  const V3 helper = std::abs(z[1]) < 0.9 ? V3::UnitY() : V3::UnitZ();
  const V3 x = helper.cross(z).normalized();
  Matrix3<double> out;
  out << x, z.cross(x), z;
  return out;
}

Pose<double> world_pose(const Poses<double>& poses, Index body) {
  if (body == ground) return {};
  const auto i = static_cast<std::size_t>(body);
  return {poses.rotation[i], reference_of(poses, body) + poses.position[i]};
}

Pose<double> relative_pose(const Poses<double>& poses, Index in, Index body) {
  if (in == ground) return world_pose(poses, body);
  if (body == ground) return world_pose(poses, in).inverse();
  const auto i = static_cast<std::size_t>(in), j = static_cast<std::size_t>(body);
  const V3 shift = reference_of(poses, body) - reference_of(poses, in);
  const Matrix3<double> Rt = poses.rotation[i].transpose();
  return {Rt * poses.rotation[j], Rt * (shift + (poses.position[j] - poses.position[i]))};
}

std::shared_ptr<const HullSurfaces> hull_surfaces(const Model& model, const std::vector<Standing>& standing) {
  auto out = std::make_shared<HullSurfaces>();
  const auto add = [&](const Shape& s) {
    if (s.kind != Shape::Kind::hull || !has_hulls()) return;
    try {
      out->all.push_back({s.points, hull_polytope(*s.points)});
    } catch (const std::runtime_error&) {  // counted where it is near something
    }
  };
  for (const Body& body : model.bodies)
    for (const Shape& s : body.shapes) add(s);
  for (const Standing& s : standing) add(s.shape);
  std::sort(out->all.begin(), out->all.end(), [](const auto& a, const auto& b) { return a.points < b.points; });
  return out;
}

bool floats(const Model& model, Index body) {
  const auto of = [&](Index i) -> const Body& { return model.bodies[static_cast<std::size_t>(i)]; };
  while (of(body).parent != ground) body = of(body).parent;
  return of(body).joint.type == JointType::floating;
}

std::vector<std::pair<Index, Index>> neighbours(const Model& model, const std::vector<Index>& object, const std::vector<Standing>& standing) {
  std::vector<std::pair<Index, Index>> out;
  const auto body = [&](Index i) -> const Body& { return model.bodies[static_cast<std::size_t>(i)]; };
  const auto with_shapes = [&](Index i) {
    while (i != ground && body(i).shapes.empty()) i = body(i).parent;
    return i;
  };
  const auto take = [&](Index i, Index j) {
    i = with_shapes(i), j = with_shapes(j);
    if (i == j) return;
    if (i == ground || j == ground) {
      const Index moving = std::max(i, j), of = object[static_cast<std::size_t>(moving)];
      if (!floats(model, moving) && std::any_of(standing.begin(), standing.end(), [&](const Standing& s) { return s.object == -1 - of; })) out.emplace_back(-1 - of, moving);
    } else if (object[static_cast<std::size_t>(i)] == object[static_cast<std::size_t>(j)]) {
      out.push_back(std::minmax(i, j));
    }
  };
  for (Index i = 0; i < static_cast<Index>(model.bodies.size()); ++i) take(i, body(i).parent);
  for (const Constraint& c : model.constraints)
    if (c.kind != Constraint::Kind::contact) take(c.a.body, c.b.body);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<ContactPoint> find_contacts(const Model& model, const Poses<double>& poses, const ContactSearch& search,
                                        std::vector<std::string>& notes) {
  std::vector<Placed> shapes;
  shapes.reserve(model.bodies.size() + search.standing.size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    for (const Shape& s : model.bodies[i].shapes)
      shapes.push_back({static_cast<Index>(i), &s, Pose<double>{poses.rotation[i], poses.position[i]} * s.placement, bounding_radius(s), &s - model.bodies[i].shapes.data()});
  const std::size_t moving = shapes.size();
  for (const Standing& s : search.standing) {
    const Index k = &s - search.standing.data();
    shapes.push_back({ground, &s.shape, s.shape.placement, bounding_radius(s.shape), k, k});
  }
  std::vector<ContactPoint> out;
  if (search.ground)
    for (const Placed& p : std::span(shapes).first(moving))
      if (!rests(search, p.body)) ground_contacts(p, search.ground_height - reference_of(poses, p.body)[2], margin_of(search, p.body), out);
  const std::shared_ptr<const HullSurfaces> hulls = search.hulls != nullptr ? search.hulls : hull_surfaces(model, search.standing);
  const auto who = [&](const Placed& p) { return p.body == ground ? search.standing[static_cast<std::size_t>(p.standing)].object : p.body; };
  Index without_surface = 0;
  for (const auto& [i, j] : near_pairs(balls_of(shapes, poses, search))) {
    const Placed &a = shapes[i], &b = shapes[j];
    if (std::binary_search(search.apart.begin(), search.apart.end(), std::pair<Index, Index>(std::minmax(who(a), who(b))))) continue;
    const auto lacks = [&](const Placed& p) { return is(p, Shape::Kind::hull) && surface_of(*hulls, *p.shape) == nullptr; };
    if (lacks(a) || lacks(b)) {
      ++without_surface;
      continue;
    }
    const V3 shift = reference_of(poses, b.body) - reference_of(poses, a.body);
    const double margin = margin_of(search, a.body, b.body);
    std::size_t place = 0;
    for (const ShapeContact& c : pair_contacts(a, b, shift, margin, *hulls))
      if (c.gap <= margin)
        out.push_back({a.body, b.body, c.point, c.normal, c.gap, smaller_friction(a.shape->friction, b.shape->friction), b.standing, feature_of(a, &b, place++)});
  }
  if (without_surface > 0) notes.push_back(std::to_string(without_surface) + " near pairs with a mesh were not tested for contact: qhull finds no surface of it");
  return out;
}

}  // namespace delassus
