// Intervals of doubles, rounded outwards: what is computed contains the truth. With derivatives by up to four variables (Slope).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace delassus::reference {

struct Interval {
  double low = 0, high = 0;
  Interval() = default;
  Interval(double x) : low(x), high(x) {}
  Interval(double l, double h) : low(l), high(h) {}
  [[nodiscard]] double middle() const { return low + (high - low) / 2; }
  [[nodiscard]] double width() const { return high - low; }
  [[nodiscard]] bool has_zero() const { return low <= 0 && high >= 0; }
};
[[nodiscard]] inline Interval outwards(double l, double h) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {std::nextafter(l, -infinity), std::nextafter(h, infinity)};
}
[[nodiscard]] inline Interval operator+(const Interval& a, const Interval& b) { return outwards(a.low + b.low, a.high + b.high); }
[[nodiscard]] inline Interval operator-(const Interval& a) { return {-a.high, -a.low}; }
[[nodiscard]] inline Interval operator-(const Interval& a, const Interval& b) { return outwards(a.low - b.high, a.high - b.low); }
[[nodiscard]] inline Interval operator*(const Interval& a, const Interval& b) {
  const double p[4] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
  return outwards(std::min({p[0], p[1], p[2], p[3]}), std::max({p[0], p[1], p[2], p[3]}));
}

/// A value and its derivatives.
struct Slope {
  Interval value;
  std::array<Interval, 4> by{};
  Slope() = default;
  Slope(double x) : value(x) {}
  Slope(const Interval& x) : value(x) {}
};
[[nodiscard]] inline Slope operator+(const Slope& a, const Slope& b) {
  Slope c(a.value + b.value);
  for (std::size_t k = 0; k < 4; ++k) c.by[k] = a.by[k] + b.by[k];
  return c;
}
[[nodiscard]] inline Slope operator-(const Slope& a, const Slope& b) {
  Slope c(a.value - b.value);
  for (std::size_t k = 0; k < 4; ++k) c.by[k] = a.by[k] - b.by[k];
  return c;
}
[[nodiscard]] inline Slope operator*(const Slope& a, const Slope& b) {
  Slope c(a.value * b.value);
  for (std::size_t k = 0; k < 4; ++k) c.by[k] = a.by[k] * b.value + a.value * b.by[k];
  return c;
}

}  // namespace delassus::reference
