// A number and its rate: x + ẋ ε with ε² = 0, over any scalar. A function evaluated in jets along q̇(ν) gives its exact time
// derivative; it knows nothing of velocities but how coordinates move.
//
// Angles over Rational: an angle coordinate stands for t = tan(θ/2), so that cos θ = (1 − t²)/(1 + t²) and sin θ = 2t/(1 + t²) are
// rational, and so is the rate ṫ = (1 + t²)/2 θ̇.
#pragma once

#include <stdexcept>

#include "algorithms/kit/exact.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/model.h"

namespace delassus {

template <class T> struct Jet {
  T value{0}, rate{0};
  Jet() = default;
  Jet(double x) : value(x) {}
  Jet(int x) : value(x) {}
  Jet(T v, T r) : value(std::move(v)), rate(std::move(r)) {}
  explicit operator double() const { return static_cast<double>(value); }
  Jet& operator+=(const Jet& o) { return value += o.value, rate += o.rate, *this; }
  Jet& operator-=(const Jet& o) { return value -= o.value, rate -= o.rate, *this; }
  Jet& operator*=(const Jet& o) { return rate = rate * o.value + value * o.rate, value *= o.value, *this; }
  Jet& operator/=(const Jet& o) { return value /= o.value, rate = (rate - value * o.rate) / o.value, *this; }
  friend Jet operator+(Jet a, const Jet& b) { return a += b; }
  friend Jet operator-(Jet a, const Jet& b) { return a -= b; }
  friend Jet operator*(Jet a, const Jet& b) { return a *= b; }
  friend Jet operator/(Jet a, const Jet& b) { return a /= b; }
  friend Jet operator-(const Jet& a) { return {-a.value, -a.rate}; }
  friend bool operator==(const Jet& a, const Jet& b) { return a.value == b.value && a.rate == b.rate; }
  friend bool operator<(const Jet& a, const Jet& b) { return a.value < b.value; }
  friend bool operator>(const Jet& a, const Jet& b) { return a.value > b.value; }
};

template <class T> Jet<T> abs(const Jet<T>& x) { return x.value < T(0) ? -x : x; }

/// Of the square of a rational number. @throws std::logic_error for another number.
inline Rational exact_root(const Rational& x) {
  const mpz_class top = ::sqrt(x.v.get_num()), bottom = ::sqrt(x.v.get_den());
  if (top * top != x.v.get_num() || bottom * bottom != x.v.get_den()) throw std::logic_error("jet: no rational square root");
  return Rational(mpq_class(top, bottom));
}
inline Jet<Rational> sqrt(const Jet<Rational>& x) {
  const Rational root = exact_root(x.value);
  return {root, root == Rational(0) ? Rational(0) : x.rate / (Rational(2) * root)};
}
inline Jet<Rational> cos(const Jet<Rational>& t) { return (Jet<Rational>(1) - t * t) / (Jet<Rational>(1) + t * t); }
inline Jet<Rational> sin(const Jet<Rational>& t) { return (t + t) / (Jet<Rational>(1) + t * t); }

inline Jet<Quad> sqrt(const Jet<Quad>& x) {
  const Quad root = sqrt(x.value);
  return {root, x.rate / (root + root)};
}
inline Jet<Quad> cos(const Jet<Quad>& x) { return {cos(x.value), -sin(x.value) * x.rate}; }
inline Jet<Quad> sin(const Jet<Quad>& x) { return {sin(x.value), cos(x.value) * x.rate}; }

template <class T> struct ScalarTraits<Jet<T>> {
  static constexpr bool exact = ScalarTraits<T>::exact;
};
// Defined in jet.cpp.
template <> Problem<Jet<Rational>>::Problem(std::shared_ptr<const Structure>);
template <> Problem<Jet<Quad>>::Problem(std::shared_ptr<const Structure>);
template <> void Problem<Jet<Rational>>::check_sizes() const;
template <> void Problem<Jet<Quad>>::check_sizes() const;

template <> inline constexpr double unit_roundoff<Jet<Quad>> = 0x1p-113;

/// q with the rates q̇(ν): of angles and displacements ν itself, of quaternions ½ x ∘ (0, ω), of a floating frame's origin R v.
template <class T> VectorX<Jet<T>> along(const Model& model, const VectorX<T>& q, const VectorX<T>& nu) {
  VectorX<Jet<T>> out(q.size());
  const auto angle = [&](Index k, const T& rate) {
    T factor(1);
    if constexpr (std::is_same_v<T, Rational>) factor = (T(1) + q[k] * q[k]) / T(2);
    out[k] = {q[k], factor * rate};
  };
  const auto quaternion = [&](Index k, const T* omega) {
    const T &w = q[k], &x = q[k + 1], &y = q[k + 2], &z = q[k + 3], half = T(1) / T(2);
    out[k] = {w, -half * (x * omega[0] + y * omega[1] + z * omega[2])};
    out[k + 1] = {x, half * (w * omega[0] + y * omega[2] - z * omega[1])};
    out[k + 2] = {y, half * (w * omega[1] + z * omega[0] - x * omega[2])};
    out[k + 3] = {z, half * (w * omega[2] + x * omega[1] - y * omega[0])};
  };
  const auto turned = [&](Index k, const T* v) {  // by the quaternion at k, of any length
    const Vector3<T> axis(q[k + 1], q[k + 2], q[k + 3]), x(v[0], v[1], v[2]), across = axis.cross(x);
    const T scale = T(2) / (q[k] * q[k] + axis.dot(axis));
    return Vector3<T>(x + scale * (q[k] * across + axis.cross(across)));
  };
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Index k = model.first_q[i];
    const T* const rate = nu.data() + model.first_dof[i];
    const auto moved = [&](Index at, const T& speed) { out[at] = {q[at], speed}; };
    switch (model.bodies[i].joint.type) {
      case JointType::revolute: angle(k, rate[0]); break;
      case JointType::prismatic: moved(k, rate[0]); break;
      case JointType::universal: angle(k, rate[0]), angle(k + 1, rate[1]); break;
      case JointType::planar: angle(k, rate[0]), moved(k + 1, rate[1]), moved(k + 2, rate[2]); break;
      case JointType::cylindrical: angle(k, rate[0]), moved(k + 1, rate[1]); break;
      case JointType::spherical: quaternion(k, rate); break;
      case JointType::floating: {
        const Vector3<T> v = turned(k + 3, rate + 3);
        for (Index c = 0; c < 3; ++c) moved(k + c, v[c]);
        quaternion(k + 3, rate);
        break;
      }
    }
  }
  return out;
}

}  // namespace delassus

namespace Eigen {
template <class T> struct NumTraits<delassus::Jet<T>> : NumTraits<T> {
  using Real = delassus::Jet<T>;
  using NonInteger = delassus::Jet<T>;
  using Nested = delassus::Jet<T>;
  using Literal = double;
  enum { RequireInitialization = 1 };
  static Real epsilon() { return {0}; }
  static Real dummy_precision() { return {0}; }
};
}  // namespace Eigen
