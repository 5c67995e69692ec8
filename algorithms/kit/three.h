// Vectors of three and 3×3 matrices of three columns, for kinematics: Three<double> is one vector of four lanes.
// The fourth lane of Three<double> holds nothing that is looked at; no operation carries it into another lane.
#pragma once

#include <type_traits>

#include "algorithms/kit/lanes.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

template <class T> struct Three {
  T v[3];
  const T& operator[](int k) const { return v[k]; }
};
template <> struct alignas(32) Three<double> {  // as with AVX: users hold it in a Mechanism
  Lanes4 v;
  double operator[](int k) const { return v[k]; }
};

template <class T> [[nodiscard]] inline Three<T> three(const T& x, const T& y, const T& z) {
  if constexpr (std::is_same_v<T, double>) return {Lanes4{x, y, z, 0}};
  else return {{x, y, z}};
}
template <class T> [[nodiscard]] inline Three<T> three(const Vector3<T>& x) { return three<T>(x[0], x[1], x[2]); }
template <class T> [[nodiscard]] inline Vector3<T> vector(const Three<T>& x) { return {x[0], x[1], x[2]}; }

template <class T> [[nodiscard]] inline Three<T> operator+(const Three<T>& x, const Three<T>& y) {
  if constexpr (std::is_same_v<T, double>) return {x.v + y.v};
  else return {{x[0] + y[0], x[1] + y[1], x[2] + y[2]}};
}
template <class T> [[nodiscard]] inline Three<T> operator-(const Three<T>& x, const Three<T>& y) {
  if constexpr (std::is_same_v<T, double>) return {x.v - y.v};
  else return {{x[0] - y[0], x[1] - y[1], x[2] - y[2]}};
}
template <class T> [[nodiscard]] inline Three<T> operator-(const Three<T>& x) {
  if constexpr (std::is_same_v<T, double>) return {-x.v};
  else return {{-x[0], -x[1], -x[2]}};
}
template <class T> [[nodiscard]] inline Three<T> operator*(const Three<T>& x, const T& s) {
  if constexpr (std::is_same_v<T, double>) return {x.v * s};
  else return {{x[0] * s, x[1] * s, x[2] * s}};
}
template <class T> [[nodiscard]] inline T dot(const Three<T>& x, const Three<T>& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

template <class T> [[nodiscard]] inline Three<T> cross(const Three<T>& x, const Three<T>& y) {
  if constexpr (std::is_same_v<T, double>) {
    const auto turned = [](const Lanes4& a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); };
    return {turned(x.v * turned(y.v) - turned(x.v) * y.v)};
  } else {
    return {{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]}};
  }
}

template <class T> struct ThreeByThree {
  Three<T> column[3];
};

template <class T> [[nodiscard]] inline ThreeByThree<T> three_by_three(const Matrix3<T>& x) {
  return {{three<T>(x.col(0)), three<T>(x.col(1)), three<T>(x.col(2))}};
}
template <class T> [[nodiscard]] inline Matrix3<T> matrix(const ThreeByThree<T>& x) {
  Matrix3<T> m;
  for (int c = 0; c < 3; ++c) m.col(c) = vector(x.column[c]);
  return m;
}
template <class T> [[nodiscard]] inline Three<T> operator*(const ThreeByThree<T>& m, const Three<T>& x) {
  return m.column[0] * T(x[0]) + m.column[1] * T(x[1]) + m.column[2] * T(x[2]);
}
template <class T> [[nodiscard]] inline ThreeByThree<T> operator*(const ThreeByThree<T>& m, const ThreeByThree<T>& x) {
  return {{m * x.column[0], m * x.column[1], m * x.column[2]}};
}
/// mᵀ x
template <class T> [[nodiscard]] inline Three<T> transposed_times(const ThreeByThree<T>& m, const Three<T>& x) {
  return three<T>(dot(m.column[0], x), dot(m.column[1], x), dot(m.column[2], x));
}
/// m xᵀ
template <class T> [[nodiscard]] inline ThreeByThree<T> times_transposed(const ThreeByThree<T>& m, const ThreeByThree<T>& x) {
  ThreeByThree<T> y;
  for (int r = 0; r < 3; ++r)
    y.column[r] = m.column[0] * T(x.column[0][r]) + m.column[1] * T(x.column[1][r]) + m.column[2] * T(x.column[2][r]);
  return y;
}

/// (upper; lower) as six numbers.
template <class T> inline void store(T* to, const Three<T>& upper, const Three<T>& lower) {
  if constexpr (std::is_same_v<T, double>) {
    *reinterpret_cast<UnalignedLanes4*>(to) = upper.v;
    typedef double Two __attribute__((vector_size(16), aligned(8)));
    *reinterpret_cast<Two*>(to + 3) = __builtin_shufflevector(lower.v, lower.v, 0, 1);
    to[5] = lower.v[2];
  } else {
    for (int k = 0; k < 3; ++k) to[k] = upper[k], to[3 + k] = lower[k];
  }
}

}  // namespace delassus
