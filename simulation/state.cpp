#include "simulation/state.h"

#include <cmath>

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// x rotated by a quaternion w x y z of any length but zero; `inverse`: back.
template <class T> Vector3<T> rotate(const T* q, const Vector3<T>& x, bool inverse) {
  const T w = inverse ? T(-q[0]) : q[0];
  const Vector3<T> v(q[1], q[2], q[3]), c = v.cross(x);
  return x + (T(2) / (w * w + v.dot(v))) * (w * c + v.cross(c));
}

/// sin θ/θ at x = θ²: the series where it is short.
template <class T> T sine_over(const T& x) {
  using std::sin;
  using std::sqrt;
  if (!(x < T(1))) return sin(T(sqrt(x))) / T(sqrt(x));
  T sum(0), term(1);
  for (int k = 1;; ++k) {
    const T next = sum + term;
    if (next == sum) return next;
    sum = next;
    term = term * (-x) / T(2 * k * (2 * k + 1));
  }
}

/// q ← q exp(angle): turned in body axes.
template <class T> void turn(T* q, const Vector3<T>& angle) {
  using std::cos;
  using std::sqrt;
  const T x = angle.dot(angle) / T(4), c = cos(T(sqrt(x))), w = q[0];
  const Vector3<T> s = sine_over(x) / T(2) * angle, v(q[1], q[2], q[3]);
  const Vector3<T> turned = w * s + c * v + v.cross(s);
  q[0] = w * c - v.dot(s);
  for (Index k = 0; k < 3; ++k) q[1 + k] = turned[k];
}

template <class T> Vector3<T> three_of(const T* x) { return {x[0], x[1], x[2]}; }

}  // namespace

template <class T> Advance<T>::Advance(const Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    joints_.push_back({type, model.first_q[i], model.first_dof[i], dof_count(type)});
  }
}

template <class T> void Advance<T>::operator()(const T& h, VectorX<T>& q, VectorX<T>& nu) const {
  for (const Joint& j : joints_) {
    T* const at = q.data() + j.q;
    T* const rate = nu.data() + j.dof;
    if (j.type == JointType::spherical) {
      turn(at, Vector3<T>(h * three_of(rate)));
    } else if (j.type == JointType::floating) {
      const Vector3<T> v = rotate(at + 3, three_of(rate + 3), false);
      for (Index k = 0; k < 3; ++k) at[k] += h * v[k];
      turn(at + 3, Vector3<T>(h * three_of(rate)));
      const Vector3<T> back = rotate(at + 3, v, true);
      for (Index k = 0; k < 3; ++k) rate[3 + k] = back[k];
    } else {
      for (Index k = 0; k < j.n; ++k) at[k] += h * rate[k];
    }
  }
}

template <class T> void Advance<T>::displace(const VectorX<T>& d, VectorX<T>& q) const {
  for (const Joint& j : joints_) {
    T* const at = q.data() + j.q;
    const T* const by = d.data() + j.dof;
    if (j.type == JointType::spherical) {
      turn(at, three_of(by));
    } else if (j.type == JointType::floating) {
      const Vector3<T> move = rotate(at + 3, three_of(by + 3), false);
      for (Index k = 0; k < 3; ++k) at[k] += move[k];
      turn(at + 3, three_of(by));
    } else {
      for (Index k = 0; k < j.n; ++k) at[k] += by[k];
    }
  }
}

template class Advance<double>;
template class Advance<Counted>;

}  // namespace delassus::simulation
