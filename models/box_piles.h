// Boxes that settle, as many as wanted: the scenes whose number of contacts is the size knob.
#pragma once

#include "models/scene.h"

namespace delassus {

/// N cubes of 1 kg and 0.2 m let go above the ground z = 0 under gravity, contacts detected, friction 0.5. Cost and memory O(N).
/// stacks: five on one another, 0.5 m apart: an island each. Every box falls 2 mm onto the one below. R⁻¹ = 1e-4 [1/kg].
/// wall: ten courses, each set off by half a box: one island once it stands. R⁻¹ = 1e-2 [1/kg].
/// @throws ModelError when boxes < 1.
[[nodiscard]] Scene stacks(Index boxes);
[[nodiscard]] Scene wall(Index boxes);

}  // namespace delassus
