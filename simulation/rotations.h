// Rotations by quaternions w x y z of any length but zero.
#pragma once

#include <cmath>

#include "algorithms/kit/spatial.h"

namespace delassus::simulation {

/// x rotated by a quaternion w x y z of any length but zero; `inverse`: back.
template <class T> [[nodiscard]] Vector3<T> rotate(const T* q, const Vector3<T>& x, bool inverse) {
  const T w = inverse ? T(-q[0]) : q[0];
  const Vector3<T> v(q[1], q[2], q[3]), c = v.cross(x);
  return x + (T(2) / (w * w + v.dot(v))) * (w * c + v.cross(c));
}

/// sin θ/θ at x = θ²: the series where it is short.
template <class T> [[nodiscard]] T sine_over(const T& x) {
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

template <class T> [[nodiscard]] Vector3<T> three_of(const T* x) { return {x[0], x[1], x[2]}; }

}  // namespace delassus::simulation
