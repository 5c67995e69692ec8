#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "reference/mujoco_witness.h"

namespace delassus::reference {
namespace {

using Kind = MujocoJoint::Kind;

/// In-plane axes of a planar joint by the rule of model.h: t1 is the projection of the coordinate axis farthest from
/// `axis`, t2 = axis × t1.
std::pair<Vector3<double>, Vector3<double>> plane_of(const Vector3<double>& axis) {
  Index farthest = 0;
  for (Index k = 1; k < 3; ++k)
    if (std::fabs(axis[k]) < std::fabs(axis[farthest])) farthest = k;
  const Vector3<double> e = Vector3<double>::Unit(farthest);
  const Vector3<double> t1 = (e - e.dot(axis) * axis).normalized();
  return {t1, axis.cross(t1)};
}

std::string numbers(const auto& x) {
  std::ostringstream s;
  s.precision(std::numeric_limits<double>::max_digits10);
  for (Index k = 0; k < x.size(); ++k) s << (k ? " " : "") << x[k];
  return s.str();
}

std::string attribute(const char* name, const auto& x) { return std::string(" ") + name + "=\"" + numbers(x) + "\""; }

std::string attribute(const char* name, double x) { return attribute(name, Eigen::Matrix<double, 1, 1>(x)); }

std::string quaternion(const Matrix3<double>& rotation) {
  const Eigen::Quaterniond q(rotation);
  return attribute("quat", Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
}

std::string inertia_text(const Body& body) {
  const Eigen::SelfAdjointEigenSolver<Matrix3<double>> principal(body.inertia);
  Matrix3<double> axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  return "<inertial" + attribute("pos", body.com) + attribute("mass", body.mass) + quaternion(axes) +
         attribute("diaginertia", principal.eigenvalues()) + "/>";
}

void check_served(const Body& body) {
  if (!(body.mass > 0)) throw ModelError("", body.name + " mass", "0 kg", "above 0 kg: MuJoCo has no massless bodies");
  const auto& a = body.joint.armature;
  if (body.joint.type == JointType::floating && !a.empty() && (a[3] != a[4] || a[3] != a[5]))
    throw ModelError("", body.name + " armature", "differs between translations [kg]",
                     "equal entries: MuJoCo's are in world axes");
}

/// Armature of ball and free joints is set in the compiled model, axis by axis.
std::string joint_text(const Body& body, const MujocoJoint& joint, const std::string& name) {
  static constexpr const char* names[] = {"hinge", "slide", "ball", "free"};
  std::string text = "<joint name=\"" + name + "\" type=\"" + names[static_cast<std::size_t>(joint.kind)] + "\"";
  if (joint.kind == Kind::hinge || joint.kind == Kind::slide) {
    text += attribute("pos", Vector3<double>(0, 0, 0)) + attribute("axis", joint.axis);
    if (!body.joint.armature.empty()) text += attribute("armature", body.joint.armature[joint.dof]);
  }
  return text + "/>";
}

void body_text(const Model& model, const std::vector<std::vector<Index>>& children, const MujocoMore& more, Index i, std::string& text) {
  const Body& body = model.bodies[i];
  check_served(body);
  text += "<body name=\"" + mujoco_name(i) + "\"" + attribute("pos", body.joint.placement.translation) +
          quaternion(body.joint.placement.rotation) + ">\n" + inertia_text(body) + "\n";
  std::size_t k = 0;
  for (const MujocoJoint& joint : mujoco_joints(body)) text += joint_text(body, joint, mujoco_name(i, k++));
  text += "\n";
  if (!more.in_body.empty()) text += more.in_body[static_cast<std::size_t>(i)];
  for (const Index child : children[static_cast<std::size_t>(i)]) body_text(model, children, more, child, text);
  text += "</body>\n";
}

/// What its `connect` rows take, or what it gives by itself.
std::size_t room_for_rows(const Model& model) {
  const auto is_point = [](const Constraint& c) { return c.kind == Constraint::Kind::point; };
  return std::max<std::size_t>(500, 3 * static_cast<std::size_t>(std::count_if(model.constraints.begin(), model.constraints.end(), is_point)));
}

std::string equality_text(const Model& model) {
  std::string text;
  for (const Constraint& c : model.constraints) {
    if (c.kind != Constraint::Kind::point) continue;
    const Frame& first = c.a.body == ground ? c.b : c.a;
    const Frame& second = c.a.body == ground ? c.a : c.b;
    text += "<connect body1=\"" + mujoco_name(first.body) + "\"";
    if (second.body != ground) text += " body2=\"" + mujoco_name(second.body) + "\"";
    text += attribute("anchor", first.placement.translation) + "/>\n";
  }
  return text;
}

}  // namespace

std::vector<MujocoJoint> mujoco_joints(const Body& body) {
  const Joint& joint = body.joint;
  switch (joint.type) {
    case JointType::revolute: return {{Kind::hinge, joint.axis, 0, 0}};
    case JointType::prismatic: return {{Kind::slide, joint.axis, 0, 0}};
    case JointType::universal: return {{Kind::hinge, joint.axis, 0, 0}, {Kind::hinge, joint.axis2, 1, 1}};
    case JointType::planar: {
      const auto [t1, t2] = plane_of(joint.axis);
      return {{Kind::slide, t1, 1, 1}, {Kind::slide, t2, 2, 2}, {Kind::hinge, joint.axis, 0, 0}};
    }
    case JointType::spherical: return {{Kind::ball, {0, 0, 1}, 0, 0}};
    case JointType::cylindrical: return {{Kind::hinge, joint.axis, 0, 0}, {Kind::slide, joint.axis, 1, 1}};
    case JointType::floating: break;
  }
  if (body.parent == ground) return {{Kind::free, {0, 0, 1}, 0, 0}};
  return {{Kind::slide, {1, 0, 0}, 0, 3}, {Kind::slide, {0, 1, 0}, 1, 4}, {Kind::slide, {0, 0, 1}, 2, 5},
          {Kind::ball, {0, 0, 1}, 3, 0}};
}

std::string mujoco_name(Index body) { return std::to_string(body).insert(0, 1, 'b'); }

std::string mujoco_name(Index body, std::size_t joint) { return mujoco_name(body) + "." + std::to_string(joint); }

std::string mujoco_xml(const Model& model, const MujocoMore& more) {
  std::vector<std::vector<Index>> children(model.bodies.size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].parent != ground)
      children[static_cast<std::size_t>(model.bodies[i].parent)].push_back(static_cast<Index>(i));
  std::string text =
      "<mujoco>\n<compiler coordinate=\"local\" angle=\"radian\" autolimits=\"false\" inertiafromgeom=\"false\" "
      "balanceinertia=\"false\" boundmass=\"0\" boundinertia=\"0\" settotalmass=\"-1\" fusestatic=\"false\"/>\n<size njmax=\"" + std::to_string(room_for_rows(model) + more.rows) + "\" nconmax=\"" + std::to_string(100 + more.contacts) + "\"/>\n"
      "<option gravity=\"0 0 0\" jacobian=\"dense\">\n<flag equality=\"enable\" contact=\"disable\" limit=\"disable\" "
      "frictionloss=\"disable\" gravity=\"disable\"/>\n</option>\n<asset>\n" + more.assets + "</asset>\n<worldbody>\n" + more.in_world;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].parent == ground) body_text(model, children, more, static_cast<Index>(i), text);
  return text + "</worldbody>\n<equality>\n" + equality_text(model) + more.equalities + "</equality>\n" + more.behind + "</mujoco>\n";
}

}  // namespace delassus::reference
