// Order of growth by counts: f(n) = c nᵖ + constants has p = log2((f(4n) − f(2n)) / (f(2n) − f(n))) exactly, at small n too.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace delassus::bench {

/// Orders of f(n), f(2n), f(4n), …: two fewer than counts. NaN where nothing grows, or a count is missing (negative).
[[nodiscard]] inline std::vector<double> orders(const std::vector<std::int64_t>& f) {
  std::vector<double> p;
  for (std::size_t i = 0; i + 2 < f.size(); ++i) {
    const double upper = static_cast<double>(f[i + 2] - f[i + 1]), lower = static_cast<double>(f[i + 1] - f[i]);
    p.push_back(f[i] < 0 || f[i + 1] < 0 || f[i + 2] < 0 ? std::nan("") : std::log2(upper / lower));
  }
  return p;
}

[[nodiscard]] inline bool is_linear(double order) { return std::fabs(order - 1) <= 0.01; }

/// Every order is 1.00 ± 0.01, and there is one.
[[nodiscard]] inline bool grows_linearly(const std::vector<std::int64_t>& f) {
  const std::vector<double> p = orders(f);
  bool linear = !p.empty();
  for (const double order : p) linear = linear && is_linear(order);
  return linear;
}

/// Not counted at all, or counted and none.
[[nodiscard]] inline bool no_work(const std::vector<std::int64_t>& f) {
  bool none = !f.empty();
  for (const std::int64_t n : f) none = none && n == 0;
  return none;
}

}  // namespace delassus::bench
