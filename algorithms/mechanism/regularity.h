// Internals of model validation.
#pragma once

#include "algorithms/mechanism/model.h"

namespace delassus {

/// @throws ModelError when a pose is not finite or its rotation not proper orthogonal (entries of RᵀR − 1 below 30 ε · 3).
void check_pose(const Pose<double>& pose, const std::string& file, const std::string& element);

/// Decides whether the massless bodies of a valid tree leave M regular in general position.
/// @throws ModelError naming the body whose joint moves no inertia.
void check_regular(const Model& model, const std::string& file);

}  // namespace delassus
