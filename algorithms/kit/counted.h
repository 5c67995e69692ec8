// A double that counts its operations, per thread.
#pragma once

#include <Eigen/Core>

#include "algorithms/kit/scalars.h"

namespace delassus {

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

}  // namespace delassus

namespace Eigen {
template <> struct NumTraits<delassus::Counted> : GenericNumTraits<double> {
  using Real = delassus::Counted;
  using NonInteger = delassus::Counted;
  using Nested = delassus::Counted;
  using Literal = double;
  static Real epsilon() { return {0x1p-52}; }
  static Real dummy_precision() { return {0x1p-40}; }
};
}  // namespace Eigen
