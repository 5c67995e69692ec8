// The kit the recursions are written on: a 6-vector and a 6×6 matrix of six columns.
//
//   Six<T>       six numbers; in double and float eight lanes (lanes.h) whose last two hold 0
//   SixBySix<T>  six Six columns
//   Lanes<T>     eight right-hand sides side by side: the value type V of a sweep over eight columns
//
// A sweep holds its matrices in T and its vectors in V, where V is T itself (one column) or Lanes<T> (eight).
// A NaN or infinity reaches every sum it touches.
#pragma once

#include <type_traits>

#include "algorithms/kit/lanes.h"
#include "algorithms/kit/scalars.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

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
template <class T> requires has_lanes<T> struct Six<T> {
  Lanes<T> v;
  T operator[](int k) const { return v[k]; }
  static Six zero() { return {Lanes<T>{}}; }
};

/// The six numbers from x on.
template <class T> [[nodiscard]] inline Six<T> load(const T* x) {
  Six<T> y;
  if constexpr (has_lanes<T>) y.v = load_six(x);
  else for (int k = 0; k < 6; ++k) y.v[k] = x[k];
  return y;
}

template <class T> [[nodiscard]] inline Six<T> load(const Vector6<T>& x) { return load(x.data()); }

/// The first n numbers from x on, then zeros.
template <class T> [[nodiscard]] inline Six<T> load(const T* x, int n) {
  if (n == 6) return load(x);
  Six<T> y = Six<T>::zero();
  for (int k = 0; k < n; ++k) y.v[k] = x[k];
  return y;
}
/// The k-th unit vector.
template <class T> [[nodiscard]] inline Six<T> unit_vector(int k) {
  Six<T> y = Six<T>::zero();
  y.v[k] = T(1);
  return y;
}

/// The lanes of x in V.
template <class V, class T> [[nodiscard]] inline Lanes<V> lanes(const Six<T>& x) {
  if constexpr (std::is_same_v<V, T>) return x.v;
  else return widened(x.v);
}

/// y += x · s
template <class T, class V> inline void add_scaled(Six<V>& y, const Six<T>& x, const V& s) {
  if constexpr (has_lanes<V>) y.v += lanes<V>(x) * s;
  else for (int k = 0; k < 6; ++k) y.v[k] += x[k] * s;
}
/// y −= x · s
template <class T, class V> inline void subtract_scaled(Six<V>& y, const Six<T>& x, const V& s) {
  if constexpr (has_lanes<V>) y.v -= lanes<V>(x) * s;
  else for (int k = 0; k < 6; ++k) y.v[k] -= x[k] * s;
}
template <class T> inline void add(Six<T>& y, const Six<T>& x) {
  if constexpr (has_lanes<T>) y.v += x.v;
  else for (int k = 0; k < 6; ++k) y.v[k] += x.v[k];
}
template <class T> inline void scale(Six<T>& y, const T& s) {
  if constexpr (has_lanes<T>) y.v *= s;
  else for (int k = 0; k < 6; ++k) y.v[k] *= s;
}

/// x · s
template <class T, class V> [[nodiscard]] inline Six<V> scaled(const Six<T>& x, const V& s) {
  Six<V> y;
  if constexpr (has_lanes<V>) y.v = lanes<V>(x) * s;
  else for (int k = 0; k < 6; ++k) y.v[k] = x[k] * s;
  return y;
}
template <class T> [[nodiscard]] inline Six<T> negated(const Six<T>& x) {
  Six<T> y;
  if constexpr (has_lanes<T>) y.v = -x.v;
  else for (int k = 0; k < 6; ++k) y.v[k] = -x.v[k];
  return y;
}

/// xᵀ y
template <class T, class V> [[nodiscard]] inline V dot(const Six<T>& x, const Six<V>& y) {
  if constexpr (has_lanes<V>) {
    return total(lanes<V>(x) * y.v);
  } else {
    V sum = x[0] * y.v[0];
    for (int k = 1; k < 6; ++k) sum += x[k] * y.v[k];
    return sum;
  }
}

/// x ∘ y, entry by entry.
template <class T, class V> [[nodiscard]] inline Six<V> product(const Six<T>& x, const Six<V>& y) {
  Six<V> p;
  if constexpr (has_lanes<V>) p.v = lanes<V>(x) * y.v;
  else for (int k = 0; k < 6; ++k) p.v[k] = x[k] * y.v[k];
  return p;
}

/// p += x ∘ y
template <class T> requires has_lanes<T> inline void add_product(Six<T>& p, const Six<T>& x, const Six<T>& y) { p.v += x.v * y.v; }

/// What is left of x when its halves are added.
template <class T> requires has_lanes<T> [[nodiscard, gnu::always_inline]] inline auto folded(const Six<T>& x) { return lower(x.v) + upper(x.v); }
template <int... lane> [[nodiscard, gnu::always_inline]] inline Lanes4 picked(const Lanes4& a, const Lanes4& b) {
  return __builtin_shufflevector(a, b, lane...);
}
template <int... lane> [[nodiscard, gnu::always_inline]] inline Lanes4f picked(const Lanes4f& a, const Lanes4f& b) {
  return __builtin_shufflevector(a, b, lane...);
}
[[nodiscard, gnu::always_inline]] inline Lanes4 added(const Lanes4& x, const Lanes4& y) { return x + y; }
[[nodiscard, gnu::always_inline]] inline Lanes4f added(const Lanes4f& x, const Lanes4f& y) { return x + y; }
/// Σ_k p[r][k] for four of them at once, in the order of total().
template <class V> [[nodiscard, gnu::always_inline]] inline auto four_sums(const Six<V> (&p)[4]) {
  const auto pairs = [](const auto& a, const auto& b) { return added(picked<0, 1, 4, 5>(a, b), picked<2, 3, 6, 7>(a, b)); };
  const auto t = pairs(folded(p[0]), folded(p[1])), u = pairs(folded(p[2]), folded(p[3]));
  return added(picked<0, 2, 4, 6>(t, u), picked<1, 3, 5, 7>(t, u));
}
template <class V> [[gnu::always_inline]] inline void sums_in_lanes(const Six<V> (&p)[4], V (&sum)[4]) {
  const auto s = four_sums(p);
  for (int r = 0; r < 4; ++r) sum[r] = s[r];
}
/// The same for the first `count` of them; the others must be zero.
template <class V> inline void sums(const Six<V> (&p)[4], V (&sum)[4], Index count) {
  if constexpr (has_lanes<V>) sums_in_lanes(p, sum);
  else
    for (Index r = 0; r < count; ++r) {
      sum[r] = p[r].v[0];
      for (int k = 1; k < 6; ++k) sum[r] += p[r].v[k];
    }
}

/// u_c += x_cᵀ y of n columns; three sums at once with lanes.
template <class T, class V> [[gnu::always_inline]] inline void add_dots(V* u, const Six<T>* x, const Six<V>& y, int n) {
  int c = 0;
  if constexpr (has_lanes<V> && sums_together)
    for (; c + 3 <= n; c += 3) {
      const Six<V> p[4] = {product(x[c], y), product(x[c + 1], y), product(x[c + 2], y), Six<V>::zero()};
      const auto sum = four_sums(p);
      for (int r = 0; r < 3; ++r) u[c + r] += sum[r];
    }
  for (; c < n; ++c) u[c] += dot(x[c], y);
}

/// u_c −= x_cᵀ y of n columns.
template <class T, class V> [[gnu::always_inline]] inline void subtract_dots(V* u, const Six<T>* x, const Six<V>& y, int n) {
  int c = 0;
  if constexpr (has_lanes<V> && sums_together)
    for (; c + 3 <= n; c += 3) {
      const Six<V> p[4] = {product(x[c], y), product(x[c + 1], y), product(x[c + 2], y), Six<V>::zero()};
      const auto sum = four_sums(p);
      for (int r = 0; r < 3; ++r) u[c + r] -= sum[r];
    }
  for (; c < n; ++c) u[c] -= dot(x[c], y);
}

template <class T> struct SixBySix {
  Six<T> column[6];
  static SixBySix zero() { SixBySix m; for (auto& c : m.column) c = Six<T>::zero(); return m; }
};

/// f(0) … f(5); with lanes no loop, so that six columns stay in registers.
template <class T, class F> [[gnu::always_inline]] inline void for_columns_of_six(F&& f) {
  if constexpr (has_lanes<T>) f(0), f(1), f(2), f(3), f(4), f(5);
  else for (int c = 0; c < 6; ++c) f(c);
}
/// y = x
template <class T> [[gnu::always_inline]] inline void copy(const SixBySix<T>& x, SixBySix<T>& y) {
  for_columns_of_six<T>([&](int c) { y.column[c] = x.column[c]; });
}
template <class T> [[nodiscard, gnu::always_inline]] inline SixBySix<T> copied(const SixBySix<T>& x) {
  SixBySix<T> y;
  copy(x, y);
  return y;
}

template <class T> [[nodiscard]] inline SixBySix<T> load(const Matrix6<T>& x) {
  SixBySix<T> y;
  for (int c = 0; c < 6; ++c) y.column[c] = load<T>(x.data() + 6 * c);
  return y;
}
/// m x, by two chains of sums
template <class T, class V> [[nodiscard]] inline Six<V> multiply(const SixBySix<T>& m, const Six<V>& x) {
  Six<V> y = scaled(m.column[0], V(x[0])), z = scaled(m.column[1], V(x[1]));
  add_scaled(y, m.column[2], V(x[2]));
  add_scaled(z, m.column[3], V(x[3]));
  add_scaled(y, m.column[4], V(x[4]));
  add_scaled(z, m.column[5], V(x[5]));
  add(y, z);
  return y;
}
template <class T> [[gnu::always_inline]] inline void add(SixBySix<T>& y, const SixBySix<T>& x) {
  for_columns_of_six<T>([&](int c) { add(y.column[c], x.column[c]); });
}
template <class T> [[nodiscard]] inline SixBySix<T> transposed(const SixBySix<T>& x) {
  SixBySix<T> y;
  if constexpr (std::is_same_v<T, double>) {
    Lanes8 r[6];
    for (int c = 0; c < 6; ++c) r[c] = x.column[c].v;
    transpose_six(r);
    for (int c = 0; c < 6; ++c) y.column[c].v = r[c];
    return y;
  }
  for (int c = 0; c < 6; ++c) {
    y.column[c] = Six<T>::zero();  // the lanes behind too
    for (int r = 0; r < 6; ++r) y.column[c].v[r] = x.column[r].v[c];
  }
  return y;
}
/// m += x yᵀ
template <class T> [[gnu::always_inline]] inline void add_outer(SixBySix<T>& m, const Six<T>& x, const Six<T>& y) {
  for_columns_of_six<T>([&](int c) { add_scaled(m.column[c], x, T(y[c])); });
}
/// m += Σ_r x_r y_rᵀ, r < n
template <class T> inline void add_products(SixBySix<T>& m, const Six<T>* x, const Six<T>* y, Index n) {
  SixBySix<T> sum = copied(m);
  for (Index r = 0; r < n; ++r) add_outer(sum, x[r], y[r]);
  copy(sum, m);
}
/// m −= x yᵀ
template <class T> [[gnu::always_inline]] inline void subtract_outer(SixBySix<T>& m, const Six<T>& x, const Six<T>& y) {
  for_columns_of_six<T>([&](int c) { subtract_scaled(m.column[c], x, T(y[c])); });
}
/// m −= Σ_r x_r y_rᵀ, r < n
template <class T, class N> inline void subtract_products(SixBySix<T>& m, const Six<T>* x, const Six<T>* y, N n) {
  SixBySix<T> sum = copied(m);
  for (int r = 0; r < n; ++r) subtract_outer(sum, x[r], y[r]);
  copy(sum, m);
}

}  // namespace delassus
