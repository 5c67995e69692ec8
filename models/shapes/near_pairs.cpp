#include "models/shapes/near_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace delassus {
namespace {

using Cell = std::array<std::int64_t, 3>;  // z, y, x: those along x are neighbours in order

/// The balls of one size, by cell.
struct Level {
  double side;
  std::vector<std::pair<Cell, std::size_t>> balls;

  Cell cell_of(const Vector3<double>& x) const {
    const auto at = [&](double v) { return static_cast<std::int64_t>(std::clamp(std::floor(v / side), -0x1p60, 0x1p60)); };  // monotone: neighbours stay so
    return {at(x[2]), at(x[1]), at(x[0])};
  }
};

/// k of the smallest 2^k ≥ 2 (r + margin), a little more for the rounding of distances.
int level_of(const Ball& b) {
  int k = 0;
  std::frexp(2.0000001 * (b.radius + b.margin), &k);
  return k;
}

bool near(const Ball& a, const Ball& b) {
  if (a.object == b.object || (a.rests && b.rests)) return false;
  const double margin = std::max(a.margin, b.margin);
  const bool a_left = a.centre[0] - a.radius < b.centre[0] - b.radius;
  const Ball &left = a_left ? a : b, &right = a_left ? b : a;
  if (right.centre[0] - right.radius > left.centre[0] + left.radius + margin) return false;
  return (a.centre - b.centre).norm() <= a.radius + b.radius + margin;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> near_pairs(const std::vector<Ball>& balls, std::int64_t* tested) {
  if (std::all_of(balls.begin(), balls.end(), [&](const Ball& b) { return b.object == balls[0].object; })) return {};
  std::vector<std::pair<std::size_t, std::size_t>> out;
  const auto look = [&](std::size_t i, std::size_t j) {
    if (tested != nullptr) ++*tested;
    if (near(balls[std::min(i, j)], balls[std::max(i, j)])) out.emplace_back(std::min(i, j), std::max(i, j));
  };
  if (balls.size() <= few_balls) {
    for (std::size_t i = 0; i < balls.size(); ++i)
      for (std::size_t j = i + 1; j < balls.size(); ++j) look(i, j);
    return out;
  }
  std::map<int, Level> levels;
  std::vector<std::size_t> unbounded;
  const auto bounded = [&](std::size_t i) { return balls[i].centre.allFinite() && std::isfinite(2.0000001 * (balls[i].radius + balls[i].margin)); };
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (!bounded(i)) {
      unbounded.push_back(i);
      continue;
    }
    const int k = level_of(balls[i]);
    Level& level = levels[k];
    level.side = std::ldexp(1.0, k);
    level.balls.emplace_back(level.cell_of(balls[i].centre), i);
  }
  for (auto& [k, level] : levels) std::sort(level.balls.begin(), level.balls.end());

  for (const auto& [own, mine] : levels)
    for (const auto& [cell, i] : mine.balls)
      for (auto level = levels.lower_bound(own); level != levels.end(); ++level) {
        const Cell c = level->second.cell_of(balls[i].centre);
        const auto& all = level->second.balls;
        for (std::int64_t dz = -1; dz <= 1; ++dz)
          for (std::int64_t dy = -1; dy <= 1; ++dy) {
            const Cell first{c[0] + dz, c[1] + dy, c[2] - 1}, last{c[0] + dz, c[1] + dy, c[2] + 1};
            for (auto it = std::lower_bound(all.begin(), all.end(), std::pair(first, std::size_t{0})); it != all.end() && it->first <= last; ++it)
              if (level->first != own || it->second > i) look(i, it->second);
          }
      }
  for (const std::size_t i : unbounded)
    for (std::size_t j = 0; j < balls.size(); ++j)
      if (bounded(j) || j > i) look(i, j);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace delassus
