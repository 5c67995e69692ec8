// The scalars every recursion is instantiated for.
//   double    the product              float    half the memory
//   Quad      __float128, 113 bits: tells a bug from rounding
//   Counted   double that counts its operations (per thread)
//   Rational    exact, GMP: an identity holds or it does not
//   PrimeField  exact modulo 2⁶¹ − 1, constant size: identities at thousands of bodies (not ordered: no cg)
#pragma once

#include <gmpxx.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <Eigen/Core>

// libquadmath's functions, declared here because its header is found by g++ only.
extern "C" {
__float128 sqrtq(__float128) noexcept;
__float128 sinq(__float128) noexcept;
__float128 cosq(__float128) noexcept;
int finiteq(__float128) noexcept;
}

namespace delassus {

/// IEEE binary128.
struct Quad {
  __float128 v = 0;
  Quad() = default;
  Quad(double x) : v(x) {}
  Quad(int x) : v(x) {}
  Quad(long x) : v(x) {}
  explicit Quad(__float128 x) : v(x) {}
  explicit operator double() const { return static_cast<double>(v); }
  Quad& operator+=(const Quad& o) { v += o.v; return *this; }
  Quad& operator-=(const Quad& o) { v -= o.v; return *this; }
  Quad& operator*=(const Quad& o) { v *= o.v; return *this; }
  Quad& operator/=(const Quad& o) { v /= o.v; return *this; }
  friend Quad operator+(Quad a, const Quad& b) { return a += b; }
  friend Quad operator-(Quad a, const Quad& b) { return a -= b; }
  friend Quad operator*(Quad a, const Quad& b) { return a *= b; }
  friend Quad operator/(Quad a, const Quad& b) { return a /= b; }
  friend Quad operator-(const Quad& a) { return Quad(-a.v); }
  friend bool operator==(const Quad& a, const Quad& b) { return a.v == b.v; }
  friend bool operator<(const Quad& a, const Quad& b) { return a.v < b.v; }
  friend bool operator>(const Quad& a, const Quad& b) { return a.v > b.v; }
  friend bool operator<=(const Quad& a, const Quad& b) { return a.v <= b.v; }
  friend bool operator>=(const Quad& a, const Quad& b) { return a.v >= b.v; }
};
inline Quad abs(const Quad& x) { return x.v < 0 ? -x : x; }
inline Quad sqrt(const Quad& x) { return Quad(sqrtq(x.v)); }
inline Quad sin(const Quad& x) { return Quad(sinq(x.v)); }
inline Quad cos(const Quad& x) { return Quad(cosq(x.v)); }
inline bool isfinite(const Quad& x) { return finiteq(x.v) != 0; }

/// Operations counted so far by this thread.
struct OperationCount {
  std::int64_t additions = 0, multiplications = 0, divisions = 0, square_roots = 0;
  [[nodiscard]] std::int64_t total() const { return additions + multiplications + divisions + square_roots; }
};
inline thread_local OperationCount operation_count;

/// A double that counts.
struct Counted {
  double v = 0;
  Counted() = default;
  Counted(double x) : v(x) {}
  Counted(int x) : v(x) {}
  explicit operator double() const { return v; }
  Counted& operator+=(const Counted& o) { ++operation_count.additions; v += o.v; return *this; }
  Counted& operator-=(const Counted& o) { ++operation_count.additions; v -= o.v; return *this; }
  Counted& operator*=(const Counted& o) { ++operation_count.multiplications; v *= o.v; return *this; }
  Counted& operator/=(const Counted& o) { ++operation_count.divisions; v /= o.v; return *this; }
  friend Counted operator+(Counted a, const Counted& b) { return a += b; }
  friend Counted operator-(Counted a, const Counted& b) { return a -= b; }
  friend Counted operator*(Counted a, const Counted& b) { return a *= b; }
  friend Counted operator/(Counted a, const Counted& b) { return a /= b; }
  friend Counted operator-(const Counted& a) { return Counted(-a.v); }
  friend bool operator==(const Counted& a, const Counted& b) { return a.v == b.v; }
  friend bool operator<(const Counted& a, const Counted& b) { return a.v < b.v; }
  friend bool operator>(const Counted& a, const Counted& b) { return a.v > b.v; }
  friend bool operator<=(const Counted& a, const Counted& b) { return a.v <= b.v; }
  friend bool operator>=(const Counted& a, const Counted& b) { return a.v >= b.v; }
};
inline Counted abs(const Counted& x) { return std::fabs(x.v); }
inline Counted sqrt(const Counted& x) { ++operation_count.square_roots; return std::sqrt(x.v); }
inline Counted sin(const Counted& x) { return std::sin(x.v); }
inline Counted cos(const Counted& x) { return std::cos(x.v); }
inline bool isfinite(const Counted& x) { return std::isfinite(x.v); }

/// Exact rational number. Division by zero yields zero with a lost pivot reported before it (see `usable_pivot`).
struct Rational {
  mpq_class v;
  Rational() = default;
  Rational(double x) : v(x) {}
  Rational(int x) : v(x) {}
  Rational(long x) : v(x) {}
  explicit Rational(mpq_class x) : v(std::move(x)) {}
  explicit operator double() const { return v.get_d(); }
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
inline bool isfinite(const Rational&) { return true; }

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
inline bool isfinite(const PrimeField&) { return true; }

/// What a recursion may ask of its scalar beyond + − · /.
template <class T> struct ScalarTraits {
  static constexpr bool exact = false;
  static bool usable_pivot(const T& d) { using std::isfinite; return d > T(0) && isfinite(d); }
  static T nan() { return T(std::numeric_limits<double>::quiet_NaN()); }  ///< marks a result that must not be used
};
template <> struct ScalarTraits<Rational> {
  static constexpr bool exact = true;
  static bool usable_pivot(const Rational& d) { return d > Rational(0); }
  static Rational nan() { return {}; }
};
template <> struct ScalarTraits<PrimeField> {
  static constexpr bool exact = true;
  static bool usable_pivot(const PrimeField& d) { return d.v != 0; }
  static PrimeField nan() { return {}; }
};

/// Unit roundoff of a scalar; 0 where it is exact.
template <class T> inline constexpr double unit_roundoff = ScalarTraits<T>::exact ? 0.0 : 0x1p-53;
template <> inline constexpr double unit_roundoff<float> = 0x1p-24;
template <> inline constexpr double unit_roundoff<Quad> = 0x1p-113;

/// Conversion between any two scalars (exact whenever the target holds every value of the source).
template <class To, class From> [[nodiscard]] To scalar_cast(const From& x) {
  if constexpr (std::is_same_v<To, From>) return x;
  else if constexpr (std::is_same_v<From, double>) return static_cast<To>(x);
  else if constexpr (std::is_same_v<From, Quad> && std::is_same_v<To, Rational>) {
    const double hi = static_cast<double>(x), mid = static_cast<double>(x - Quad(hi));
    return Rational(hi) + Rational(mid) + Rational(static_cast<double>(x - Quad(hi) - Quad(mid)));
  } else if constexpr (std::is_same_v<From, Rational> && std::is_same_v<To, Quad>) {
    const double hi = x.v.get_d(), mid = mpq_class(x.v - hi).get_d();
    return Quad(hi) + Quad(mid) + Quad(mpq_class(x.v - hi - mid).get_d());
  } else return static_cast<To>(static_cast<double>(x));
}

/// Every scalar the library is instantiated for; used only for explicit instantiations.
#define DELASSUS_FOR_EACH_ORDERED_SCALAR(X) \
  X(double) X(float) X(::delassus::Quad) X(::delassus::Counted) X(::delassus::Rational)
#define DELASSUS_FOR_EACH_SCALAR(X) DELASSUS_FOR_EACH_ORDERED_SCALAR(X) X(::delassus::PrimeField)

}  // namespace delassus

namespace Eigen {
template <> struct NumTraits<delassus::Quad> : GenericNumTraits<delassus::Quad> {
  using Real = delassus::Quad;
  using NonInteger = delassus::Quad;
  using Nested = delassus::Quad;
  using Literal = double;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0, ReadCost = 2, AddCost = 30, MulCost = 40 };
  static Real epsilon() { return Real(0x1p-112); }
  static Real dummy_precision() { return Real(0x1p-100); }
  static int digits10() { return 33; }
};
template <> struct NumTraits<delassus::Counted> : GenericNumTraits<double> {
  using Real = delassus::Counted;
  using NonInteger = delassus::Counted;
  using Nested = delassus::Counted;
  using Literal = double;
  static Real epsilon() { return {0x1p-52}; }
  static Real dummy_precision() { return {0x1p-40}; }
};
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
