#include "bench/scaling/dissection.h"

#include <algorithm>

namespace delassus::bench {

namespace {

/// Columns [x, x + w) of rows [y, y + h).
void dissect(Index x, Index w, Index y, Index h, Index side, std::vector<Index>& order) {
  const auto take = [&](Index from_x, Index width, Index from_y, Index height) {
    for (Index j = from_y; j < from_y + height; ++j)
      for (Index i = from_x; i < from_x + width; ++i) order.push_back(j * side + i);
  };
  if (w * h <= 4) return take(x, w, y, h);
  const Index half = (std::max(w, h)) / 2;
  if (w >= h) {
    dissect(x, half, y, h, side, order), dissect(x + half + 1, w - half - 1, y, h, side, order);
    take(x + half, 1, y, h);
  } else {
    dissect(x, w, y, half, side, order), dissect(x, w, y + half + 1, h - half - 1, side, order);
    take(x, w, y + half, 1);
  }
}

}  // namespace

std::vector<Index> dissection(Index side) {
  std::vector<Index> order;
  dissect(0, side, 0, side, side, order);
  return order;
}

double lattice_front_pairs(Index side, const std::vector<Index>& order) {
  const auto bodies = static_cast<std::size_t>(side * side);
  std::vector<std::size_t> at(bodies);
  for (std::size_t k = 0; k < bodies; ++k) at[static_cast<std::size_t>(order[k])] = k;
  std::vector<std::vector<std::size_t>> later(bodies);  // by step: what is eliminated later and coupled, sorted
  const auto couple = [&](Index a, Index b) {
    const auto [first, second] = std::minmax(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)]);
    later[first].push_back(second);
  };
  for (Index k = 0; k < side * side; ++k) {
    if (k % side + 1 < side) couple(k, k + 1);
    if (k + side < side * side) couple(k, k + side);
  }
  double sum = 0;
  for (std::vector<std::size_t>& q : later) {
    std::sort(q.begin(), q.end());
    q.erase(std::unique(q.begin(), q.end()), q.end());
    const double all = static_cast<double>(q.size()) + 1;
    sum += 6 * all * all;
    // the others become coupled to each other, which the first of them passes on
    if (q.size() > 1) later[q.front()].insert(later[q.front()].end(), q.begin() + 1, q.end());
  }
  return sum;
}

}  // namespace delassus::bench
