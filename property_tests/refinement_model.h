// What a refinement must do when its corrections are known multiples of the right ones.
#pragma once

#include <string>

#include "property_tests/laws.h"

namespace delassus::laws {

/// Steps, status, certificate, estimate and answer of Refinement<double> (refinement.h) against what its header says of
/// them, in Quad, where every correction leaves given parts of the error of ν and of λ; in words what differs; empty:
/// nothing. Also at 2¹⁰ R⁻¹, where it is the motion whose error is the larger one. Needs a regular A.
[[nodiscard]] std::string refinement_wrong(const Case& c);

/// Nothing left of the residual and a motion that is corrected nevertheless, by as good as nothing: the refinement ends.
[[nodiscard]] std::string stray_motion_wrong();

}  // namespace delassus::laws
