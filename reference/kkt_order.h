// The order in which kkt_cholmod eliminates the unknowns of kkt.h (rules in kkt_cholmod.h).
#pragma once

#include <vector>

#include "reference/kkt.h"

namespace delassus::reference {

/// unknown[k] is eliminated k-th; without the rows' multipliers when `with_rows` is false.
/// @throws std::runtime_error when CAMD refuses the graph.
[[nodiscard]] std::vector<int> kkt_order(const Problem<double>& problem, const Damping<double>& damping, bool with_rows);

/// The sign a pivot of this unknown has when the system is regular: + for a_i and ν, − for φ_i and μ.
[[nodiscard]] inline int pivot_sign(const KktLayout& layout, Index unknown) {
  if (unknown < 6 * layout.bodies) return 1;
  if (unknown < 12 * layout.bodies) return -1;
  return unknown < layout.motion_size() ? 1 : -1;
}

}  // namespace delassus::reference
