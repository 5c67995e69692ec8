// What a plan of elimination must be, worked out once more by sets, without any thought for speed.
#pragma once

#include <string>

#include "algorithms/factors/plan.h"

namespace delassus {

/// Where a plan is not what its header promises (elimination.h), in words; empty: nowhere. Judged are the order (minimum
/// degree, ties by depth, freedoms, number), Q_i, every block's number, the runs and the offsets. With `order_of` the order must be that of this other plan;
/// with `stages`, of all bodies, those of a lower one come first. Cost O(N³).
[[nodiscard]] std::string plan_broken(const Plan& plan, const Structure& s, Matrix matrix, Branches branches, const Plan* order_of = nullptr, const std::vector<int>& stages = {});

}  // namespace delassus
