// What a recursion may ask of its scalar beyond + − · /. Scalars it is instantiated for (instantiate.h):
//   double      the product               float    half the memory
//   Quad        quad.h: 113 bits, tells a bug from rounding
//   Counted     counted.h: a double that counts its operations (per thread)
//   Rational    exact.h: GMP, an identity holds or it does not
//   PrimeField  exact.h: modulo 2⁶¹ − 1, constant size: identities at thousands of bodies (not ordered: no cg)
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace delassus {

struct Quad;
struct Counted;
struct Rational;
struct PrimeField;

template <class T> struct ScalarTraits {
  static constexpr bool exact = false, ordered = true;
  static bool usable_pivot(const T& d) { using std::isfinite; return d > T(0) && isfinite(d); }
  static T nan() { return T(std::numeric_limits<double>::quiet_NaN()); }  ///< marks a result that must not be used
  /// A mark that no arithmetic ever meets: R⁻¹ of a row that is switched off.
  static T infinity() { return T(std::numeric_limits<double>::infinity()); }
  static bool is_infinite(const T& x) { using std::isfinite; return x > T(0) && !isfinite(x); }
};

template <class T> [[nodiscard]] bool is_finite(const T& x) {
  using std::isfinite;
  return isfinite(x);
}

/// Unit roundoff of a scalar; 0 where it is exact.
template <class T> inline constexpr double unit_roundoff = ScalarTraits<T>::exact ? 0.0 : 0x1p-53;
template <> inline constexpr double unit_roundoff<float> = 0x1p-24;

/// Conversion between any two scalars (exact whenever the target holds every value of the source).
template <class To, class From> [[nodiscard]] To scalar_cast(const From& x) {
  if constexpr (std::is_same_v<To, From>) return x;
  else if constexpr (std::is_same_v<From, double> || std::is_constructible_v<To, const From&>) return static_cast<To>(x);
  else return static_cast<To>(static_cast<double>(x));
}

}  // namespace delassus
