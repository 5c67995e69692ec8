// Conjugate gradients on matrices of known spectrum: what the laws cannot see, since restarts and the final residual make
// up for a slow or a wrong step.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// What `row`, cg or cg_preconditioned, does other than its header says: how many steps known spectra take, that a solve
/// which did not converge says so, that right-hand sides of other units give the same digits, overflow and underflow.
/// In words; empty: nothing.
[[nodiscard]] std::string krylov_wrong(const OperatorRow& row);

}  // namespace delassus::laws
