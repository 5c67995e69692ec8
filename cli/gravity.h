// What gravity does to the rows of a scene at rest.
#pragma once

#include <optional>

#include "models/scene.h"

namespace delassus::cli {

/// −J M⁻¹ g(q): the accelerations that constraint forces must give for the rows to stay at rest under the scene's gravity, no motor
/// turning and nothing moving. Nothing where the scene has no gravity, or M no factor at this pose. Cost O(n + m).
[[nodiscard]] std::optional<VectorX<double>> rest_under_gravity(const Scene& scene);

}  // namespace delassus::cli
