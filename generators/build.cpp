#include "generators/build.h"

#include <cmath>
#include <string>

#include "generators/build_detail.h"

namespace delassus::generators {
namespace {

using namespace detail;

[[noreturn]] void reject(const std::string& element, const std::string& problem, const std::string& accepted) {
  throw ModelError("spec", element, problem, accepted + "; specs are written by `delassus stress`");
}

std::vector<Place> places(const Spec& spec) {
  std::vector<Place> out(spec.bodies.size());
  for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
    const BodySpec& b = spec.bodies[i];
    out[i].length = power_of_ten(b.length_decade);
    if (b.parent < 0) continue;
    Vec3 step(b.offset[0], b.offset[1], b.offset[2]);
    if (b.bend_decade) step[1] += power_of_ten(*b.bend_decade);
    out[i].point = out[static_cast<std::size_t>(b.parent)].point + out[i].length * step;
  }
  return out;
}

/// Independent columns of small integers: column k has ±1 in a row where the later columns have 0.
void generic_columns(Random& r, double length, Index n, Vec6* S) {
  std::array<int, 6> order{0, 1, 2, 3, 4, 5};
  for (int k = 5; k > 0; --k) std::swap(order[static_cast<std::size_t>(k)], order[static_cast<std::size_t>(r.integer(0, k))]);
  for (Index c = 0; c < n; ++c) {
    Vec6 s = Vec6::Zero();
    for (Index k = c; k < 6; ++k)
      s[order[static_cast<std::size_t>(k)]] = k == c ? (r.coin() ? 1 : -1) : r.integer(-1, 1);
    s.tail<3>() *= length;
    S[c] = s;
  }
}

void motion_subspace(const BodySpec& b, const Place& at, Vec6* S) {
  const Vec3 axis = about_unit(Vec3(b.axis[0], b.axis[1], b.axis[2]));
  const Vec3 side = orthogonal(axis);
  Random r(b.seed ^ 0x5);
  switch (b.joint) {
    case JointKind::revolute: S[0] = rotation_axis(axis, at.point); break;
    case JointKind::prismatic: S[0] = translation_axis(axis); break;
    case JointKind::cylindrical:
      S[0] = rotation_axis(axis, at.point);
      S[1] = translation_axis(axis);
      break;
    case JointKind::universal:
      S[0] = rotation_axis(axis, at.point);
      S[1] = rotation_axis(side, at.point);
      break;
    case JointKind::planar:
      S[0] = rotation_axis(axis, at.point);
      S[1] = translation_axis(side);
      S[2] = translation_axis(about_unit(axis.cross(side)));
      break;
    case JointKind::floating:
      for (Index k = 0; k < 3; ++k) S[3 + k] = translation_axis(Vec3(Vec3::Unit(k)));
      [[fallthrough]];
    case JointKind::spherical:
      for (Index k = 0; k < 3; ++k) S[k] = rotation_axis(Vec3(Vec3::Unit(k)), at.point);
      break;
    case JointKind::generic: generic_columns(r, at.length, b.dof, S); break;
  }
}

/// Seven point masses: m/4 at the centre, m/8 at ±r_1, ±r_2, ±r_3 from it, the r_k independent.
Matrix6<double> inertia(const BodySpec& b, const Place& at) {
  if (!b.mass_decade) return Matrix6<double>::Zero();
  Random r(b.seed);
  const double m = power_of_ten(*b.mass_decade) * r.integer(2, 5) / 4;
  const Vec3 centre = at.point + at.length / 4 * small_vector(r, 2);
  Mat3 about_centre = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    Vec3 x = Vec3::Zero();
    for (int j = 0; j <= k; ++j) x[j] = j == k ? r.integer(1, 3) : r.integer(-1, 1);
    x *= at.length / 4;
    about_centre += m / 4 * (x.squaredNorm() * Mat3::Identity() - x * x.transpose());
  }
  return spatial_inertia<double>(m, centre, about_centre);
}

std::vector<Index> tree_roots(const Spec& spec) {
  std::vector<Index> root(spec.bodies.size());
  for (std::size_t i = 0; i < root.size(); ++i) {
    const Index p = spec.bodies[i].parent;
    root[i] = p < 0 ? static_cast<Index>(i) : root[static_cast<std::size_t>(p)];
  }
  return root;
}

void check_body(const Spec& spec, std::size_t i) {
  const BodySpec& b = spec.bodies[i];
  const std::string element = "body " + std::to_string(i);
  if (b.parent < -1 || b.parent >= static_cast<Index>(i))
    reject(element, "parent " + std::to_string(b.parent), "-1 (ground) or an earlier body");
  if (b.axis[0] == 0 && b.axis[1] == 0 && b.axis[2] == 0) reject(element, "axis 0 0 0", "a non-zero axis of integers");
  if (b.dof < 0 || b.dof > 6) reject(element, "dof " + std::to_string(b.dof), "0 to 6");
}

void check_link(const Spec& spec, std::size_t e) {
  const LinkConstraintSpec& c = spec.links[e];
  const std::string element = "link constraint " + std::to_string(e);
  if (c.bodies.empty() || (c.kind != ConstraintKind::generic && c.bodies.size() > 2))
    reject(element, std::to_string(c.bodies.size()) + " bodies", "1 or 2, any number from 1 for generic");
  for (const Index b : c.bodies)
    if (b < 0 || b >= static_cast<Index>(spec.bodies.size()))
      reject(element, "body " + std::to_string(b), "0 to " + std::to_string(spec.bodies.size()) + " - 1");
  if (c.rows < 1) reject(element, std::to_string(c.rows) + " rows", "1 or more");
  if (c.axis == std::array<int, 3>{0, 0, 0}) reject(element, "axis 0 0 0", "a non-zero axis of integers");
}

std::shared_ptr<Structure> structure(const Spec& spec) {
  auto s = std::make_shared<Structure>();
  for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
    check_body(spec, i);
    s->add_body(spec.bodies[i].parent, dof_count(spec.bodies[i]));
  }
  for (std::size_t e = 0; e < spec.links.size(); ++e) {
    check_link(spec, e);
    s->add_link_constraint(row_count(spec.links[e]), spec.links[e].bodies);
  }
  for (const JointConstraintSpec& c : spec.joints) {
    if (c.body < 0 || c.body >= s->bodies() || c.rows < 0)
      reject("joint constraint", "body " + std::to_string(c.body), "a body of the spec, rows 0 or more");
    s->add_joint_constraint(c.rows == 0 ? s->dofs(c.body) : c.rows, c.body);
  }
  return s;
}

/// Rotation of a quaternion of whole numbers: every entry a quotient of two, rounded once.
Mat3 rotation(std::uint64_t seed) {
  Random r(seed ^ 0x707);
  const Vec3 v = nonzero_vector(r, 1000);
  const double w = r.integer(-1000, 1000), squared = v.squaredNorm();
  Mat3 whole = 2 * v * v.transpose() + 2 * w * cross_matrix(v);
  whole.diagonal().array() += w * w - squared;
  return whole / (w * w + squared);
}

/// H = diag(Q, Q) H diag(Q, Q)ᵀ, symmetric to the bit.
void turn(const Mat3& Q, Matrix6<double>& H) {
  Matrix6<double> out;
  for (Index i = 0; i < 6; i += 3)
    for (Index j = 0; j < 6; j += 3) out.block<3, 3>(i, j) = Q * H.block<3, 3>(i, j) * Q.transpose();
  H = (out + out.transpose()) / 2;
}

void turn(const Mat3& Q, Vec6& x) { x << Q * x.head<3>(), Q * x.tail<3>(); }

}  // namespace

double power_of_ten(int decade) { return std::ldexp(1.0, static_cast<int>(std::lround(decade * 3.321928094887362))); }

Problem<double> turned(Problem<double> p, std::uint64_t seed) {
  const Mat3 Q = rotation(seed);
  for (Vec6& x : p.S) turn(Q, x);
  for (Vec6& x : p.K) turn(Q, x);
  for (Matrix6<double>& H : p.H) turn(Q, H);
  return p;
}

Built build(const Spec& spec) {
  const auto s = structure(spec);
  Built out{Problem<double>(s), Damping<double>::uniform(s->rows, 0)};
  const std::vector<Place> at = places(spec);
  const std::vector<Index> root = tree_roots(spec);
  for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
    const BodySpec& b = spec.bodies[i];
    const Index first = s->first_dof[i], n = s->dofs(static_cast<Index>(i));
    motion_subspace(b, at[i], out.problem.S.data() + first);
    out.problem.H[i] = inertia(b, at[i]);
    for (Index k = 0; k < n && b.armature_decade; ++k)
      out.problem.armature[static_cast<std::size_t>(first + k)] = power_of_ten(*b.armature_decade);
  }
  for (std::size_t e = 0; e < spec.links.size(); ++e) {
    fill_link(spec.links[e], at, root, s->link_constraints[e], out.problem);
    fill_damping(spec.links[e].damping, s->link_constraints[e].row, s->link_constraints[e].rows, out.damping);
  }
  for (std::size_t e = 0; e < spec.joints.size(); ++e) {
    const Structure::JointConstraint& j = s->joint_constraints[e];
    fill_joint(spec.joints[e], j.rows, s->dofs(j.body), out.problem.joint_K.data() + j.first);
    fill_damping(spec.joints[e].damping, j.row, j.rows, out.damping);
  }
  if (spec.turn) out.problem = turned(std::move(out.problem), *spec.turn);
  return out;
}

}  // namespace delassus::generators
