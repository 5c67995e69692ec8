#include "models/formats/urdf.h"

#include <urdf_model/model.h>

#include <Eigen/Geometry>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/inertia_check.h"
#include "models/robot_bodies.h"
#include "models/formats/urdf_check.h"

namespace delassus {
namespace {

Vector3<double> vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose<double> pose(const urdf::Pose& p) {
  const urdf::Rotation& r = p.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(), vector(p.position)};
}

Part part_of(const urdf::Inertial& in, const Pose<double>& link_in_body) {
  Matrix3<double> I;
  I << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  const Pose<double> X = link_in_body * pose(in.origin);
  return {in.mass, X.translation, X.rotation * I * X.rotation.transpose()};
}

/// Moments of mass about a frame's origin, with the size of what was added: another route to what sum_parts computes.
struct Moments {
  double mass = 0, size = 0;
  Vector3<double> first = Vector3<double>::Zero();
  Matrix3<double> second = Matrix3<double>::Zero();
  double reach = 0;  ///< largest distance of a centre of mass

  static Moments of(double mass, const Vector3<double>& com, const Matrix3<double>& inertia) {
    Moments m;
    m.mass = mass, m.first = mass * com, m.reach = com.norm();
    m.second = inertia + mass * (com.squaredNorm() * Matrix3<double>::Identity() - com * com.transpose());
    m.size = inertia.norm() + mass * com.squaredNorm();
    return m;
  }
  void add(const CheckedUrdf::Inertial& in, const Pose<double>& link_in_body) {
    const Pose<double> X = link_in_body * in.origin;
    const Moments m = of(in.mass, X.translation, X.rotation * in.inertia * X.rotation.transpose());
    mass += m.mass, first += m.first, second += m.second, size += m.size, reach = std::max(reach, m.reach);
  }
  /// Relative to what this one was summed from.
  [[nodiscard]] double distance(const Moments& sum) const {
    const auto over = [](double error, double scale) { return error == 0 ? 0 : error / scale; };
    return std::max({over(std::abs(mass - sum.mass), sum.mass), over((first - sum.first).norm(), sum.mass * sum.reach),
                     over((second - sum.second).norm(), sum.size)});
  }
  [[nodiscard]] std::string text() const {
    return number_text(mass) + " kg, (" + numbers_text(first) + ") kg m, (" + numbers_text(second.reshaped()) + ") kg m^2";
  }
};

/// Unit vector of a direction of any length.
Vector3<double> unit(const Vector3<double>& v) {
  const double n = v.norm();
  return n > 1e-100 && n < 1e100 ? Vector3<double>(v / n) : Vector3<double>(v.stableNormalized());
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
      : model_(model), options_(options), findings_(options.strict), checked_(check_urdf(options.file, findings_)),
        urdf_(read_by_urdfdom(checked_, findings_)), bodies_(model, options) {
    check_names();
  }

  Robot run() {
    out_.name = options_.robot;
    add_root();
    walk();
    bodies_.sum();
    check_totals();
    bodies_.add_to(model_, out_);
    add_mimics();
    out_.notes = std::move(findings_.notes);
    out_.warnings = std::move(findings_.warnings);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }

  void check_names() const {
    std::vector<std::string> moving;
    std::map<std::string, std::string> others;
    for (const CheckedUrdf::JointRow& j : checked_.joints) {
      if (j.fixed()) others.emplace(j.name, "is fixed");
      else moving.push_back(j.name);
    }
    check_named_joints(options_, moving, others);
  }

  Index add_body(const std::string& link, Index parent, Joint joint) {
    expected_.emplace_back(bodies_.add(link, parent, std::move(joint), checked_.links.at(link).line), Moments{});
    return expected_.back().first;
  }

  /// Puts a link into a body (or the ground): its frame, inertia and shapes.
  void place(const std::string& link, const Frame& frame) {
    const CheckedUrdf::Link& said = checked_.links.at(link);
    bodies_.place(link, frame, said.shapes, said.meshes, out_);
    const auto& inertial = urdf_->links_.at(link)->inertial;
    if (frame.body == ground || !inertial) return;
    judge_inertia(findings_, options_.file, said.inertial_place, said.inertial.mass, said.inertial.inertia);
    bodies_.add_part(frame.body, part_of(*inertial, frame.placement));
    expected_[static_cast<std::size_t>(frame.body - expected_.front().first)].second.add(said.inertial, frame.placement);
  }

  void add_root() {
    const RobotOptions::Base base = base_of_root();
    if (base == RobotOptions::Base::fixed) return place(checked_.root, {ground, options_.pose});
    Joint joint;
    const bool planar = base == RobotOptions::Base::planar;
    joint.name = options_.robot + "/base";
    joint.type = planar ? JointType::planar : JointType::floating;
    if (planar) joint.placement = options_.pose;
    out_.root_joint = joint.name;
    place(checked_.root, {add_body(checked_.root, ground, joint), {}});
  }

  /// A root link named world is the world, unless the scene asks for another base.
  RobotOptions::Base base_of_root() {
    if (checked_.root != "world") return options_.base;
    const std::string element = "link \"world\" (line " + std::to_string(checked_.links.at("world").line) + ")";
    if (!options_.base_given) {
      findings_.note(options_.file + ": " + element + ": the root link is the world, so the base is fixed");
      return RobotOptions::Base::fixed;
    }
    if (options_.base != RobotOptions::Base::fixed)
      findings_.warn("moving world", options_.file, element, "the root link is named world, and moves because the scene says so", "base: fixed");
    return options_.base;
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
    out.axis = unit(vector(j.axis));
    if (const auto it = options_.joint_types.find(row.name); it != options_.joint_types.end()) {
      out.type = it->second.type;
      out.axis2 = it->second.axis2;
      if (out.type == JointType::universal && out.axis.cross(out.axis2).norm() == 0)
        throw RequestError(options_.file, "joint_types", row.name,
                           "axis2 of " + in_quotes(row.name) + ", (" + numbers_text(out.axis2) + "), is parallel to its axis, (" + numbers_text(out.axis) + ")",
                           "two different directions; turn axis2");
    }
    const auto n = static_cast<std::size_t>(dof_count(out.type));
    const auto it = options_.armature.find(row.name);
    const bool of_all = !row.armature_given && options_.armature_of_all >= 0;
    out.armature.assign(n, it != options_.armature.end() ? it->second : of_all ? options_.armature_of_all : row.armature);
    out.damping.assign(n, j.dynamics ? j.dynamics->damping : 0);
    out.friction.assign(n, j.dynamics ? j.dynamics->friction : 0);
    if (!j.limits) return out;
    if (n == 1 && row.range_given) out.lower.assign(1, row.lower), out.upper.assign(1, row.upper);
    if (row.effort_given) out.effort.assign(n, j.limits->effort);
    if (row.velocity_given) out.velocity.assign(n, j.limits->velocity);
    return out;
  }

  /// Mass, first and second moments of every body about its frame, from our own reading of the file.
  void check_totals() const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_.bodies()[i];
      const Moments &said = expected_[i].second, held = Moments::of(b.mass, b.com, b.inertia);
      const double slack = 30 * 0x1p-53 * static_cast<double>(1 + 3 * bodies_.parts()[i].size());
      if (!b.com.allFinite() || !b.inertia.allFinite() || !std::isfinite(b.mass) || held.distance(said) <= slack) continue;  // not finite: validate_body
      fail("link " + in_quotes(b.name), "mass and moments about its frame: " + said.text() + " in the file, " + held.text() + " in the model",
           "two that agree; please report this file");
    }
  }

  void add_mimics() {
    for (const CheckedUrdf::JointRow& row : checked_.joints) {
      if (row.master.empty()) continue;
      const std::string element = row.place + " <mimic>";
      const auto a = out_.joints.find(row.name), b = out_.joints.find(row.master);
      if (b == out_.joints.end() && urdf_->joints_.count(row.master)) {
        findings_.warn("mimic of a fixed joint", options_.file, element, "joint " + in_quotes(row.master) + " is fixed: nothing to follow, the joint moves freely",
                       "a moving joint of this file");
        continue;
      }
      if (b == out_.joints.end()) {
        std::vector<std::string_view> names;
        for (const auto& [joint, body] : out_.joints) names.push_back(joint);
        fail(element, "joint " + in_quotes(row.master) + " does not exist", did_you_mean(row.master, names) + "a moving joint of this file; correct the name, or take the <mimic> out");
      }
      if (a->second == b->second) fail(element, "a joint cannot follow " + in_quotes(row.master) + ", itself", "another moving joint; name that one, or take the <mimic> out");
      for (const Index i : {a->second, b->second})
        if (dof_count(model_.bodies[static_cast<std::size_t>(i)].joint.type) != 1)
          fail(element, "joint " + in_quotes(i == a->second ? row.name : row.master) + " has " + std::to_string(dof_count(model_.bodies[static_cast<std::size_t>(i)].joint.type)) + " degrees of freedom",
               "joints with one degree of freedom; take the <mimic> out and give a coupling of the scene");
      out_.mimics.push_back({a->second, b->second, row.multiplier, row.offset});
      Constraint c;
      c.name = options_.robot + "/" + row.name + " mimic";
      c.kind = Constraint::Kind::coupling;
      c.terms = {{a->second, 0, 1, {}}, {b->second, 0, -row.multiplier, {}}};
      model_.constraints.push_back(std::move(c));
    }
  }

  Model& model_;
  const RobotOptions& options_;
  Findings findings_;
  CheckedUrdf checked_;
  std::shared_ptr<urdf::ModelInterface> urdf_;
  RobotBodies bodies_;
  std::vector<std::pair<Index, Moments>> expected_;  // per body of the robot
  Robot out_;
};

}  // namespace

Robot add_urdf(Model& model, const RobotOptions& options) { return Loader(model, options).run(); }

}  // namespace delassus
