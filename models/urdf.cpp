#include "models/urdf.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>

#include <Eigen/Geometry>

#include "models/message.h"
#include "models/urdf_check.h"

namespace delassus {
namespace {

/// Collects what urdfdom says instead of printing it. console_bridge is global: one parse at a time.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && said.size() < 400) said += (said.empty() ? "" : "; ") + text.substr(0, 200);
  }
  std::string said;

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
};

urdf::ModelInterfaceSharedPtr parse(const std::string& file, const std::string& text) {
  Listener listener;
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& e) {
    thrown = e.what();
  }
  if (!model) throw ModelError(file, "robot", "urdfdom: " + listener.said + thrown, "a URDF 1.0 robot");
  for (auto& [name, link] : model->links_) {  // the tree's own pointers would be released by a recursion as deep as the robot
    link->child_links.clear();
    link->child_joints.clear();
  }
  return model;
}

Vector3<double> vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose<double> pose(const urdf::Pose& p) {
  const urdf::Rotation& r = p.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(), vector(p.position)};
}

/// Mass, centre of mass and inertia of one link, in its body's frame.
struct Part {
  double mass;
  Vector3<double> com;
  Matrix3<double> inertia;
};

Part part_of(const urdf::Inertial& in, const Pose<double>& link_in_body) {
  Matrix3<double> I;
  I << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  const Pose<double> X = link_in_body * pose(in.origin);
  return {in.mass, X.translation, X.rotation * I * X.rotation.transpose()};
}

/// Sum of the parts: I = Σ I_k + m_k (|d|² 1 − d dᵀ), d = c_k − c.
void sum_parts(const std::vector<Part>& parts, Body& body) {
  if (parts.size() == 1) {
    body.mass = parts[0].mass, body.com = parts[0].com;
    body.inertia = (parts[0].inertia + parts[0].inertia.transpose()) / 2;
    return;
  }
  for (const Part& p : parts) body.mass += p.mass, body.com += p.mass * p.com;
  if (body.mass == 0) {
    body.com.setZero();
    return;
  }
  body.com /= body.mass;
  for (const Part& p : parts) {
    const Vector3<double> d = p.com - body.com;
    body.inertia += p.inertia + p.mass * (d.squaredNorm() * Matrix3<double>::Identity() - d * d.transpose());
  }
  body.inertia = (body.inertia + body.inertia.transpose()).eval() / 2;
}

JointType type_of(const urdf::Joint& j) {
  switch (j.type) {
    case urdf::Joint::PRISMATIC: return JointType::prismatic;
    case urdf::Joint::FLOATING: return JointType::floating;
    case urdf::Joint::PLANAR: return JointType::planar;
    default: return JointType::revolute;
  }
}

class Loader {
 public:
  Loader(Model& model, const RobotOptions& options)
      : model_(model), options_(options), checked_(check_urdf(options.file)), urdf_(parse(options.file, checked_.text)) {
    first_ = static_cast<Index>(model.bodies.size());
    check_names();
  }

  Robot run() {
    out_.name = options_.robot;
    out_.notes = checked_.notes;
    add_root();
    walk();
    for (std::size_t i = 0; i < bodies_.size(); ++i) sum_parts(parts_[i], bodies_[i]);
    check_massless();
    for (Body& b : bodies_) {
      validate_body(b, options_.file);
      out_.bodies.push_back(model_.add(std::move(b)));
    }
    add_mimics();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }

  void check_names() const {
    auto check = [&](const std::string& key, const char* what) {
      const auto it = urdf_->joints_.find(key);
      if (it == urdf_->joints_.end()) fail(std::string(what) + " of the scene", "joint " + in_quotes(key) + " does not exist", "a joint of this file");
      if (it->second->type == urdf::Joint::FIXED) fail(std::string(what) + " of the scene", "joint " + in_quotes(key) + " is fixed", "a moving joint");
    };
    for (const auto& [key, type] : options_.joint_types) check(key, "joint_types");
    for (const auto& [key, value] : options_.armature) check(key, "armature");
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

  /// Puts a link into a body (or the ground): its frame, inertia and shapes.
  void place(const std::string& link, const Frame& frame) {
    out_.links[link] = frame;
    const auto shapes = checked_.shapes.find(link);
    const bool has_shapes = shapes != checked_.shapes.end();
    if (frame.body == ground) {
      if (has_shapes) out_.notes.push_back(options_.robot + "/" + link + ": fixed to the world, its collision shapes are left out");
      return;
    }
    const auto k = static_cast<std::size_t>(frame.body - first_);
    if (const auto& inertial = urdf_->links_.at(link)->inertial) parts_[k].push_back(part_of(*inertial, frame.placement));
    if (!has_shapes) return;
    for (Shape s : shapes->second) {
      s.placement = frame.placement * s.placement;
      bodies_[k].shapes.push_back(s);
    }
  }

  void add_root() {
    if (options_.base == RobotOptions::Base::fixed) return place(checked_.root, {ground, options_.pose});
    Joint joint;
    const bool planar = options_.base == RobotOptions::Base::planar;
    joint.name = options_.robot + "/base";
    joint.type = planar ? JointType::planar : JointType::floating;
    if (planar) joint.placement = options_.pose;
    out_.root_joint = joint.name;
    place(checked_.root, {add_body(checked_.root, ground, joint), {}});
  }

  /// Depth first, children in the order of the file.
  void walk() {
    std::vector<Index> stack;
    auto push = [&](const std::string& link) {
      const auto it = checked_.children.find(link);
      if (it != checked_.children.end()) stack.insert(stack.end(), it->second.rbegin(), it->second.rend());
    };
    push(checked_.root);
    while (!stack.empty()) {
      const CheckedUrdf::JointRow& row = checked_.joints[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      add_joint(row);
      push(row.child);
    }
  }

  void add_joint(const CheckedUrdf::JointRow& row) {
    const urdf::Joint& j = *urdf_->joints_.at(row.name);
    const Frame parent = out_.links.at(row.parent);
    const Pose<double> placement = parent.placement * pose(j.parent_to_joint_origin_transform);
    if (j.type == urdf::Joint::FIXED) return place(row.child, {parent.body, placement});
    Joint joint = joint_of(row, j);
    joint.placement = placement;
    const Index body = add_body(row.child, parent.body, std::move(joint));
    out_.joints[row.name] = body;
    place(row.child, {body, {}});
  }

  Joint joint_of(const CheckedUrdf::JointRow& row, const urdf::Joint& j) const {
    Joint out;
    out.name = options_.robot + "/" + row.name;
    out.type = type_of(j);
    out.axis = vector(j.axis).normalized();
    if (const auto it = options_.joint_types.find(row.name); it != options_.joint_types.end()) {
      out.type = it->second.type;
      out.axis2 = it->second.axis2;
      if (out.type == JointType::universal && out.axis.cross(out.axis2).norm() == 0)
        fail("joint_types of the scene", "axis2 of " + in_quotes(row.name) + " is parallel to its axis", "two different directions");
    }
    const auto n = static_cast<std::size_t>(dof_count(out.type));
    const auto it = options_.armature.find(row.name);
    out.armature.assign(n, it == options_.armature.end() ? row.armature : it->second);
    out.damping.assign(n, j.dynamics ? j.dynamics->damping : 0);
    out.friction.assign(n, j.dynamics ? j.dynamics->friction : 0);
    if (!j.limits) return out;
    const bool one = n == 1 && j.type != urdf::Joint::CONTINUOUS && row.range_given;
    if (one) out.lower.assign(1, j.limits->lower), out.upper.assign(1, j.limits->upper);
    if (row.effort_given) out.effort.assign(n, j.limits->effort);
    if (row.velocity_given) out.velocity.assign(n, j.limits->velocity);
    return out;
  }

  /// A body without mass on it or outward of it moves freely unless its joint has armature.
  void check_massless() const {
    std::vector<double> mass(bodies_.size());
    for (std::size_t i = bodies_.size(); i-- > 0;) {
      const Body& b = bodies_[i];
      mass[i] += b.mass;
      if (b.parent >= first_) mass[static_cast<std::size_t>(b.parent - first_)] += mass[i];
      const bool armature = !b.joint.armature.empty() && *std::min_element(b.joint.armature.begin(), b.joint.armature.end()) > 0;
      if (mass[i] == 0 && !armature)
        fail("link " + in_quotes(b.name), "has mass 0 kg outward of joint " + in_quotes(b.joint.name) + ", which has no armature",
             "mass > 0 [kg], or armature > 0 [kg m^2 or kg]");
    }
  }

  void add_mimics() {
    for (const CheckedUrdf::JointRow& row : checked_.joints) {
      const auto& mimic = urdf_->joints_.at(row.name)->mimic;
      if (!mimic) continue;
      const std::string element = "joint " + in_quotes(row.name) + " <mimic> (line " + std::to_string(row.line) + ")";
      const auto a = out_.joints.find(row.name), b = out_.joints.find(mimic->joint_name);
      if (b == out_.joints.end()) fail(element, "joint " + in_quotes(mimic->joint_name) + " does not exist or is fixed", "a moving joint of this file");
      if (a == out_.joints.end() || a->second == b->second) fail(element, "a joint cannot follow " + in_quotes(mimic->joint_name), "a moving joint and another one");
      for (const Index i : {a->second, b->second})
        if (dof_count(model_.bodies[static_cast<std::size_t>(i)].joint.type) != 1)
          fail(element, "a joint with several degrees of freedom", "joints with one degree of freedom");
      out_.mimics.push_back({a->second, b->second, mimic->multiplier, mimic->offset});
      Constraint c;
      c.name = options_.robot + "/" + row.name + " mimic";
      c.kind = Constraint::Kind::coupling;
      c.terms = {{a->second, 0, 1, {}}, {b->second, 0, -mimic->multiplier, {}}};
      model_.constraints.push_back(std::move(c));
    }
  }

  Model& model_;
  const RobotOptions& options_;
  CheckedUrdf checked_;
  urdf::ModelInterfaceSharedPtr urdf_;
  Index first_ = 0;
  std::vector<Body> bodies_;
  std::vector<std::vector<Part>> parts_;
  Robot out_;
};

}  // namespace

Robot add_urdf(Model& model, const RobotOptions& options) { return Loader(model, options).run(); }

}  // namespace delassus
