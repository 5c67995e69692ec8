// What a scene is, in numbers and words.
#pragma once

#include "bench/results.h"
#include "models/scene.h"

namespace delassus::bench {

/// Everything of a SceneResult but times and cells; the picture only when asked for.
[[nodiscard]] SceneResult facts_of(const Scene& scene, bool with_picture = true);

/// The constraints by kind: "4 contacts, 2 points, 12 joint friction rows".
[[nodiscard]] std::string constraint_summary(const Model& model);

}  // namespace delassus::bench
