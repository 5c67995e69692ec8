// What nested dissection (algorithms/factors/dissection.h) saves of the work of an elimination, on the ladders of coupled free bodies.
#pragma once

#include <string>

#include "bench/scaling/scaling.h"

namespace delassus::bench {

/// Walls, pyramids and lattices by size, up to 10⁴ bodies: Σ n (|Q| + 1)² by minimum degree alone, and in the order taken, both computed here.
/// Empty for other ladders.
[[nodiscard]] std::string dissection_table(const ScalingLadder& ladder);

}  // namespace delassus::bench
