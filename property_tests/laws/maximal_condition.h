// How ill-conditioned a mechanism is when all six motions of every body are unknown, whatever A is in its joints.
#pragma once

#include "algorithms/problem/problem.h"

namespace delassus::laws {

/// κ₂ of N = B H⁻¹Bᵀ + C, B the rows of all joints and constraints on single bodies, C their compliance, each joint's six rows
/// made orthonormal in N and each constraint row scaled to 1: to about 1/eps; infinite where H of a body is singular, or N.
/// Dense: (6 N + m)³.
[[nodiscard]] double maximal_condition(const Problem<double>& problem, const Damping<double>& damping);

}  // namespace delassus::laws
