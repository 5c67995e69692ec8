// Links that fixed joints make one body: the sum of their masses.
#pragma once

#include <vector>

#include "algorithms/mechanism/model.h"

namespace delassus {

/// Mass [kg], centre of mass [m] and inertia about it [kg m²] of one link, in its body's frame.
struct Part {
  double mass;
  Vector3<double> com;
  Matrix3<double> inertia;
};

/// Sets mass, com and inertia of a body that has none: I = Σ I_k + m_k (|d|² 1 − d dᵀ), d = c_k − c. The inertia is symmetric to
/// the bit; a single part is taken as it is. Cost O(parts).
void sum_parts(const std::vector<Part>& parts, Body& body);

}  // namespace delassus
