// A double that knows its digits: three samples of every number, each rounded at random on its own.
//
// What     After + − · / √ a sample takes one of the two doubles around the exact result, the nearer one more likely:
//          neighbour n of the rounded r with probability |e| / |n − r|, e the exact error of r by an error-free
//          transformation. What an operation loses thus shows as a difference of the samples.
// Why not  one of the two with probability 1/2 each (CESTAC as first published): its expectation is off by up to half a
//          unit in the last place whenever e has a preferred value (difference of two sums of 1/k, k ≤ 200: 30 % of the
//          intervals miss zero, instead of 5 %). Here the expectation of every operation is its exact
//          result, as Student's test supposes, exact operations stay exact, and the variance is never below the square
//          of the error of rounding to nearest: x(1 − x) ≥ min(x, 1 − x)² units².
// Digits   log10(√3 |mean| / (τ s)), s the deviation of the samples, τ = 4.303 (95 %, two degrees of freedom): with 95 %
//          probability the exact result lies within half_width() of the mean. Roundings are taken to first order, and to
//          be many: of one rounding alone, three samples may well agree.
// Cost     about 40 times double. Streams are per thread and repeat with their seed.
// Source   J. Vignes, A stochastic arithmetic for reliable scientific computation, Math. Comput. Simul. 35 (1993) 233–261
//          (samples, Student's formula); M. Croci et al., Stochastic rounding, R. Soc. Open Sci. 9 (2022) (probabilities).
#pragma once

#include <array>

#include <Eigen/Core>

#include "algorithms/kit/scalars.h"

namespace delassus {

/// Starts this thread's random stream anew.
void seed_rounding(std::uint64_t seed);
/// Random rounding of this thread on, or off: to nearest, as double. Returns what it was. On at first.
bool random_rounding(bool on);

inline constexpr double most_digits = 15.954589770191003;  ///< 53 log10 2: what a double holds

/// Decimal digits of a number known up to ±half_width, between 0 and most_digits.
[[nodiscard]] double common_digits(double value, double half_width);

struct Stochastic {
  std::array<double, 3> v{};
  Stochastic() = default;
  Stochastic(double x) : v{x, x, x} {}
  Stochastic(int x) : Stochastic(static_cast<double>(x)) {}
  explicit operator double() const { return mean(); }

  [[nodiscard]] double mean() const { return v[0] + ((v[1] - v[0]) + (v[2] - v[0])) / 3; }
  /// Half of Student's interval around the mean, 95 %.
  [[nodiscard]] double half_width() const;
  /// Significant decimal digits the samples have in common; most_digits when they are equal.
  [[nodiscard]] double digits() const { return common_digits(mean(), half_width()); }

  Stochastic& operator+=(const Stochastic& o);
  Stochastic& operator-=(const Stochastic& o) { return *this += -o; }
  Stochastic& operator*=(const Stochastic& o);
  Stochastic& operator/=(const Stochastic& o);
  friend Stochastic operator+(Stochastic a, const Stochastic& b) { return a += b; }
  friend Stochastic operator-(Stochastic a, const Stochastic& b) { return a -= b; }
  friend Stochastic operator*(Stochastic a, const Stochastic& b) { return a *= b; }
  friend Stochastic operator/(Stochastic a, const Stochastic& b) { return a /= b; }
  friend Stochastic operator-(Stochastic a) {
    for (double& x : a.v) x = -x;
    return a;
  }
  // The three samples take the same branch: the mean decides.
  friend bool operator==(const Stochastic& a, const Stochastic& b) { return a.mean() == b.mean(); }
  friend bool operator<(const Stochastic& a, const Stochastic& b) { return a.mean() < b.mean(); }
  friend bool operator>(const Stochastic& a, const Stochastic& b) { return a.mean() > b.mean(); }
  friend bool operator<=(const Stochastic& a, const Stochastic& b) { return a.mean() <= b.mean(); }
  friend bool operator>=(const Stochastic& a, const Stochastic& b) { return a.mean() >= b.mean(); }
};
[[nodiscard]] inline Stochastic abs(const Stochastic& x) { return x.mean() < 0 ? -x : x; }
[[nodiscard]] Stochastic sqrt(const Stochastic& x);
[[nodiscard]] inline bool isfinite(const Stochastic& x) { return std::isfinite(x.v[0] + x.v[1] + x.v[2]); }

}  // namespace delassus

namespace Eigen {
template <> struct NumTraits<delassus::Stochastic> : GenericNumTraits<double> {
  using Real = delassus::Stochastic;
  using NonInteger = delassus::Stochastic;
  using Nested = delassus::Stochastic;
  using Literal = double;
  enum { RequireInitialization = 1, ReadCost = 3, AddCost = 60, MulCost = 60 };
  static Real epsilon() { return {0x1p-52}; }
  static Real dummy_precision() { return {0x1p-40}; }
};
}  // namespace Eigen
