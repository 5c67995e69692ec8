// Faces of convex shapes, and where two of them overlap.
#pragma once

#include <vector>

#include "models/shapes/convex_shape.h"

namespace delassus {

/// A face, an edge or side line, a corner: part of a shape's surface.
struct ConvexFace {
  std::vector<Vector3<double>> corners;  ///< of a polygon in order, of a line, of a point; a disc has none
  Vector3<double> normal{0, 0, 1};       ///< outward, of polygons and discs
  Vector3<double> centre{0, 0, 0}, x{1, 0, 0};  ///< of a disc: an axis in its plane
  double disc = 0;                       ///< its radius

  [[nodiscard]] bool is_disc() const { return corners.empty(); }
  [[nodiscard]] bool is_plane() const { return is_disc() || corners.size() > 2; }
};

/// The face with this outward normal: all corners within a millionth of the size of its plane; a cylinder's disc.
[[nodiscard]] ConvexFace face_across(const ConvexShape& s, const Vector3<double>& n);

/// The face at the farthest points along n that looks most along n. Where all of these look elsewhere, by more than 84°, the line as below; of a cylinder the disc or,
/// from 45° on, the side line.
[[nodiscard]] ConvexFace face_along(const ConvexShape& s, const Vector3<double>& n);

/// The edge (side line) at the farthest point along n that is least inclined to it, or where all are, by more than 0.1, that point.
[[nodiscard]] ConvexFace line_along(const ConvexShape& s, const Vector3<double>& n);

/// Points of `face` (on its line or plane) over the reference, a polygon or a disc, along its normal: corners of each in the other,
/// crossings of their outlines, of discs eight points of the rim, the deepest or the farthest in first. Each once, up to `same` [m]. Of two discs
/// the outlines cross as if parallel.
[[nodiscard]] std::vector<Vector3<double>> overlap(const ConvexFace& reference, const ConvexFace& face, double same);

}  // namespace delassus
