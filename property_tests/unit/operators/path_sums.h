// Shared by the unit tests of problem and kinematics: M and J from their definitions, the verdict's ratio, and a
// mechanism with every joint type.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "algorithms/kit/scalars.h"
#include "algorithms/mechanism/kinematics.h"

namespace delassus::unit {

/// Columns of body i's Jacobian: S_j for the joints j on the path to its root, 6 × n.
template <class T> MatrixX<T> body_jacobian(const Problem<T>& p, Index i) {
  const Structure& s = *p.structure;
  MatrixX<T> out = MatrixX<T>::Constant(6, s.dofs(), T(0));
  for (Index j = i; j != ground; j = s.parent[j])
    for (Index k = s.first_dof[j]; k < s.first_dof[j + 1]; ++k) out.col(k) = p.S[k];
  return out;
}

/// M = diag(armature) + Σ_i J_iᵀ H_i J_i.
template <class T> MatrixX<T> mass_matrix(const Problem<T>& p) {
  const Structure& s = *p.structure;
  MatrixX<T> M = MatrixX<T>::Constant(s.dofs(), s.dofs(), T(0));
  for (Index k = 0; k < s.dofs(); ++k) M(k, k) = p.armature[k];
  for (Index i = 0; i < s.bodies(); ++i) {
    const MatrixX<T> Ji = body_jacobian(p, i);
    M += Ji.transpose() * (p.H[i] * Ji);
  }
  return M;
}

/// Rows Σ_i K_e^i J_i of link constraints and 𝒦_i of joint constraints.
template <class T> MatrixX<T> constraint_jacobian(const Problem<T>& p) {
  const Structure& s = *p.structure;
  MatrixX<T> J = MatrixX<T>::Constant(s.rows, s.dofs(), T(0));
  for (const auto& c : s.link_constraints)
    for (const auto& l : c.links) {
      const MatrixX<T> Ji = body_jacobian(p, l.body);
      for (Index k = 0; k < c.rows; ++k) J.row(c.row + k) += p.K[l.first + k].transpose() * Ji;
    }
  for (const auto& c : s.joint_constraints)
    for (Index k = 0; k < c.rows; ++k)
      for (Index j = 0; j < s.dofs(c.body); ++j)
        J(c.row + k, s.first_dof[c.body] + j) = p.joint_K[c.first + k * s.dofs(c.body) + j];
  return J;
}

/// error / (eps · bound); 0 where both vanish. Tests compare it with 30.
inline double ratio(double error, double bound, double eps = 0x1p-53) {
  if (error == 0) return 0;
  const double r = std::fabs(error) / (eps * bound);
  return std::isnan(r) ? std::numeric_limits<double>::infinity() : r;
}

/// Largest |x − y| against the largest |y|, in the rounding unit of T.
template <class T> double ratio(const MatrixX<T>& x, const MatrixX<T>& y) {
  double error = 0, bound = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i) {
      const double e = static_cast<double>(T(x(i, j) - y(i, j)));
      error = std::isnan(e) ? e : std::max(error, std::fabs(e));
      bound = std::max(bound, std::fabs(static_cast<double>(y(i, j))));
    }
  return ratio(error, bound, unit_roundoff<T>);
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double lowest = -1, double highest = 1) {
    return std::uniform_real_distribution<double>(lowest, highest)(engine_);
  }
  Vector3<double> vector() { return {number(), number(), number()}; }
  Vector3<double> unit() { return vector().normalized(); }
  Matrix3<double> rotation() {
    const Vector3<double> x = unit(), z = x.cross(unit()).normalized();
    Matrix3<double> R;
    R << x, z.cross(x).normalized(), z;
    return R;
  }
  Pose<double> pose() { return {rotation(), vector()}; }

 private:
  std::mt19937 engine_;
};

/// A body with a random placement, axes, mass, centre of mass and inertia (that of three orthogonal rods).
inline Body random_body(Random& random, const std::string& name, Index parent, JointType type) {
  Body b;
  b.name = name;
  b.parent = parent;
  b.joint.type = type;
  b.joint.placement = random.pose();
  b.joint.axis = random.unit();
  b.joint.axis2 = b.joint.axis.cross(random.unit()).normalized();
  b.mass = random.number(0.5, 2);
  b.com = random.vector();
  const Matrix3<double> R = random.rotation();
  const Vector3<double> moments(random.number(1, 1.5), random.number(1, 1.5), random.number(1, 1.5));
  b.inertia = R * moments.asDiagonal() * R.transpose();
  return b;
}

inline constexpr JointType every_joint[] = {JointType::floating,  JointType::revolute,  JointType::universal,
                                            JointType::prismatic, JointType::spherical, JointType::planar,
                                            JointType::cylindrical};

/// Two trees with every joint type each: a floating robot (bodies 0…7, branching) and one on a revolute (8…15).
inline Model two_robots(unsigned seed) {
  Random random(seed);
  Model m;
  for (int robot = 0; robot < 2; ++robot) {
    const Index base = robot * 8;
    for (Index k = 0; k < 8; ++k) {
      const JointType type = every_joint[(robot ? k + 1 : k) % 7];
      const Index parent = k == 0 ? ground : k == 5 ? base + 1 : base + k - 1;
      m.add(random_body(random, std::string(robot ? "b/" : "a/") + std::to_string(k), parent, type));
    }
  }
  return m;
}

/// The neutral configuration moved by random velocities.
inline VectorX<double> random_configuration(const Model& m, Random& random) {
  VectorX<double> v(m.dofs());
  for (Index k = 0; k < v.size(); ++k) v[k] = random.number();
  return integrate<double>(m, neutral(m), v);
}

}  // namespace delassus::unit
