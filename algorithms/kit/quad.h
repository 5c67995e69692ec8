// IEEE binary128 as a scalar: 113 bits by libquadmath.
#pragma once

#include <Eigen/Core>

#include "algorithms/kit/scalars.h"

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

template <> inline constexpr double unit_roundoff<Quad> = 0x1p-113;

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
}  // namespace Eigen
