// Contact points of two boxes, and of a sphere and a box: plain geometry, no model.
#pragma once

#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

/// A box: half extents [m], placed in some common frame.
struct PlacedBox {
  Vector3<double> half;
  Pose<double> placement;
};

struct ShapeContact {
  Vector3<double> point{0, 0, 0};   ///< midway between the surfaces, common frame
  Vector3<double> normal{0, 0, 1};  ///< unit, from the second shape to the first
  double gap = 0;                   ///< [m], negative: penetration
};

/// At most 4 points with a gap of at most `margin` [m]. Separating axes pick the nearest pair of faces (or of edges);
/// the incident face is clipped by the sides of the reference face; of more than 4 points those reaching farthest along
/// the diagonals of the reference face stay. Cost: constant.
[[nodiscard]] std::vector<ShapeContact> box_box(const PlacedBox& a, const PlacedBox& b, double margin);

/// The one point of a sphere (first shape) and a box (second shape), whatever the gap.
[[nodiscard]] ShapeContact sphere_box(const Vector3<double>& centre, double radius, const PlacedBox& box);

}  // namespace delassus
