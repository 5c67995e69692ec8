// Operators used for one problem after another, and problems that no family draws: blocks of the damping over parts of
// constraints, no degree of freedom.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// The problem of a case, with blocks of R⁻¹ over whole constraints, their first or last rows, two halves, or none of them,
/// by `seed`; rows outside blocks keep their damping, if it is positive, else 1.
[[nodiscard]] Case with_partial_blocks(const Case& c, std::uint64_t seed);

/// Two welded bodies that three rows link: no degree of freedom, A = R⁻¹.
[[nodiscard]] Case without_freedoms();

/// Two rows on the six freedoms of a free body, two between it and another one.
[[nodiscard]] Case rows_on_a_free_joint();

/// A hard row, first or last, and two soft ones, on one freedom: A is regular, and there are more rows than freedoms.
[[nodiscard]] Case three_rows_on_one_freedom(Index hard = 0);

/// What an operator still knows of its use for `before` when it is analyzed, updated, damped and asked for `c`; empty: the
/// bits and reports are those of a fresh one, and nothing was written behind the workspace.
[[nodiscard]] std::string trace_of_use(const OperatorRow& row, const Case& before, const Case& c);

/// A massless tip makes M singular: every phase names the degree of freedom of its joint, until there are better numbers.
/// `held`: whether the tip carries the constraint, so that its step is active. A zero damping is forgotten the same way.
/// In words what is not so, in double or in rational numbers; empty: nothing.
[[nodiscard]] std::string lost_pivot_forgotten(const OperatorRow& row, bool held);

}  // namespace delassus::laws
