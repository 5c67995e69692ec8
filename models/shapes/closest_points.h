// Closest points of convex polytopes that are apart.
#pragma once

#include <optional>

#include "models/shapes/convex_shape.h"

namespace delassus {

/// The shortest vector from the polytope b to the polytope a; nothing where it is shorter than `least`.
/// How: Gilbert, Johnson and Keerthi, IEEE J. Robotics and Automation 4 (1988); of each simplex all faces are tried. Error: rounding of
/// the size of the shapes.
[[nodiscard]] std::optional<Vector3<double>> closest_points(const ConvexShape& a, const ConvexShape& b, double least);

}  // namespace delassus
