#include "models/sdf.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "models/contacts.h"
#include "models/inertia_check.h"
#include "models/message.h"
#include "models/parts.h"
#include "models/sdf_document.h"
#include "models/tally.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;
using Type = SdfDocument::Type;
using Kind = Constraint::Kind;

std::size_t z(Index i) { return static_cast<std::size_t>(i); }

std::string element_of(const SdfDocument::JointRow& j) { return "joint " + in_quotes(j.name); }

class SdfBuilder {
 public:
  SdfBuilder(Model& model, const RobotOptions& options)
      : model_(model), options_(options), findings_(options.strict), file_(read_sdf(options, findings_)), first_(static_cast<Index>(model.bodies.size())) {}

  Robot run() {
    out_.name = options_.robot;
    find_links();
    choose_tree();
    check_options();
    walk();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      sum_parts(parts_[i], bodies_[i]);
      validate_body(bodies_[i], options_.file);
      out_.bodies.push_back(model_.add(std::move(bodies_[i])));
    }
    for (const std::size_t j : screws_) add_screw(file_.joints[j]);
    for (std::size_t j = 0; j < file_.joints.size(); ++j) {
      if (file_.joints[j].type == Type::gearbox) add_gearbox(file_.joints[j]);
      else if (!in_tree_[j]) close_loop(file_.joints[j]);
    }
    tally_.report(options_.file, findings_);
    out_.notes = std::move(findings_.notes);
    out_.warnings = std::move(findings_.warnings);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }

  void find_links() {
    for (std::size_t k = 0; k < file_.links.size(); ++k)
      if (!index_.emplace(file_.links[k].name, k).second) fail("link " + in_quotes(file_.links[k].name), "the name is taken", "unique link names");
    for (SdfDocument::JointRow& j : file_.joints) {
      if (j.child == "world") turn_round(j);
      for (const std::string* end : {&j.parent, &j.child})
        if (*end != "world" && !index_.count(*end)) fail(element_of(j), "link " + in_quotes(*end) + " does not exist", "a link of this file, or world");
      const std::size_t axes = j.type == Type::fixed || j.type == Type::ball ? 0 : j.type == Type::universal || j.type == Type::revolute2 || j.type == Type::gearbox ? 2 : 1;
      if (j.axes.size() < axes) fail(element_of(j), "has " + std::to_string(j.axes.size()) + " axes", std::to_string(axes) + ": <axis>" + (axes > 1 ? " and <axis2>" : ""));
    }
  }

  /// The world as parent: the motion is that of the link, so the axis turns round.
  void turn_round(SdfDocument::JointRow& j) const {
    std::swap(j.parent, j.child);
    if (j.type == Type::fixed) return;
    if (j.axes.size() != 1 || j.type == Type::screw) fail(element_of(j), "has the world as its child", "the world as parent");
    SdfDocument::Axis& a = j.axes[0];
    a.direction = -a.direction;
  }

  /// A link hangs on the first joint that has it as child, unless that closes a circle.
  void choose_tree() {
    hangs_on_.assign(file_.links.size(), none);
    in_tree_.assign(file_.joints.size(), false);
    children_.resize(file_.links.size());
    for (std::size_t j = 0; j < file_.joints.size(); ++j) {
      const SdfDocument::JointRow& row = file_.joints[j];
      if (row.type == Type::gearbox) continue;
      const std::size_t child = index_.at(row.child);
      if (hangs_on_[child] != none || file_.links[child].fixed) continue;
      if (row.parent != "world") {
        std::size_t root = index_.at(row.parent);
        while (hangs_on_[root] != none && file_.joints[hangs_on_[root]].parent != "world") root = index_.at(file_.joints[hangs_on_[root]].parent);
        if (root == child) continue;
      }
      hangs_on_[child] = j;
      in_tree_[j] = true;
      if (row.parent != "world") children_[index_.at(row.parent)].push_back(j);
    }
  }

  void check_options() const {
    if (!options_.joint_types.empty()) fail("joint_types of the scene", "SDF states the types of its joints", "no joint_types");
    for (const auto& [key, value] : options_.armature) {
      const auto it = std::find_if(file_.joints.begin(), file_.joints.end(), [&, &name = key](const auto& j) { return j.name == name; });
      if (it == file_.joints.end()) fail("armature of the scene", "joint " + in_quotes(key) + " does not exist", "a joint of this file");
      if (it->type == Type::fixed || !in_tree_[static_cast<std::size_t>(it - file_.joints.begin())])
        fail("armature of the scene", "joint " + in_quotes(key) + " is fixed or closes a loop", "a moving joint of the tree");
    }
  }

  Index add_body(const std::string& link, Index parent, Joint joint) {
    Body body;
    body.name = options_.robot + "/" + link;
    body.parent = parent;
    body.joint = std::move(joint);
    bodies_.push_back(std::move(body));
    parts_.emplace_back();
    return first_ + static_cast<Index>(bodies_.size()) - 1;
  }

  /// Puts a link into a body or the ground.
  void place(const SdfDocument::Link& link, const Frame& frame) {
    out_.links[link.name] = frame;
    if (frame.body == ground) {
      if (!link.shapes.empty() || !link.meshes.empty()) tally_.add("fixed to the world, collision shapes left out", options_.robot + "/" + link.name);
      return;
    }
    const std::size_t k = z(frame.body - first_);
    const std::string element = "link " + in_quotes(link.name) + " <inertial>";
    if (!link.has_inertial)
      findings_.warn("no inertial", options_.file, element, "is missing: SDF then takes 1 kg and 1 kg m^2 about every axis", "<inertial>, or a link fixed to the world");
    judge_inertia(findings_, options_.file, element, link.mass, link.inertia);
    const Pose<double> X = frame.placement * link.centre;
    parts_[k].push_back({link.mass, X.translation, X.rotation * link.inertia * X.rotation.transpose()});
    for (Shape s : link.shapes) {
      s.placement = frame.placement * s.placement;
      bodies_[k].shapes.push_back(s);
    }
    for (Robot::Mesh m : link.meshes) {
      m.body = frame.body;
      m.placement = frame.placement * m.placement;
      out_.meshes.push_back(m);
    }
  }

  /// Depth first from each root, links and joints in the order of the file.
  void walk() {
    bool base_free = options_.base_given;  // the scene's base goes to the first root
    for (std::size_t k = 0; k < file_.links.size(); ++k) {
      const std::size_t j = hangs_on_[k];
      const bool stands = file_.links[k].fixed || (j != none && file_.joints[j].parent == "world" && file_.joints[j].type == Type::fixed);
      if (j == none || stands) add_root(file_.links[k], stands, std::exchange(base_free, false));
      else if (file_.joints[j].parent == "world") add_joint(j, {ground, options_.pose}, {});
      else continue;
      descend(k);
    }
    if (base_free) findings_.note(options_.file + ": every root hangs on a joint to the world; `base` of the scene has no effect");
  }

  void descend(std::size_t link) {
    std::vector<std::size_t> stack(children_[link].rbegin(), children_[link].rend());
    while (!stack.empty()) {
      const std::size_t j = stack.back();
      stack.pop_back();
      const std::size_t parent = index_.at(file_.joints[j].parent), child = index_.at(file_.joints[j].child);
      add_joint(j, out_.links.at(file_.joints[j].parent), file_.links[parent].pose);
      stack.insert(stack.end(), children_[child].rbegin(), children_[child].rend());
    }
  }

  void add_root(const SdfDocument::Link& link, bool stands, bool base_given) {
    const RobotOptions::Base own = stands ? RobotOptions::Base::fixed : RobotOptions::Base::free;
    const RobotOptions::Base base = base_given ? options_.base : own;
    if (base_given && stands && base != RobotOptions::Base::fixed)
      findings_.note(options_.file + ": link " + in_quotes(link.name) + " stands in the world; the scene sets it free");
    const Pose<double> at = options_.pose * link.pose;
    if (base == RobotOptions::Base::fixed) return place(link, {ground, at});
    Joint joint;
    const bool planar = base == RobotOptions::Base::planar;
    joint.name = options_.robot + "/" + (out_.root_joint.empty() && bodies_.empty() ? "base" : link.name + " base");
    joint.type = planar ? JointType::planar : JointType::floating;
    if (planar) joint.placement = at;
    if (bodies_.empty()) out_.root_joint = joint.name;
    const Index body = add_body(link.name, ground, joint);
    place(link, {body, {}});
    if (planar) return;
    const V3& p = at.translation;
    const Eigen::Quaterniond r(at.rotation);
    out_.start.emplace_back(body, std::vector<double>{p[0], p[1], p[2], r.w(), r.x(), r.y(), r.z()});
  }

  /// The joint frame in the parent's body is `parent.placement` less the link's pose, times the joint's.
  void add_joint(std::size_t j, const Frame& parent, const Pose<double>& parent_pose) {
    const SdfDocument::JointRow& row = file_.joints[j];
    const SdfDocument::Link& link = file_.links[index_.at(row.child)];
    const Pose<double> at = parent.placement * parent_pose.inverse() * row.pose, link_in_joint = row.pose.inverse() * link.pose;
    if (row.type == Type::fixed) return place(link, {parent.body, at * link_in_joint});
    Joint joint = joint_of(row);
    joint.placement = at;
    const Index body = add_body(row.child, parent.body, std::move(joint));
    out_.joints[row.name] = body;
    if (row.type == Type::screw) screws_.push_back(j);
    place(link, {body, link_in_joint});
  }

  Joint joint_of(const SdfDocument::JointRow& row) {
    Joint out;
    out.name = options_.robot + "/" + row.name;
    switch (row.type) {
      case Type::ball: out.type = JointType::spherical; break;
      case Type::prismatic: out.type = JointType::prismatic; break;
      case Type::universal:
      case Type::revolute2: out.type = JointType::universal; break;
      case Type::screw: out.type = JointType::cylindrical; break;
      default: out.type = JointType::revolute;
    }
    if (!row.axes.empty() && row.type != Type::ball) out.axis = row.axes[0].direction;
    if (out.type == JointType::universal) {
      out.axis2 = row.axes[1].direction;
      if (out.axis.cross(out.axis2).norm() < 1e-12) fail(element_of(row), "its two axes are parallel", "two independent axes");
    }
    const std::size_t n = z(dof_count(out.type));
    const auto given = options_.armature.find(row.name);
    out.armature.assign(n, given != options_.armature.end() ? given->second : std::max(0.0, options_.armature_of_all));
    if (row.axes.empty() || row.type == Type::ball) return out;
    for (std::size_t k = 0; k < n; ++k) {
      const bool moves_freely = row.type == Type::screw && k == 1;
      const SdfDocument::Axis& a = row.axes[std::min(k, row.axes.size() - 1)];
      out.damping.push_back(moves_freely ? 0 : a.damping);
      out.friction.push_back(moves_freely ? 0 : a.friction);
    }
    if (row.type != Type::screw && row.type != Type::continuous) set_limits(row, n, out);
    return out;
  }

  void set_limits(const SdfDocument::JointRow& row, std::size_t n, Joint& out) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    auto any = [&](bool SdfDocument::Axis::*given) { return std::any_of(row.axes.begin(), row.axes.begin() + static_cast<long>(n), [&](const auto& a) { return a.*given; }); };
    if (any(&SdfDocument::Axis::range_given)) {
      for (std::size_t k = 0; k < n; ++k) {
        const SdfDocument::Axis& a = row.axes[k];
        const bool reversed = a.lower > a.upper;
        if (reversed)
          findings_.warn("reversed limits", options_.file, element_of(row), "lower " + number_text(a.lower) + " is above upper " + number_text(a.upper) + "; they are left out", "lower <= upper [rad or m]");
        out.lower.push_back(reversed || a.lower <= -1e16 ? -infinity : a.lower);
        out.upper.push_back(reversed || a.upper >= 1e16 ? infinity : a.upper);
      }
    }
    if (any(&SdfDocument::Axis::effort_given))
      for (std::size_t k = 0; k < n; ++k) out.effort.push_back(row.axes[k].effort_given ? row.axes[k].effort : infinity);
    if (any(&SdfDocument::Axis::velocity_given))
      for (std::size_t k = 0; k < n; ++k) out.velocity.push_back(row.axes[k].velocity_given ? row.axes[k].velocity : infinity);
  }

  /// Turns about the axis against travel along it: travel = −angle / thread_pitch.
  void add_screw(const SdfDocument::JointRow& row) {
    if (row.thread_pitch == 0) fail(element_of(row), "thread_pitch is 0", "thread_pitch [rad/m] other than 0");
    findings_.warn("screw joint", options_.file, element_of(row), "thread_pitch " + number_text(row.thread_pitch) + " is taken as in Gazebo: travel = -angle / thread_pitch", "compare with what the file means");
    Constraint c;
    c.name = options_.robot + "/" + row.name + " screw";
    c.kind = Kind::coupling;
    const Index body = out_.joints.at(row.name);
    c.terms = {{body, 1, 1, {}}, {body, 0, 1 / row.thread_pitch, {}}};
    model_.constraints.push_back(std::move(c));
  }

  /// The body whose single revolute joint turns `link` against `reference`, and the sense about `axis` (world).
  std::pair<Index, double> turn_of(const SdfDocument::JointRow& gear, const std::string& link, const V3& axis) const {
    for (std::size_t j = 0; j < file_.joints.size(); ++j) {
      const SdfDocument::JointRow& row = file_.joints[j];
      const bool forward = row.parent == gear.reference && row.child == link, backward = row.child == gear.reference && row.parent == link;
      if (!in_tree_[j] || (!forward && !backward) || (row.type != Type::revolute && row.type != Type::continuous)) continue;
      const double along = (row.pose.rotation * row.axes[0].direction).dot(axis);
      if (std::abs(along) < 0.5) continue;
      return {out_.joints.at(row.name), (forward ? 1 : -1) * (along > 0 ? 1 : -1)};
    }
    fail(element_of(gear), "link " + in_quotes(link) + " has no revolute joint of that axis to the reference body " + in_quotes(gear.reference), "one for the parent and one for the child");
  }

  /// angle₂ = −ratio · angle₁, of the child and of the parent against the reference body.
  void add_gearbox(const SdfDocument::JointRow& row) {
    const auto [b1, s1] = turn_of(row, row.parent, row.pose.rotation * row.axes[0].direction);
    const auto [b2, s2] = turn_of(row, row.child, row.pose.rotation * row.axes[1].direction);
    if (b1 == b2) fail(element_of(row), "joins a joint to itself", "two joints");
    const double ratio = row.ratio == 0 ? 1 : row.ratio;  // 1 where none is given
    Constraint c;
    c.name = options_.robot + "/" + row.name + " gearbox";
    c.kind = Kind::coupling;
    c.terms = {{b2, 0, s2, {}}, {b1, 0, ratio * s1, {}}};
    model_.constraints.push_back(std::move(c));
    out_.mimics.push_back({b2, b1, -ratio * s1 * s2, 0});
  }

  /// A frame at the joint, on one of its links.
  Frame frame_on(const std::string& link, const SdfDocument::JointRow& row, const Matrix3<double>& axes) const {
    const Pose<double> at = row.pose * Pose<double>{axes, V3::Zero()};
    if (link == "world") return {ground, options_.pose * at};
    const Frame& frame = out_.links.at(link);
    return {frame.body, frame.placement * file_.links[index_.at(link)].pose.inverse() * at};
  }

  void close_loop(const SdfDocument::JointRow& row) {
    Constraint c;
    const V3 axis = row.axes.empty() ? V3(0, 0, 1) : row.axes[0].direction;
    Matrix3<double> a = frame_about(axis), b = a;
    switch (row.type) {
      case Type::revolute:
      case Type::continuous: c.kind = Kind::hinge; break;
      case Type::ball: c.kind = Kind::point; break;
      case Type::fixed: c.kind = Kind::weld; break;
      case Type::prismatic: c.kind = Kind::prismatic; break;
      case Type::universal:
      case Type::revolute2:
        if (std::abs(axis.dot(row.axes[1].direction)) > 1e-12) fail(element_of(row), "closes a loop and its axes are not perpendicular", "perpendicular axes, or another joint of the loop as the last one of the file");
        c.kind = Kind::universal;
        a = frame_about(row.axes[1].direction);
        b << axis, frame_about(axis).leftCols<2>();
        break;
      case Type::screw:
      case Type::gearbox: fail(element_of(row), "a screw cannot close a loop", "another joint of the loop as the last one of the file");
    }
    c.name = options_.robot + "/" + row.name;
    c.a = frame_on(row.child, row, a), c.b = frame_on(row.parent, row, b);
    c.loop = true;
    if (c.a.body == c.b.body) return tally_.add("joints between links of one body, without effect", row.name);
    tally_.add("joints that close a loop, as constraints", row.name);
    model_.constraints.push_back(std::move(c));
  }

  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  Model& model_;
  const RobotOptions& options_;
  Findings findings_;
  SdfDocument file_;
  Index first_;
  std::map<std::string, std::size_t> index_;        // link → place in file_.links
  std::vector<std::size_t> hangs_on_;               // link → joint
  std::vector<bool> in_tree_;                       // joint
  std::vector<std::vector<std::size_t>> children_;  // link → joints
  std::vector<std::size_t> screws_;
  std::vector<Body> bodies_;
  std::vector<std::vector<Part>> parts_;
  Tally tally_;
  Robot out_;
};

}  // namespace

Robot add_sdf(Model& model, const RobotOptions& options) { return SdfBuilder(model, options).run(); }

}  // namespace delassus
