// Twice the digits for residuals: Wide<double> = DoubleDouble (106 bits by error-free transformations), Wide<Quad> the same on
// Quad (226 bits), Wide<float> = double, and any other scalar itself. Of eight columns at once: Wide<Lanes8>.
//
// Files that include this header must be compiled with -ffp-contract=off: the transformations below are exact only when
// every operation is rounded as written.
// Source: T. J. Dekker, A floating-point technique for extending the available precision, 1971 (two_sum, two_product).
#pragma once

#include "algorithms/kit/quad.h"
#include "algorithms/kit/six.h"

extern "C" __float128 fmaq(__float128, __float128, __float128) noexcept;  // libquadmath's

namespace delassus {

/// Exact: a + b = value + error, for any real type with lane-wise arithmetic.
template <class R> struct Exact { R value, error; };
template <class R> [[nodiscard, gnu::always_inline]] inline Exact<R> two_sum(const R& a, const R& b) {
  const R s = a + b, bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
[[nodiscard]] inline Quad fused(const Quad& a, const Quad& b, const Quad& c) { return Quad(fmaq(a.v, b.v, c.v)); }
/// x (y.hi + y.lo) as value + error, to eps² of it.
template <class R> [[nodiscard, gnu::always_inline]] inline Exact<R> product(const R& x, const R& hi, const R& lo) {
  const R p = x * hi;
  return {p, fused(x, lo, fused(x, hi, R(-p)))};
}

/// An unevaluated sum hi + lo. It is not normalised: sums collect their rounding errors in lo, which stays within a few eps of
/// the magnitudes added, so that the whole carries an error of eps² of them.
template <class T> struct TwoFold {
  T hi{}, lo{};
  TwoFold() = default;
  TwoFold(const T& x) : hi(x) {}
  TwoFold(const T& h, const T& l) : hi(h), lo(l) {}
  explicit operator T() const { return hi + lo; }

  [[gnu::always_inline]] friend TwoFold& operator+=(TwoFold& x, const TwoFold& y) {
    const auto s = two_sum(x.hi, y.hi);
    return x = {s.value, s.error + (x.lo + y.lo)};
  }
  friend TwoFold operator-(const TwoFold& x) { return {-x.hi, -x.lo}; }
  friend TwoFold& operator-=(TwoFold& x, const TwoFold& y) { return x += -y; }
  friend TwoFold operator+(TwoFold x, const TwoFold& y) { return x += y; }
  friend TwoFold operator-(TwoFold x, const TwoFold& y) { return x -= y; }
  friend TwoFold operator*(const TwoFold& x, const T& s) {
    const auto p = product(s, x.hi, x.lo);
    return {p.value, p.error};
  }
  friend TwoFold operator*(const T& s, const TwoFold& x) { return x * s; }
  /// The same number in all lanes.
  template <class S> requires (std::is_same_v<S, double> && std::is_same_v<T, Lanes8>)
  friend TwoFold operator*(const TwoFold& x, const S& s) { return x * (T{} + s); }
  template <class S> requires (std::is_same_v<S, double> && std::is_same_v<T, Lanes8>)
  friend TwoFold operator*(const S& s, const TwoFold& x) { return x * (T{} + s); }
};
using DoubleDouble = TwoFold<double>;

/// Six unevaluated sums.
template <> struct Six<DoubleDouble> {
  Lanes8 hi, lo;
  static Six zero() { return {Lanes8{}, Lanes8{}}; }
  DoubleDouble operator[](int k) const { return {hi[k], lo[k]}; }
};
[[gnu::always_inline]] inline void add(Six<DoubleDouble>& y, const Six<DoubleDouble>& x) {
  const auto s = two_sum(y.hi, x.hi);
  y = {s.value, s.error + (y.lo + x.lo)};
}
[[nodiscard, gnu::always_inline]] inline Six<DoubleDouble> scaled(const Six<double>& x, const DoubleDouble& s) {
  const auto p = product(x.v, Lanes8{} + s.hi, Lanes8{} + s.lo);
  return {p.value, p.error};
}
[[nodiscard]] inline Six<DoubleDouble> negated(const Six<DoubleDouble>& x) { return {-x.hi, -x.lo}; }
[[gnu::always_inline]] inline void add_scaled(Six<DoubleDouble>& y, const Six<double>& x, const DoubleDouble& s) {
  add(y, scaled(x, s));
}
[[gnu::always_inline]] inline void subtract_scaled(Six<DoubleDouble>& y, const Six<double>& x, const DoubleDouble& s) {
  add_scaled(y, x, -s);
}
[[nodiscard, gnu::always_inline]] inline Six<DoubleDouble> product(const Six<double>& x, const Six<DoubleDouble>& y) {
  const auto p = product(x.v, y.hi, y.lo);
  return {p.value, p.error};
}
/// Four unevaluated sums.
struct DoubleDouble4 {
  Lanes4 hi, lo;
  DoubleDouble operator[](int k) const { return {hi[k], lo[k]}; }
};
[[nodiscard, gnu::always_inline]] inline DoubleDouble4 added(const DoubleDouble4& x, const DoubleDouble4& y) {
  const auto s = two_sum(x.hi, y.hi);
  return {s.value, s.error + (x.lo + y.lo)};
}
[[nodiscard, gnu::always_inline]] inline DoubleDouble4 folded(const Six<DoubleDouble>& x) {
  return added({lower(x.hi), lower(x.lo)}, {upper(x.hi), upper(x.lo)});
}
template <int... lane> [[nodiscard, gnu::always_inline]] inline DoubleDouble4 picked(const DoubleDouble4& a, const DoubleDouble4& b) {
  return {picked<lane...>(a.hi, b.hi), picked<lane...>(a.lo, b.lo)};
}
inline void sums(const Six<DoubleDouble> (&p)[4], DoubleDouble (&sum)[4], Index) { sums_in_lanes(p, sum); }

template <class T> struct WideOf { using type = T; };
template <> struct WideOf<double> { using type = DoubleDouble; };
template <> struct WideOf<float> { using type = double; };
template <> struct WideOf<Lanes8> { using type = TwoFold<Lanes8>; };
template <> struct WideOf<Quad> { using type = TwoFold<Quad>; };
template <class T> using Wide = typename WideOf<T>::type;

/// x rounded to T.
template <class T> [[nodiscard]] inline T narrow(const Wide<T>& x) {
  if constexpr (std::is_same_v<Wide<T>, T>) return x;
  else return static_cast<T>(x);
}

}  // namespace delassus
