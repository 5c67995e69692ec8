// Contact problems of a run, written as files that replay (simulation/problem_file.h).
#pragma once

#include <string>
#include <vector>

#include "models/scene.h"
#include "simulation/step.h"

namespace delassus::cli {

/// Writes those of the last step to `folder`, SCENE_step_N_K.dat with the number of the step and of the problem in it; `all`, or only the
/// one that no solver could do, SCENE_step_N_K_unsolved.dat. Returns the files. @throws ModelError for a folder that cannot be written.
std::vector<std::string> capture(const std::string& folder, const Scene& scene, const simulation::Simulation<double>& s, bool all);

/// @throws ModelError when it is no folder and cannot be made.
void check_folder(const std::string& folder);

}  // namespace delassus::cli
