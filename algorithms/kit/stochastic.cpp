#include "algorithms/kit/stochastic.h"

#include <algorithm>
#include <utility>

namespace delassus {
namespace {

constexpr double student = 4.302652729911275;  // τ: 0.975 quantile, two degrees of freedom

struct Stream {
  std::uint64_t state = 1;
  bool on = true;

  /// Uniform in [0, 1) (splitmix64).
  double uniform() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
};
thread_local Stream stream;

/// r, or its neighbour towards r + error, so that the expectation is r + error.
double rounded(double r, double error) {
  if (error == 0 || !stream.on || !std::isfinite(r)) return r;
  const double neighbour = std::nextafter(r, error > 0 ? HUGE_VAL : -HUGE_VAL);
  return stream.uniform() < std::fabs(error) / std::fabs(neighbour - r) ? neighbour : r;
}

double sum(double a, double b) {
  const double r = a + b, b_part = r - a;
  return rounded(r, (a - (r - b_part)) + (b - b_part));
}
double product(double a, double b) {
  const double r = a * b;
  return rounded(r, std::fma(a, b, -r));
}
double quotient(double a, double b) {
  const double r = a / b;
  return rounded(r, std::fma(-r, b, a) / b);
}
double root(double a) {
  const double r = std::sqrt(a);
  return rounded(r, std::fma(-r, r, a) / (2 * r));
}

}  // namespace

void seed_rounding(std::uint64_t seed) { stream.state = seed; }

bool random_rounding(bool on) { return std::exchange(stream.on, on); }

double common_digits(double value, double half_width) {
  if (half_width == 0) return most_digits;
  const double d = std::log10(std::fabs(value) / half_width);
  return d > 0 ? std::min(d, most_digits) : 0;  // NaN: none
}

double Stochastic::half_width() const {
  const double m = mean();
  double squares = 0;
  for (const double x : v) squares += (x - m) * (x - m);
  return student * std::sqrt(squares / 2 / 3);
}

Stochastic& Stochastic::operator+=(const Stochastic& o) {
  for (std::size_t k = 0; k < 3; ++k) v[k] = sum(v[k], o.v[k]);
  return *this;
}
Stochastic& Stochastic::operator*=(const Stochastic& o) {
  for (std::size_t k = 0; k < 3; ++k) v[k] = product(v[k], o.v[k]);
  return *this;
}
Stochastic& Stochastic::operator/=(const Stochastic& o) {
  for (std::size_t k = 0; k < 3; ++k) v[k] = quotient(v[k], o.v[k]);
  return *this;
}
Stochastic sqrt(const Stochastic& x) {
  Stochastic y;
  for (std::size_t k = 0; k < 3; ++k) y.v[k] = x.v[k] == 0 ? x.v[k] : root(x.v[k]);
  return y;
}

}  // namespace delassus
