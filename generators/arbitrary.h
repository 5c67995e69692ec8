// Random specs of every class from a seed: structure, enumerations and decades are drawn, never doubles.
// For searches: most are small (1 to 12 bodies), a few have up to 24, and a small share are chains above 200.
#pragma once

#include "generators/spec.h"

namespace delassus::generators {

/// The spec of this seed: the same on every machine. M is regular by construction (massless bodies carry armature);
/// A need not be: hard and dependent rows are among the classes. The shares of classes stand in classes.h.
/// Cost O(bodies).
[[nodiscard]] Spec arbitrary(std::uint64_t seed);

}  // namespace delassus::generators
