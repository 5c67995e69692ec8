// Operators used for one problem after another, and dampings with blocks over parts of constraints.
#pragma once

#include <string>

#include "property_tests/laws.h"

namespace delassus::laws {

/// The problem of a case, with blocks of R⁻¹ over whole constraints, their first or last rows, two halves, or none of them,
/// by `seed`; rows outside blocks keep their damping, if it is positive, else 1.
[[nodiscard]] Case with_partial_blocks(const Case& c, std::uint64_t seed);

/// What an operator still knows of its use for `before` when it is analyzed, updated, damped and asked for `c`; empty: the
/// bits and reports are those of a fresh one.
[[nodiscard]] std::string trace_of_use(const OperatorRow& row, const Case& before, const Case& c);

}  // namespace delassus::laws
