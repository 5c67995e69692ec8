// What solves  (K)  M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂  once, held against the definition: a refinement would mend it.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// CappedInverse in double and in float: the residual of (K) at the damping its header says, to rounding; the same bits in
/// other units of mass and of acceleration, where float alone would overflow or vanish. In words; empty: all is right.
/// Needs a regular M.
[[nodiscard]] std::string capped_inverse_wrong(const Case& c);

/// The same, whatever is the largest number of the problem; rows that nothing moves; no rows.
[[nodiscard]] std::string capped_inverse_limits_wrong();

/// SquareRootFactor in double and in float: the residual of (K), rounding relative to each row's own terms; no r₁, shared
/// memory, other weights in between, and what is written behind the workspace. Needs a regular M and R⁻¹ > 0.
[[nodiscard]] std::string square_root_wrong(const Case& c);

/// The same where many rows meet, or none; squares that overflow.
[[nodiscard]] std::string square_root_limits_wrong();

/// KktElimination in rational numbers: the residual of (K) is zero where r₂ is in the range, rows left out carry no force.
[[nodiscard]] std::string elimination_wrong(const Case& c);

}  // namespace delassus::laws
