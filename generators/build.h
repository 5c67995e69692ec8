// Spec → numbers. Pure: the same spec gives the same bits on every machine (integers and powers of two only); turned axes
// round, and the last bit may be the compiler's.
#pragma once

#include "algorithms/problem/problem.h"
#include "generators/spec.h"

namespace delassus::generators {

struct Built {
  Problem<double> problem;
  Damping<double> damping;
};

/// World axes, each tree about its root's joint point; S = (axis; p × axis). Inertias are those of seven point masses,
/// so they are symmetric, positive definite (mass > 0) and fulfil the triangle inequality exactly. Every number is a
/// dyadic rational of few bits: casts to Rational are exact and small. Turned (Spec::turn), S, K and H are rounded. Cost O(N + m).
/// @throws ModelError for a parent that is no earlier body, a zero axis, bodies out of range, a bad row count.
[[nodiscard]] Built build(const Spec& spec);

/// The same mechanism in axes turned by the rotation of this seed; S, K and H are rounded.
[[nodiscard]] Problem<double> turned(Problem<double> problem, std::uint64_t seed);

/// The power of two nearest to 10^decade.
[[nodiscard]] double power_of_ten(int decade);

}  // namespace delassus::generators
