// Which contact points of a plane are kept.
#pragma once

#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

/// At most four of the points `at` (x and y in the plane, one z for all; at least one point) with these gaps: the deepest, the
/// farthest from it, the farthest from the line through both, the farthest outside the triangle of the three; where all are on one line, the
/// deepest and its ends. Ties, up to a millionth of the extent, go to the deeper one, then to the first; what reaches no
/// farther than that is left out. Indices ascend. Cost: O(points).
[[nodiscard]] std::vector<std::size_t> farthest(const std::vector<Vector3<double>>& at, const std::vector<double>& gap);

}  // namespace delassus
