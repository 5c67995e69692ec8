// The kit the recursions are written on: a 6-vector and a 6×6 matrix of six columns.
//
//   Six<T>       six numbers; Six<double> is one 8-lane vector whose last two lanes hold 0
//   SixBySix<T>  six Six columns
//   Lanes<T>     eight right-hand sides side by side: the value type V of a sweep over eight columns
//
// A sweep holds its matrices in T and its vectors in V, where V is T itself (one column) or Lanes<T> (eight).
// A NaN or infinity reaches every sum it touches.
#pragma once

#include <type_traits>

#include "algorithms/scalars.h"
#include "algorithms/spatial.h"

namespace delassus {

using Lanes8 = double __attribute__((vector_size(64)));
using Lanes8f = float __attribute__((vector_size(32)));

/// Eight columns at once where the scalar has vector instructions; void elsewhere.
template <class T> struct LanesOf { using type = void; };
template <> struct LanesOf<double> { using type = Lanes8; };
template <> struct LanesOf<float> { using type = Lanes8f; };
template <class T> using Lanes = typename LanesOf<T>::type;
template <class T> inline constexpr bool has_lanes = !std::is_void_v<Lanes<T>>;
inline constexpr Index lane_count = 8;

template <class T> struct Six {
  T v[6];
  const T& operator[](int k) const { return v[k]; }
  static Six zero() { Six x; for (T& e : x.v) e = T{}; return x; }
};
template <> struct Six<double> {
  Lanes8 v;
  double operator[](int k) const { return v[k]; }
  static Six zero() { return {Lanes8{}}; }
};

template <class T> [[nodiscard]] inline Six<T> load(const Vector6<T>& x) {
  Six<T> y;
  if constexpr (std::is_same_v<T, double>) y.v = Lanes8{x[0], x[1], x[2], x[3], x[4], x[5], 0, 0};
  else for (int k = 0; k < 6; ++k) y.v[k] = x[k];
  return y;
}

/// The lanes of x in double.
template <class T> [[nodiscard]] inline Lanes8 lanes(const Six<T>& x) {
  if constexpr (std::is_same_v<T, double>) return x.v;
  else return Lanes8{x[0], x[1], x[2], x[3], x[4], x[5], 0, 0};
}

/// y += x · s
template <class T, class V> inline void add_scaled(Six<V>& y, const Six<T>& x, const V& s) {
  if constexpr (std::is_same_v<V, double>) y.v += lanes(x) * s;
  else for (int k = 0; k < 6; ++k) y.v[k] += x[k] * s;
}
/// y −= x · s
template <class T, class V> inline void subtract_scaled(Six<V>& y, const Six<T>& x, const V& s) {
  if constexpr (std::is_same_v<V, double>) y.v -= lanes(x) * s;
  else for (int k = 0; k < 6; ++k) y.v[k] -= x[k] * s;
}
template <class T> inline void add(Six<T>& y, const Six<T>& x) {
  if constexpr (std::is_same_v<T, double>) y.v += x.v;
  else for (int k = 0; k < 6; ++k) y.v[k] += x.v[k];
}
template <class T> inline void scale(Six<T>& y, const T& s) {
  if constexpr (std::is_same_v<T, double>) y.v *= s;
  else for (int k = 0; k < 6; ++k) y.v[k] *= s;
}

/// xᵀ y
template <class T, class V> [[nodiscard]] inline V dot(const Six<T>& x, const Six<V>& y) {
  if constexpr (std::is_same_v<V, double>) {
    const Lanes8 p = lanes(x) * y.v;
    const auto four = __builtin_shufflevector(p, p, 0, 1, 2, 3) + __builtin_shufflevector(p, p, 4, 5, 6, 7);
    const auto two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
    return two[0] + two[1];
  } else {
    V sum = x[0] * y.v[0];
    for (int k = 1; k < 6; ++k) sum += x[k] * y.v[k];
    return sum;
  }
}

template <class T> struct SixBySix {
  Six<T> column[6];
  static SixBySix zero() { SixBySix m; for (auto& c : m.column) c = Six<T>::zero(); return m; }
};

template <class T> [[nodiscard]] inline SixBySix<T> load(const Matrix6<T>& x) {
  SixBySix<T> y;
  for (int c = 0; c < 6; ++c) y.column[c] = load<T>(Vector6<T>(x.col(c)));
  return y;
}
/// m x
template <class T> [[nodiscard]] inline Six<T> multiply(const SixBySix<T>& m, const Six<T>& x) {
  Six<T> y = m.column[0];
  scale(y, T(x[0]));
  for (int c = 1; c < 6; ++c) add_scaled(y, m.column[c], T(x[c]));
  return y;
}
template <class T> inline void add(SixBySix<T>& y, const SixBySix<T>& x) {
  for (int c = 0; c < 6; ++c) add(y.column[c], x.column[c]);
}
template <class T> [[nodiscard]] inline SixBySix<T> transposed(const SixBySix<T>& x) {
  SixBySix<T> y = SixBySix<T>::zero();
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) y.column[c].v[r] = x.column[r].v[c];
  return y;
}
/// m += x yᵀ
template <class T> inline void add_outer(SixBySix<T>& m, const Six<T>& x, const Six<T>& y) {
  for (int c = 0; c < 6; ++c) add_scaled(m.column[c], x, T(y[c]));
}
/// m −= x yᵀ
template <class T> inline void subtract_outer(SixBySix<T>& m, const Six<T>& x, const Six<T>& y) {
  for (int c = 0; c < 6; ++c) subtract_scaled(m.column[c], x, T(y[c]));
}

}  // namespace delassus
