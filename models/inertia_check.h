// What is doubtful about the mass and inertia of a link, for every reader of robot files.
#pragma once

#include "models/robot.h"

namespace delassus {

/// Warns of inertias that no solid body has: principal moments that break the triangle inequality or are negative, point
/// masses and thin rods, an inertia without mass. Each holds up to the rounding of three eigenvalues, 30 · 3 ε of the largest
/// entry. Whether M is regular with them is decided by `validate`. `inertia` is about the centre of mass [kg m²].
/// @throws ModelError in strict mode.
void judge_inertia(Findings& findings, const std::string& file, const std::string& element, double mass,
                   const Matrix3<double>& inertia);

}  // namespace delassus
