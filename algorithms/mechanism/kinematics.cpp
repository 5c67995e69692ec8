#include "algorithms/mechanism/kinematics.h"

#include <cmath>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/mechanism.h"

namespace delassus {
namespace {

/// Rotation of a quaternion w x y z of any length but zero.
template <class T> Matrix3<T> quaternion_rotation(const T& w, const Vector3<T>& v) {
  const T scale = T(2) / (w * w + v.dot(v));
  const Matrix3<T> c = cross_matrix(v);
  return Matrix3<T>::Identity() + scale * (w * c + c * c);
}

/// c_k(x) = Σ_j (−x)^j / (2j + k)!, k = 1, 2, 3: sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ at x = θ². The series is
/// summed until a term no longer changes the sum where it is short; elsewhere the closed form has no cancellation.
template <class T> T series_or_closed(int k, const T& x) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (x < T(1)) {
    T sum(0), term(k == 3 ? T(1) / T(6) : k == 2 ? T(1) / T(2) : T(1));
    for (int j = 1;; ++j) {
      const T next = sum + term;
      if (!(next < sum) && !(next > sum)) return next;
      sum = next;
      term = term * (-x) / T((2 * j + k) * (2 * j + k - 1));
    }
  }
  const T theta = sqrt(x);
  if (k == 1) return sin(theta) / theta;
  return k == 2 ? (T(1) - cos(theta)) / x : (theta - sin(theta)) / (x * theta);
}

void check_q(const Model& model, Index size) {
  require(size == model.q_size(), "q does not have Model::q_size() entries");
}

/// (w, v) ← (w, v) exp(ω): the quaternion turned by ω in body axes.
template <class T> void turn(T* quaternion, const Vector3<T>& omega) {
  using std::cos;
  using std::sqrt;
  const T x = omega.dot(omega) / T(4);  // half angle, squared
  const T c = cos(T(sqrt(x)));
  const Vector3<T> s = series_or_closed(1, x) / T(2) * omega;
  const T w = quaternion[0];
  const Vector3<T> v(quaternion[1], quaternion[2], quaternion[3]);
  const Vector3<T> turned = w * s + c * v + v.cross(s);
  quaternion[0] = w * c - v.dot(s);
  for (Index k = 0; k < 3; ++k) quaternion[1 + k] = turned[k];
}

/// Displacement of the origin, in the axes at the start, of a frame that moves for unit time with the constant body
/// velocity (ω, v): (1 + c₂ ω̂ + c₃ ω̂²) v.
template <class T> Vector3<T> displacement(const Vector3<T>& omega, const Vector3<T>& v) {
  const T x = omega.dot(omega);
  const Vector3<T> wv = omega.cross(v);
  return v + series_or_closed(2, x) * wv + series_or_closed(3, x) * omega.cross(wv);
}

}  // namespace

std::shared_ptr<const Structure> structure_of(const Model& model) {
  auto s = std::make_shared<Structure>();
  s->parent.reserve(model.bodies.size());
  s->first_dof.reserve(model.bodies.size() + 1);
  for (const Body& body : model.bodies) s->add_body(body.parent, dof_count(body.joint.type));
  for (const Constraint& c : model.constraints) {
    validate_constraint(model, c, "");
    if (acts_on_joint(c.kind)) s->add_joint_constraint(row_count(model, c), c.a.body);
    else s->add_link_constraint(row_count(model, c), attached_bodies(model, c));
  }
  return s;
}

template <class T> void poses(const Model& model, const VectorX<T>& q, Poses<T>& out) {
  auto bodies = Mechanism<T>::bodies_of(model);
  bodies.update(q);
  bodies.poses(out);
}

template <class T> void kinematics(const Model& model, const VectorX<T>& q, Poses<T>& at, Problem<T>& out) {
  out.check_sizes();
  Mechanism<T> mechanism(model, out.structure);
  mechanism.update(q);
  mechanism.poses(at);
  mechanism.fill(out);
}

template <class T> Problem<T> kinematics(const Model& model, const VectorX<T>& q) {
  Mechanism<T> mechanism(model);
  Problem<T> out(mechanism.structure());
  mechanism.update(q);
  mechanism.fill(out);
  return out;
}

template <class T> VectorX<T> integrate(const Model& model, const VectorX<T>& q, const VectorX<T>& v) {
  check_q(model, q.size());
  require(v.size() == model.dofs(), "integrate: v does not have Model::dofs() entries");
  VectorX<T> out = q;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    T* to = out.data() + model.first_q[i];
    const T* rate = v.data() + model.first_dof[i];
    const JointType type = model.bodies[i].joint.type;
    if (type == JointType::spherical) turn(to, Vector3<T>(rate[0], rate[1], rate[2]));
    else if (type == JointType::floating) {
      const Vector3<T> omega(rate[0], rate[1], rate[2]), velocity(rate[3], rate[4], rate[5]);
      const Vector3<T> move = quaternion_rotation<T>(to[3], {to[4], to[5], to[6]}) * displacement(omega, velocity);
      for (Index k = 0; k < 3; ++k) to[k] += move[k];
      turn(to + 3, omega);
    } else
      for (Index k = 0; k < q_size(type); ++k) to[k] += rate[k];
  }
  return out;
}

#define DELASSUS_INSTANTIATE(T)                                                              \
  template void poses<T>(const Model&, const VectorX<T>&, Poses<T>&);                        \
  template void kinematics<T>(const Model&, const VectorX<T>&, Poses<T>&, Problem<T>&);      \
  template Problem<T> kinematics<T>(const Model&, const VectorX<T>&);                        \
  template VectorX<T> integrate<T>(const Model&, const VectorX<T>&, const VectorX<T>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
