// Which of many balls come near each other: the broad phase of the search for contacts.
//
// What   all pairs (i, j), i < j, with ‖x_i − x_j‖ ≤ r_i + r_j + the larger of their margins, that are of different objects and do not both
//        rest; ascending. A pair does not depend on what else there is.
// How    cells of side 2^k, for each k with balls of 2^{k−1} < 2 (r + margin) ≤ 2^k in them: two balls of levels k ≤ l that are near lie in cells of side
//        2^l next to each other. Balls that are not finite are held against all. Up to few_balls
//        balls are held against each other: two dozen cells around a ball cost more than a dozen distances.
// Cost   O(N · levels · log N + pairs of neighbouring cells), wherever the balls are: in a row, a wall, a tower, a heap; of one object alone, O(N).
#pragma once

#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

struct Ball {
  Vector3<double> centre;
  double radius, margin;  ///< [m]
  Index object;
  bool rests;
};

constexpr std::size_t few_balls = 32;

/// `tested` grows by the pairs whose distance was looked at.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> near_pairs(const std::vector<Ball>& balls, std::int64_t* tested = nullptr);

}  // namespace delassus
