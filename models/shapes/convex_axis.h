// The direction in which two convex cores are farthest apart.
//
// What     s(n) = min_A n·x − max_B n·x over units n, largest: the distance of cores that are apart, less the least translation that
//          parts them where they are not. s is looked at where it can be largest, at true supports, so that what is left out can
//          only cost the optimum, never the meaning of the gap:
//            faces and discs of both · crossed edges of polytopes whose arcs of normals meet · of polytopes that are apart the closest
//            points (Gilbert, Johnson, Keerthi 1988) · a cylinder against each corner of a polytope, in closed form, and along the arc of each edge, where
//            stationary points are isolated and bisected · two cylinders: the arcs of their sides, and rim against rim by Newton's
//            method on the sphere (rim_axis.h).
// Ties     Rounding decides nothing: of faces within 1e-9 of the shapes' size of the best the first one wins; anything else must beat faces,
//          and what came before, by 1e-12 of the size.
// Accuracy s to rounding but for ties; n to rounding, at closest points to rounding over the distance.
// Cost     polytopes O((F_a + F_b)(V_a + V_b) + E_a E_b); with a cylinder O((F + E) V)
#pragma once

#include <optional>

#include "models/shapes/convex_shape.h"

namespace delassus {

struct ConvexAxis {
  enum class Of { face_of_a, face_of_b, other };
  Vector3<double> n{0, 0, 1};  ///< unit, from b to a
  double separation = 0;       ///< of the cores [m], negative: penetration
  Of of = Of::other;
};

/// Nothing where the cores are farther apart than `limit`.
[[nodiscard]] std::optional<ConvexAxis> convex_axis(const ConvexShape& a, const ConvexShape& b, double limit);

/// s(n) as above.
[[nodiscard]] double separation(const ConvexShape& a, const ConvexShape& b, const Vector3<double>& n);

}  // namespace delassus
