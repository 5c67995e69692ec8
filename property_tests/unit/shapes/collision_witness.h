// The deepest contact of two shapes as ODE and Bullet find it.
#pragma once

#include "algorithms/mechanism/model.h"

namespace delassus {

struct WitnessContact {
  bool found = false;
  Vector3<double> normal{0, 0, 1};  ///< from b to a
  double depth = 0;                 ///< [m]
};

/// Whether ODE has a routine of its own for the pair.
[[nodiscard]] bool ode_takes(Shape::Kind a, Shape::Kind b);
[[nodiscard]] WitnessContact ode_contact(const Shape& a, const Shape& b);
/// GJK and EPA, on shapes without Bullet's margin.
[[nodiscard]] WitnessContact bullet_contact(const Shape& a, const Shape& b);

}  // namespace delassus
