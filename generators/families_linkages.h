// Linkages whose loops are closed by hard rows, of which some depend on the others: planar and overconstrained ones, along the
// axes and turned.
#pragma once

#include "generators/families.h"

namespace delassus::generators {

/// families() lists them last. Each has as many linkages as fit into n bodies, one at least, on a fixed or on a free body, with
/// its drivers locked. Along the axes where seed % 4 = 1, so that J has dependent rows exactly; else turned, so that
/// they depend to rounding. The driver rows are damped where seed % 2 = 0.
[[nodiscard]] std::vector<FamilyRow> linkage_families();

/// One linkage of the table, any of them, with masses and sizes over two decades and R⁻¹ = 0 or, for one in four, mixed.
[[nodiscard]] Spec any_linkage(std::uint64_t seed);

/// Degrees of freedom that all closures of a spec of these leave, drivers not locked.
[[nodiscard]] Index mobility(const Spec& spec);

}  // namespace delassus::generators
