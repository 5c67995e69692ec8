// Swimmers of growing length: cost against size for every operator.
#pragma once

#include <functional>

#include "bench/cell.h"

namespace delassus::bench {

/// Measures every operator at every size, ascending. An operator is left out from the first size at which one of its
/// phases would take longer than `longest` seconds or its memory exceed `most_bytes`, extrapolated from the growth
/// between its last two sizes; the cell says so. `progress` is called with a line of text per size; `stop` is asked before each.
[[nodiscard]] std::vector<Rung> climb(const std::vector<Index>& links, const Limits& limits, double longest,
                                      double most_bytes, const std::function<void(const std::string&)>& progress,
                                      const std::function<bool()>& stop = {});

/// y at size n, continued from (n0, y0), (n1, y1) along a power law of at least first order.
[[nodiscard]] double continued(double n, double n0, double y0, double n1, double y1);

/// 3, 10, 30, … up to and including `largest`.
[[nodiscard]] std::vector<Index> ladder_sizes(Index largest);

}  // namespace delassus::bench
