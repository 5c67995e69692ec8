#include "algorithms/mechanism/model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/regularity.h"

namespace delassus {
namespace {

constexpr double eps = 0x1p-53;

struct JointRow {
  std::string_view name;
  Index q, dofs;
};
constexpr std::array<JointRow, 7> joint_table{{{"revolute", 1, 1},
                                               {"prismatic", 1, 1},
                                               {"universal", 2, 2},
                                               {"planar", 3, 3},
                                               {"spherical", 4, 3},
                                               {"floating", 7, 6},
                                               {"cylindrical", 2, 2}}};

struct KindRow {
  std::string_view name;
  Index rows;  // −1: depends on the constraint
};
constexpr std::array<KindRow, 14> kind_table{{{"point", 3},
                                              {"weld", 6},
                                              {"hinge", 5},
                                              {"universal", 4},
                                              {"cylindrical", 4},
                                              {"prismatic", 5},
                                              {"planar", 3},
                                              {"distance", 1},
                                              {"contact", 3},
                                              {"joint_friction", -1},
                                              {"joint_lock", -1},
                                              {"joint_limit", 1},
                                              {"coupling", 1},
                                              {"general", -1}}};

/// Unit length to 30 ε · 3 (three squares are added).
void check_unit(const Vector3<double>& axis, const std::string& file, const std::string& element) {
  const double error = std::abs(axis.squaredNorm() - 1);
  if (!(error < 30 * eps * 3)) throw ModelError(file, element, "(" + numbers_text(axis) + ") is not a unit vector", "length 1; divide it by its length");
}

/// Only finite, non-negative numbers, one per degree of freedom or none.
void check_per_dof(const std::vector<double>& values, Index n, bool infinite, const std::string& unit,
                   const std::string& file, const std::string& element) {
  if (!values.empty() && static_cast<Index>(values.size()) != n)
    throw ModelError(file, element, std::to_string(values.size()) + " values",
                     std::to_string(n) + ", one per degree of freedom, or none; leave the others out");
  for (const double v : values)
    if (!(v >= 0) || (!infinite && std::isinf(v)))
      throw ModelError(file, element, number_text(v) + " " + unit, std::string(infinite ? "" : "finite and ") + "0 or more " + unit + (infinite ? "; leave it out for none" : "; leave it out for 0"));
}

void check_limits(const Joint& joint, Index n, const std::string& file, const std::string& element) {
  for (const auto* limit : {&joint.lower, &joint.upper}) {
    if (!limit->empty() && static_cast<Index>(limit->size()) != n)
      throw ModelError(file, element + " limits", std::to_string(limit->size()) + " values",
                       std::to_string(n) + ", one per degree of freedom, or none; infinity where there is no limit");
    for (const double v : *limit)
      if (std::isnan(v)) throw ModelError(file, element + " limits", "nan", "numbers [rad or m]; infinity where there is no limit");
  }
  if (joint.lower.empty() || joint.upper.empty()) return;
  for (Index k = 0; k < n; ++k)
    if (joint.lower[k] > joint.upper[k])
      throw ModelError(file, element + " limits", "lower " + number_text(joint.lower[k]) + " above upper " + number_text(joint.upper[k]),
                       "lower at most upper [rad or m]; exchange them, or leave both out");
}

void check_joint(const Joint& joint, const std::string& file, const std::string& body) {
  const std::string element = body + " joint" + (joint.name.empty() ? "" : " " + joint.name);
  const Index n = dof_count(joint.type);
  check_pose(joint.placement, file, element + " placement");
  if (joint.type != JointType::spherical && joint.type != JointType::floating)
    check_unit(joint.axis, file, element + " axis");
  if (joint.type == JointType::universal) {
    check_unit(joint.axis2, file, element + " axis2");
    if (!(joint.axis.cross(joint.axis2).norm() > 30 * eps * 3))
      throw ModelError(file, element + " axis2", "is parallel to the first axis", "two independent axes; a revolute joint turns about one");
  }
  check_per_dof(joint.armature, n, false, "kg m^2 or kg", file, element + " armature");
  check_per_dof(joint.damping, n, false, "N m s/rad or N s/m", file, element + " damping");
  check_per_dof(joint.friction, n, false, "N m or N", file, element + " friction");
  check_per_dof(joint.effort, n, true, "N m or N", file, element + " effort");
  check_per_dof(joint.velocity, n, true, "rad/s or m/s", file, element + " velocity");
  check_limits(joint, n, file, element);
}

/// Symmetric to 30 ε · 3 times the largest entry, the rounding of a rotated inertia.
void check_inertia(const Matrix3<double>& I, const std::string& file, const std::string& element) {
  const double asymmetry = (I - I.transpose()).cwiseAbs().maxCoeff();
  if (!(asymmetry <= 30 * eps * 3 * I.cwiseAbs().maxCoeff()))
    throw ModelError(file, element, "is not symmetric, by " + number_text(asymmetry) + " kg m^2", "a symmetric matrix; give (I + transpose of I) / 2 when both halves are meant");
}

/// A sphere or capsule may be a point or a line; boxes and cylinders have a volume.
void check_shape(const Shape& shape, const std::string& file, const std::string& element) {
  check_pose(shape.placement, file, element + " placement");
  if (shape.kind == Shape::Kind::hull && (!shape.points || shape.points->empty()))
    throw ModelError(file, element, "a hull without points", "1 or more points [m]; a sphere of radius 0 is a point");
  const Index sizes = shape.kind == Shape::Kind::sphere ? 1 : shape.kind == Shape::Kind::box ? 3 : shape.kind == Shape::Kind::hull ? 0 : 2;
  const bool round = shape.kind == Shape::Kind::sphere || shape.kind == Shape::Kind::capsule;
  for (Index k = 0; k < sizes; ++k)
    if (!(round ? shape.size[k] >= 0 : shape.size[k] > 0) || std::isinf(shape.size[k]))
      throw ModelError(file, element + " size", number_text(shape.size[k]) + " m", round ? "finite and 0 m or more; leave the shape out to touch nothing" : "finite and above 0 m; leave the shape out to touch nothing");
  if (!std::isfinite(shape.friction))
    throw ModelError(file, element + " friction", number_text(shape.friction), "a finite coefficient; a negative one stands for none");
}

void check_parent(Index parent, Index i, const std::string& file, const std::string& name) {
  if (parent < ground || parent >= i)
    throw ModelError(file, name, "parent " + std::to_string(parent) + " is not an earlier body",
                     "-1 (ground) to " + std::to_string(i - 1) + "; add parents before their children");
}

/// Sizes and offsets of the body arrays, parents before children, names used once.
void check_bodies(const Model& model, const std::string& file) {
  const Index n = static_cast<Index>(model.bodies.size());
  if (static_cast<Index>(model.first_q.size()) != n + 1 || static_cast<Index>(model.first_dof.size()) != n + 1)
    throw ModelError(file, "model", "first_q and first_dof do not fit the bodies", "as many entries as bodies, and one more; append bodies by Model::add");
  std::unordered_set<std::string_view> names;
  for (Index i = 0; i < n; ++i) {
    const Body& body = model.bodies[i];
    check_parent(body.parent, i, file, body.name);
    if (model.first_q[i + 1] - model.first_q[i] != q_size(body.joint.type) ||
        model.first_dof[i + 1] - model.first_dof[i] != dof_count(body.joint.type))
      throw ModelError(file, body.name, "first_q or first_dof does not fit the joint type", "the entries of its joint type; append bodies by Model::add");
    if (!body.name.empty() && !names.insert(body.name).second)
      throw ModelError(file, body.name, "two bodies have this name", "distinct names; rename one, or leave its name empty");
    validate_body(body, file);
  }
}

}  // namespace

void check_pose(const Pose<double>& pose, const std::string& file, const std::string& element) {
  if (!pose.rotation.allFinite() || !pose.translation.allFinite())
    throw ModelError(file, element, "is not finite", "finite numbers [m]; compute it again from finite ones");
  const Matrix3<double> error = pose.rotation.transpose() * pose.rotation - Matrix3<double>::Identity();
  if (!(error.cwiseAbs().maxCoeff() < 30 * eps * 3) || !(pose.rotation.determinant() > 0))
    throw ModelError(file, element, "rotation is not a proper orthogonal matrix", "orthonormal columns, determinant +1; take it from a unit quaternion");
}

Index q_size(JointType t) { return joint_table[static_cast<std::size_t>(t)].q; }
Index dof_count(JointType t) { return joint_table[static_cast<std::size_t>(t)].dofs; }
std::string_view name(JointType t) { return joint_table[static_cast<std::size_t>(t)].name; }
std::string_view name(Constraint::Kind k) { return kind_table[static_cast<std::size_t>(k)].name; }

Index row_count(const Model& model, const Constraint& c) {
  const Index rows = kind_table[static_cast<std::size_t>(c.kind)].rows;
  if (rows >= 0) return rows;
  if (c.kind == Constraint::Kind::general) return c.terms.empty() ? 0 : c.terms.front().K.rows();
  if (c.a.body < 0 || c.a.body >= static_cast<Index>(model.bodies.size()))
    throw ModelError("", c.name, "acts on the joint of body " + std::to_string(c.a.body), "a body of the model; 0 to " + std::to_string(static_cast<Index>(model.bodies.size()) - 1));
  return dof_count(model.bodies[c.a.body].joint.type);
}

namespace {

/// The candidates, after the one that was probably meant.
std::string accepted_of(const std::string& wanted, const std::vector<Body>& bodies, const std::string& candidates) {
  std::vector<std::string_view> names;
  for (const Body& body : bodies) names.push_back(body.name);
  const std::string meant = did_you_mean(wanted, names);
  return candidates + "; " + (meant.empty() ? "names are robot/link" : meant.substr(0, meant.size() - 1));
}

}  // namespace

Index Model::find(const std::string& wanted) const {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].name == wanted) return static_cast<Index>(i);
  std::string candidates;
  constexpr std::size_t listed = 50;
  for (std::size_t i = 0; i < std::min(bodies.size(), listed); ++i) candidates += (i ? ", " : "") + bodies[i].name;
  if (bodies.size() > listed) candidates += ", and " + std::to_string(bodies.size() - listed) + " more";
  throw ModelError("", wanted, "no body has this name", candidates.empty() ? "none, the model has no body; add it first" : accepted_of(wanted, bodies, candidates));
}

Index Model::add(Body body) {
  const Index i = static_cast<Index>(bodies.size());
  check_parent(body.parent, i, "", body.name);
  validate_body(body, "");
  first_q.push_back(first_q.back() + delassus::q_size(body.joint.type));
  first_dof.push_back(first_dof.back() + dof_count(body.joint.type));
  bodies.push_back(std::move(body));
  return i;
}

void validate_body(const Body& body, const std::string& file) {
  check_joint(body.joint, file, body.name);
  for (std::size_t k = 0; k < body.shapes.size(); ++k)
    check_shape(body.shapes[k], file, body.name + " shape " + std::to_string(k));
  if (!std::isfinite(body.mass) || !body.com.allFinite() || !body.inertia.allFinite())
    throw ModelError(file, body.name, "mass, com or inertia is not finite", "finite numbers [kg, m, kg m^2]; check the units of the file they come from");
  if (body.mass < 0) throw ModelError(file, body.name + " mass", number_text(body.mass) + " kg", "0 kg or more; a massless body needs an armature in its joint or massive descendants");
  check_inertia(body.inertia, file, body.name + " inertia");
}

void validate(const Model& model, const std::string& file) {
  check_bodies(model, file);
  for (const Constraint& c : model.constraints) validate_constraint(model, c, file);
  check_regular(model, file);
}

VectorX<double> neutral(const Model& model) {
  VectorX<double> q = VectorX<double>::Zero(model.q_size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    if (type == JointType::spherical) q[model.first_q[i]] = 1;
    if (type == JointType::floating) q[model.first_q[i] + 3] = 1;
  }
  return q;
}

}  // namespace delassus
