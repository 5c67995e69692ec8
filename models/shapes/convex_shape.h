// Convex shapes as the search for contacts sees them: a core and the radius of a ball that it is swept by. Plain geometry, no model.
//
//   polytope   point (of a sphere), segment (of a capsule), box, hull of a mesh: corners, faces, and edges with the outward normals
//              at which each supports the shape, an arc between the normals of the two faces it joins
//   cylinder   solid: discs, side lines, rims
#pragma once

#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

struct Polytope {
  struct Edge {
    std::size_t p, q;            ///< corners
    Vector3<double> from;        ///< unit normal at which the arc begins
    Vector3<double> in, out;     ///< an outward normal n ⟂ edge is on the arc when n·in ≥ 0 and n·out ≥ 0; not units
    double angle;                ///< of the arc, which begins from `from` towards `in`; 2π: any normal (both zero but for the sense of `in`)
    bool any = false;            ///< a segment's: on the arc is every normal
  };
  std::vector<Vector3<double>> corners;
  std::vector<Vector3<double>> normals;  ///< of faces, outward units; a flat polytope has two
  std::vector<Edge> edges;
};

[[nodiscard]] Polytope segment_polytope(double half);                          ///< along z; 0: a point
[[nodiscard]] Polytope box_polytope(const Vector3<double>& half);
/// Facets of nearly one plane (a hundred-thousandth: meshes are rounded) are one face. @throws as convex_hull (models/shapes/hull.h).
[[nodiscard]] Polytope hull_polytope(const std::vector<Vector3<double>>& points);

struct ConvexShape {
  Polytope polytope;           ///< placed in the common frame; without corners: a cylinder
  Pose<double> placement;      ///< of a cylinder, axis z
  double disc = 0, half = 0;   ///< of a cylinder: radius, half length
  double radius = 0;           ///< of the ball that sweeps the core
  Vector3<double> centre{0, 0, 0};
  double size = 0;             ///< no point of the core is farther from the centre

  [[nodiscard]] bool is_cylinder() const { return polytope.corners.empty(); }
  [[nodiscard]] Vector3<double> axis() const { return placement.rotation.col(2); }
  /// The part of v across a cylinder's axis, to rounding of that part.
  [[nodiscard]] Vector3<double> across(const Vector3<double>& v) const {
    return placement.rotation.leftCols<2>() * (placement.rotation.leftCols<2>().transpose() * v);
  }
};

[[nodiscard]] ConvexShape placed(const Polytope& polytope, const Pose<double>& placement, double radius);
[[nodiscard]] ConvexShape placed_cylinder(double radius, double half, const Pose<double>& placement);

/// The point of the core that is farthest along n; the first of several.
[[nodiscard]] Vector3<double> support(const ConvexShape& s, const Vector3<double>& n);

}  // namespace delassus
