#include "models/shapes/farthest.h"

#include <algorithm>
#include <cmath>

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// The first candidate that no later one beats by a clear lead; of those that reach as far, the deepest.
std::size_t best_of(const std::vector<double>& gap, double lead, const std::vector<double>& reach) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < gap.size(); ++i) {
    const double d = reach[i] - reach[best];
    if (d > lead || (d >= -lead && gap[i] < gap[best] - lead)) best = i;
  }
  return best;
}

}  // namespace

std::vector<std::size_t> farthest(const std::vector<Vector3<double>>& points, const std::vector<double>& gap) {
  double extent = 0;
  for (const V3& p : points) extent = std::max(extent, (p - points[0]).norm());
  const double lead = 1e-6 * extent;
  std::vector<std::size_t> kept;
  auto at = [&](std::size_t k) -> const V3& { return points[kept[k]]; };
  auto take = [&](auto&& reach_of) {
    std::vector<double> reach;
    for (const V3& p : points) reach.push_back(reach_of(p));
    const std::size_t i = best_of(gap, lead, reach);
    if (reach[i] > lead || kept.empty()) kept.push_back(i);
  };
  auto left_of = [&](const V3& a, const V3& b, const V3& x) { return V3(a[1] - b[1], b[0] - a[0], 0).normalized().dot(x - a); };
  take([](const V3&) { return 0.0; });
  take([&](const V3& x) { return (x - at(0)).norm(); });
  if (kept.size() == 2) take([&](const V3& x) { return std::abs(left_of(at(0), at(1), x)); });
  if (kept.size() == 2) {
    take([&](const V3& x) { return (at(0) - at(1)).normalized().dot(x - at(0)); });
  } else if (kept.size() == 3) {
    const double side = left_of(at(0), at(1), at(2)) > 0 ? 1 : -1;
    take([&](const V3& x) { return -std::min({side * left_of(at(0), at(1), x), side * left_of(at(1), at(2), x), side * left_of(at(2), at(0), x)}); });
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace delassus
