// The laws on scenes, on all cores.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/delassus.h"
#include "bench/results.h"
#include "models/scene.h"

namespace delassus::bench {

/// Holds every law for each of the operators on each scene and stores the outcomes in the cells of `results` (same order as
/// `scenes`, one cell per operator). Scenes run side by side on all cores, those with most rows first. From
/// `time_limit` seconds on, the laws left of a scene are skipped and say so. `done` is called once per scene, one call
/// at a time.
void verify(const std::vector<Scene>& scenes, const std::vector<const OperatorRow*>& ops, double time_limit, std::vector<SceneResult>& results,
            const std::function<void(const SceneResult&)>& done);

}  // namespace delassus::bench
