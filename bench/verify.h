// The laws on scenes, on all cores.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/delassus.h"
#include "bench/results.h"
#include "models/scene.h"

namespace delassus::bench {

/// When laws are left out: after so many seconds per scene, except those that come first; all of them once `stop` says so, scenes not begun without a word.
struct Deadline {
  double seconds = 60;
  std::function<bool()> stop = {};
  bool default_in_full = true;   ///< every law of the default comes first too
};

/// Holds every law for each of the operators on each scene and stores the outcomes in the cells of `results` (same order as
/// `scenes`, one cell per operator). First, and whatever it takes: every operator against the definitions, and the default
/// against every law; then law by law. What the deadline leaves out says so. Scenes run side by side on all cores, those with most
/// rows first. `done` is called once per scene, one call at a time.
void verify(const std::vector<Scene>& scenes, const std::vector<const OperatorRow*>& ops, const Deadline& deadline, std::vector<SceneResult>& results,
            const std::function<void(const SceneResult&)>& done);

}  // namespace delassus::bench
