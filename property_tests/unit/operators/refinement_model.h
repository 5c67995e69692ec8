// What a refinement must do when its corrections are known multiples of the right ones.
#pragma once

#include <string>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// Steps, status, certificate, estimate and answer of Refinement<double> (refinement.h) against what its header says of
/// them, in Quad, where every correction leaves given parts of the error of ν and of λ; in words what differs; empty:
/// nothing. Also at 2¹⁰ R⁻¹, where it is the motion whose error is the larger one. Needs a regular A.
[[nodiscard]] std::string refinement_wrong(const Case& c);

/// Corrections of ν that the energy hardly sees: as good as nothing where nothing is left of the residual, and the refinement
/// ends; half of the last one where something is, and it goes on; far smaller than the first one, and it ends. A force whose
/// patient correction is 0 while its row is not satisfied: it goes on.
[[nodiscard]] std::string stray_motion_wrong();

/// M factored by the refinement, on two threads that ask for it at once, or by somebody else: the same answer; bytes and
/// workspace of either; M that is singular, then better numbers. In words what differs; empty: nothing.
[[nodiscard]] std::string factored_mass_wrong();

}  // namespace delassus::laws
