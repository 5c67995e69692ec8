// Twice the digits for residuals: Wide<double> = DoubleDouble (106 bits by error-free transformations),
// Wide<float> = double, and any other scalar itself.
//
// Files that include this header must be compiled with -ffp-contract=off: the transformations below are exact only when
// every operation is rounded as written.
// Source: T. J. Dekker, A floating-point technique for extending the available precision, 1971 (two_sum, two_product).
#pragma once

#include "algorithms/six.h"

namespace delassus {

/// An unevaluated sum hi + lo, |lo| ≤ ½ ulp(hi).
struct DoubleDouble {
  double hi = 0, lo = 0;
  DoubleDouble() = default;
  DoubleDouble(double x) : hi(x) {}
  DoubleDouble(double h, double l) : hi(h), lo(l) {}
  explicit operator double() const { return hi; }
};

/// Exact: a + b = sum + error, for any real type with lane-wise arithmetic.
template <class R> struct Exact { R value, error; };
template <class R> [[nodiscard]] inline Exact<R> two_sum(const R& a, const R& b) {
  const R s = a + b, bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
/// Exact when |a| ≥ |b|.
template <class R> [[nodiscard]] inline Exact<R> fast_two_sum(const R& a, const R& b) {
  const R s = a + b;
  return {s, b - (s - a)};
}
[[nodiscard]] inline Exact<double> two_product(double a, double b) {
  const double p = a * b;
  return {p, __builtin_fma(a, b, -p)};
}
[[nodiscard]] inline Exact<Lanes8> two_product(const Lanes8& a, double b) {
  const Lanes8 p = a * b;
  Lanes8 e;
  for (int l = 0; l < 8; ++l) e[l] = __builtin_fma(a[l], b, -p[l]);
  return {p, e};
}
[[nodiscard]] inline Exact<Lanes8> two_product(const Lanes8& a, const Lanes8& b) {
  const Lanes8 p = a * b;
  Lanes8 e;
  for (int l = 0; l < 8; ++l) e[l] = __builtin_fma(a[l], b[l], -p[l]);
  return {p, e};
}

inline DoubleDouble& operator+=(DoubleDouble& x, const DoubleDouble& y) {
  const auto s = two_sum(x.hi, y.hi);
  const auto r = fast_two_sum(s.value, s.error + (x.lo + y.lo));
  return x = {r.value, r.error};
}
inline DoubleDouble operator-(const DoubleDouble& x) { return {-x.hi, -x.lo}; }
inline DoubleDouble& operator-=(DoubleDouble& x, const DoubleDouble& y) { return x += -y; }
inline DoubleDouble operator+(DoubleDouble x, const DoubleDouble& y) { return x += y; }
inline DoubleDouble operator-(DoubleDouble x, const DoubleDouble& y) { return x -= y; }
inline DoubleDouble operator*(const DoubleDouble& x, double s) {
  const auto p = two_product(x.hi, s);
  const auto r = fast_two_sum(p.value, p.error + x.lo * s);
  return {r.value, r.error};
}

/// Six unevaluated sums.
template <> struct Six<DoubleDouble> {
  Lanes8 hi, lo;
  static Six zero() { return {Lanes8{}, Lanes8{}}; }
  DoubleDouble operator[](int k) const { return {hi[k], lo[k]}; }
};
inline void accumulate(Six<DoubleDouble>& y, const Lanes8& hi, const Lanes8& lo) {
  const auto s = two_sum(y.hi, hi);
  const auto r = fast_two_sum(s.value, Lanes8(s.error + (y.lo + lo)));
  y = {r.value, r.error};
}
inline void add(Six<DoubleDouble>& y, const Six<DoubleDouble>& x) { accumulate(y, x.hi, x.lo); }
inline void add_scaled(Six<DoubleDouble>& y, const Six<double>& x, const DoubleDouble& s) {
  const auto p = two_product(x.v, s.hi);
  accumulate(y, p.value, p.error + x.v * s.lo);
}
inline void subtract_scaled(Six<DoubleDouble>& y, const Six<double>& x, const DoubleDouble& s) { add_scaled(y, x, -s); }
[[nodiscard]] inline DoubleDouble dot(const Six<double>& x, const Six<DoubleDouble>& y) {
  const auto p = two_product(x.v, y.hi);
  const Lanes8 e = p.error + x.v * y.lo;
  DoubleDouble sum(p.value[0], e[0]);
  for (int k = 1; k < 6; ++k) sum += DoubleDouble(p.value[k], e[k]);
  return sum;
}

template <class T> struct WideOf { using type = T; };
template <> struct WideOf<double> { using type = DoubleDouble; };
template <> struct WideOf<float> { using type = double; };
template <class T> using Wide = typename WideOf<T>::type;

/// x rounded to T.
template <class T> [[nodiscard]] inline T narrow(const Wide<T>& x) {
  if constexpr (std::is_same_v<Wide<T>, T>) return x;
  else return static_cast<T>(static_cast<double>(x));
}

}  // namespace delassus
