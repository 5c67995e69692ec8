// Contact points of two convex shapes: plain geometry, no model.
#pragma once

#include "models/shapes/box_contacts.h"
#include "models/shapes/convex_shape.h"

namespace delassus {

/// At most 4 points with a gap of at most `margin` [m], all with one normal: the direction in which the shapes are farthest apart
/// (convex_axis.h). A face or disc across it is the reference: the other shape's face (side line, edge) that looks at it most is
/// cut to it, gaps are measured along the normal; of more than 4 points the deepest and those that reach farthest stay
/// (farthest.h). Without such a face: the ends of two parallel lines' overlap, or one point. The deepest point has the gap of the pair
/// (but for ties, 1e-9 of the shapes' size). What lies nearer to each other than 1e-7 of the size is one point.
/// Cost: that of the direction, and O(corners of the two faces, squared).
[[nodiscard]] std::vector<ShapeContact> convex_contacts(const ConvexShape& a, const ConvexShape& b, double margin);

}  // namespace delassus
