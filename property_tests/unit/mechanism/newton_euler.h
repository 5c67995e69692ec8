// A second way to c(q, ν), for the tests: Newton–Euler in spatial 6-vectors about the reference point held where it is, plain Eigen.
//
//   V_i = V_π + S_i ν_i,   A_i = A_π + Σ_k V_b(k) × S_k ν_k,   f_i = H_i A_i + V_i ×* H_i V_i − weight,   c_k = S_kᵀ Σ f
//   b(k): what carries the axis of k – the parent, and the slides of a joint that turns about a moving origin; for the second axis
//   of a universal joint the first turn too; the body itself for ball joints and floating frames.
// Of the library it takes the numbers S and H of a Problem, and nothing of motion.h. Defects can be put in, so that a judge is seen
// to notice them.
#pragma once

#include "algorithms/mechanism/kinematics.h"

namespace delassus {

enum class NewtonEulerDefect {
  none,
  axes_stand_still,          ///< no V × S
  axis_carried_by_child,     ///< by the body itself: the same for one axis alone and for ball joints, not for universal and planar ones
  second_axis_not_carried,   ///< universal: by the parent alone
  origin_stands_still,       ///< planar: turns about where the origin was
  momentum_not_turned,       ///< no V ×* H V
  cross_the_other_way,       ///< A_i with S × V
  no_children,               ///< forces not summed inwards
  weight_at_the_frame        ///< of the frame's origin instead of the centre of mass
};

template <class T> Vector6<T> motion_cross(const Vector6<T>& v, const Vector6<T>& s) {
  const Vector3<T> w = v.template head<3>(), u = v.template tail<3>(), a = s.template head<3>(), b = s.template tail<3>();
  Vector6<T> out;
  out << w.cross(a), w.cross(b) + u.cross(a);
  return out;
}
template <class T> Vector6<T> force_cross(const Vector6<T>& v, const Vector6<T>& f) {
  const Vector3<T> w = v.template head<3>(), u = v.template tail<3>(), n = f.template head<3>(), b = f.template tail<3>();
  Vector6<T> out;
  out << w.cross(n) + u.cross(b), w.cross(b);
  return out;
}

template <class T>
VectorX<T> newton_euler(const Model& model, const Problem<T>& p, const Poses<T>& poses, const VectorX<T>& nu, const Vector3<T>& g,
                        NewtonEulerDefect defect = NewtonEulerDefect::none) {
  using D = NewtonEulerDefect;
  const std::size_t N = model.bodies.size();
  std::vector<Vector6<T>> V(N, Vector6<T>::Constant(T(0))), A(V), f(V);
  for (std::size_t i = 0; i < N; ++i) {
    const Body& body = model.bodies[i];
    if (body.parent != ground) V[i] = V[body.parent], A[i] = A[body.parent];
    const Index first = model.first_dof[i], n = model.first_dof[i + 1] - first;
    Vector6<T> carrier = V[i];
    for (Index k = 0; k < n; ++k) V[i] += p.S[first + k] * nu[first + k];
    if (body.joint.type == JointType::planar && defect != D::origin_stands_still)
      for (Index k = 1; k < 3; ++k) carrier += p.S[first + k] * nu[first + k];
    const bool with_body = body.joint.type == JointType::spherical || body.joint.type == JointType::floating;
    if (with_body || defect == D::axis_carried_by_child) carrier = V[i];
    for (Index k = 0; k < n && defect != D::axes_stand_still; ++k) {
      const Vector6<T> turned = motion_cross<T>(carrier, p.S[first + k]) * nu[first + k];
      if (defect == D::cross_the_other_way) A[i] -= turned;
      else A[i] += turned;
      if (body.joint.type == JointType::universal && defect != D::second_axis_not_carried) carrier += p.S[first + k] * nu[first + k];
    }
    const Vector6<T> momentum = p.H[i] * V[i];
    f[i] = p.H[i] * A[i];
    if (defect != D::momentum_not_turned) f[i] += force_cross<T>(V[i], momentum);
    Vector3<T> at = poses.position[i];
    if (defect != D::weight_at_the_frame) at += poses.rotation[i] * Vector3<T>(body.com.cast<T>());
    const Vector3<T> weight = T(body.mass) * g;
    f[i].template head<3>() -= at.cross(weight);
    f[i].template tail<3>() -= weight;
  }
  VectorX<T> c(nu.size());
  for (std::size_t i = N; i-- > 0;) {
    for (Index k = model.first_dof[i]; k < model.first_dof[i + 1]; ++k) c[k] = p.S[k].dot(f[i]);
    if (model.bodies[i].parent != ground && defect != D::no_children) f[model.bodies[i].parent] += f[i];
  }
  return c;
}

}  // namespace delassus
