// Contact points of a capsule and a box: plain geometry, no model.
#pragma once

#include "models/shapes/box_contacts.h"

namespace delassus {

/// At most 4 points with a gap of at most `margin` [m], ordered along the axis centre ± half_axis, of a capsule (first shape) and a
/// box (second shape). Points of the axis are looked at as spheres: its ends, where it crosses the planes of the box's faces, and
/// where the signed distance to the box, a convex function along the axis, is least. The outermost of these stay, and where others are deeper the
/// outermost of the deepest: a capsule across a beam rests on both edges, one over a single edge on that. Cost: constant.
[[nodiscard]] std::vector<ShapeContact> capsule_box(const Vector3<double>& centre, const Vector3<double>& half_axis, double radius,
                                                    const PlacedBox& box, double margin);

}  // namespace delassus
