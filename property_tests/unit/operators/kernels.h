// The parts operators are made of, held against the definition in rational numbers: what a refinement would mend is seen here.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// Which function of Factor (project, solve, energy, row_mobility; every matrix and choice of branches) or KktResidual
/// gives another number than the definition, in words; empty: none. In rational numbers; residuals in double as well, where
/// they must be right to eps of themselves and eps² of what is added. Also whether KktResidual gives back the numbers it was
/// given, and dot and largest_magnitude of vectors.h on whole numbers. Needs a regular M.
[[nodiscard]] std::string kernel_wrong(const Case& c);

}  // namespace delassus::laws
