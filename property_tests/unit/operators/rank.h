// Rank decisions: hard rows that depend on one another, or nearly do.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// kkt_elimination or dense_refined on small problems: which rows are left out or refused, what is inconsistent, both
/// thresholds to the last bit, all in other units too; that a singular block of R⁻¹ is lost but a small damping is not.
/// In words what is not so; empty: nothing.
[[nodiscard]] std::string dependent_rows_wrong(const OperatorRow& row);

}  // namespace delassus::laws
