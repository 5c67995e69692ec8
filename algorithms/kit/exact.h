// Exact scalars: rational numbers (GMP), and the integers modulo a prime.
#pragma once

#include <gmpxx.h>

#include <Eigen/Core>

#include "algorithms/kit/quad.h"

namespace delassus {

/// Exact rational number. Division by zero yields zero with a lost pivot reported before it (see `usable_pivot`).
struct Rational {
  mpq_class v;
  Rational() = default;
  Rational(double x) : v(x) {}
  Rational(int x) : v(x) {}
  Rational(long x) : v(x) {}
  explicit Rational(mpq_class x) : v(std::move(x)) {}
  explicit Rational(const Quad& x) {
    const double hi = static_cast<double>(x), mid = static_cast<double>(x - Quad(hi));
    v = mpq_class(hi) + mpq_class(mid) + mpq_class(static_cast<double>(x - Quad(hi) - Quad(mid)));
  }
  explicit operator double() const { return v.get_d(); }
  explicit operator Quad() const {
    const double hi = v.get_d(), mid = mpq_class(v - hi).get_d();
    return Quad(hi) + Quad(mid) + Quad(mpq_class(v - hi - mid).get_d());
  }
  Rational& operator+=(const Rational& o) { v += o.v; return *this; }
  Rational& operator-=(const Rational& o) { v -= o.v; return *this; }
  Rational& operator*=(const Rational& o) { v *= o.v; return *this; }
  Rational& operator/=(const Rational& o) { v /= o.v; return *this; }
  friend Rational operator+(Rational a, const Rational& b) { return std::move(a += b); }
  friend Rational operator-(Rational a, const Rational& b) { return std::move(a -= b); }
  friend Rational operator*(Rational a, const Rational& b) { return std::move(a *= b); }
  friend Rational operator/(Rational a, const Rational& b) { return std::move(a /= b); }
  friend Rational operator-(const Rational& a) { return Rational(mpq_class(-a.v)); }
  friend bool operator==(const Rational& a, const Rational& b) { return a.v == b.v; }
  friend bool operator<(const Rational& a, const Rational& b) { return a.v < b.v; }
  friend bool operator>(const Rational& a, const Rational& b) { return a.v > b.v; }
  friend bool operator<=(const Rational& a, const Rational& b) { return a.v <= b.v; }
  friend bool operator>=(const Rational& a, const Rational& b) { return a.v >= b.v; }
};
inline Rational abs(const Rational& x) { return Rational(mpq_class(::abs(x.v))); }
inline bool isfinite(const Rational& x) { return sgn(x.v.get_den()) != 0; }

/// The integers modulo p = 2⁶¹ − 1. Doubles are dyadic rationals and 2 is invertible, so the map from doubles is a ring
/// homomorphism: an identity between rational functions that holds for the doubles holds here. A wrong identity of degree
/// d survives a random evaluation with probability below d/p (Schwartz–Zippel). Division by zero gives zero; a recursion
/// sees it before as a pivot that is not usable.
struct PrimeField {
  static constexpr std::uint64_t p = (std::uint64_t{1} << 61) - 1;
  std::uint64_t v = 0;
  PrimeField() = default;
  PrimeField(int x) : v(x >= 0 ? static_cast<std::uint64_t>(x) : p - static_cast<std::uint64_t>(-x)) {}
  PrimeField(double x) {  // x = m 2^e, and 2^61 = 1
    int e = 0;
    const double m = std::frexp(x, &e);
    const auto integer = static_cast<std::int64_t>(std::ldexp(m, 53));
    v = (integer < 0 ? p - static_cast<std::uint64_t>(-integer) % p : static_cast<std::uint64_t>(integer)) % p;
    const int shift = (((e - 53) % 61) + 61) % 61;
    *this *= from(std::uint64_t{1} << shift);
  }
  static PrimeField from(std::uint64_t reduced) { PrimeField x; x.v = reduced; return x; }
  explicit operator double() const { return static_cast<double>(v); }  ///< for printing only
  PrimeField& operator+=(const PrimeField& o) { v += o.v; if (v >= p) v -= p; return *this; }
  PrimeField& operator-=(const PrimeField& o) { v += p - o.v; if (v >= p) v -= p; return *this; }
  PrimeField& operator*=(const PrimeField& o) {
    const auto x = static_cast<unsigned __int128>(v) * o.v;
    v = static_cast<std::uint64_t>(x & p) + static_cast<std::uint64_t>(x >> 61);
    if (v >= p) v -= p;
    return *this;
  }
  [[nodiscard]] PrimeField inverse() const {  // v^(p−2)
    PrimeField result = from(1), base = *this;
    for (std::uint64_t k = p - 2; k != 0; k >>= 1, base *= base)
      if (k & 1) result *= base;
    return result;
  }
  PrimeField& operator/=(const PrimeField& o) { return *this *= o.inverse(); }
  friend PrimeField operator+(PrimeField a, const PrimeField& b) { return a += b; }
  friend PrimeField operator-(PrimeField a, const PrimeField& b) { return a -= b; }
  friend PrimeField operator*(PrimeField a, const PrimeField& b) { return a *= b; }
  friend PrimeField operator/(PrimeField a, const PrimeField& b) { return a /= b; }
  friend PrimeField operator-(const PrimeField& a) { return from(a.v == 0 ? 0 : p - a.v); }
  friend bool operator==(const PrimeField& a, const PrimeField& b) { return a.v == b.v; }
};
inline bool isfinite(const PrimeField& x) { return x.v != PrimeField::p; }

template <> struct ScalarTraits<Rational> {
  static constexpr bool exact = true, ordered = true;
  static bool usable_pivot(const Rational& d) { return d > Rational(0); }
  static Rational nan() { return {}; }
  static Rational infinity() {  // 1/0, which GMP's arithmetic refuses
    Rational x(1);
    x.v.get_den() = 0;
    return x;
  }
  static bool is_infinite(const Rational& x) { return !isfinite(x); }
};
template <> struct ScalarTraits<PrimeField> {
  static constexpr bool exact = true, ordered = false;
  static bool usable_pivot(const PrimeField& d) { return d.v != 0; }
  static PrimeField nan() { return {}; }
  static PrimeField infinity() { return PrimeField::from(PrimeField::p); }
  static bool is_infinite(const PrimeField& x) { return !isfinite(x); }
};

}  // namespace delassus

namespace Eigen {
template <> struct NumTraits<delassus::Rational> : GenericNumTraits<delassus::Rational> {
  using Real = delassus::Rational;
  using NonInteger = delassus::Rational;
  using Nested = delassus::Rational;
  using Literal = double;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1, ReadCost = 6, AddCost = 150, MulCost = 100 };
  static Real epsilon() { return {0}; }
  static Real dummy_precision() { return {0}; }
  static int digits10() { return 0; }
};
template <> struct NumTraits<delassus::PrimeField> : GenericNumTraits<delassus::PrimeField> {
  using Real = delassus::PrimeField;
  using NonInteger = delassus::PrimeField;
  using Nested = delassus::PrimeField;
  using Literal = double;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0, ReadCost = 1, AddCost = 2, MulCost = 6 };
  static Real epsilon() { return {0}; }
  static Real dummy_precision() { return {0}; }
  static int digits10() { return 0; }
};
}  // namespace Eigen
