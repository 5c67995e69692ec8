// A chain of N equal links swimming in a plane: the scene whose length is the size knob.
#pragma once

#include "models/scene.h"

namespace delassus {

/// N links of 1 kg and 0.1 m. The first moves in the xy plane (planar base, 3 dof), the others by revolutes about z;
/// every link touches the ground z = 0 with two contact points (3 rows each). n = N + 2 dofs, 2N points, 6N rows.
/// The pose is a gentle arc; where it moves its joints start with π/N cos(4π k/N) [rad/s]. Damping R⁻¹ = 1e-4 [1/kg] on every row. Cost and memory O(N).
/// @throws ModelError when links < 1.
[[nodiscard]] Scene swimmer(Index links);

}  // namespace delassus
