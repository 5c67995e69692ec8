// What a refinement must do when its corrections are known multiples of the right ones.
#pragma once

#include <string>

#include "property_tests/laws.h"

namespace delassus::laws {

/// Steps, status, certificate, estimate and answer of Refinement<double> (refinement.h) against what its header says of
/// them, in Quad, where every correction leaves given parts of the error of ν and of λ; in words what differs; empty:
/// nothing. Also at 1024 R⁻¹, where it is the motion whose error is the larger one. Needs a regular A.
[[nodiscard]] std::string refinement_wrong(const Case& c);

}  // namespace delassus::laws
