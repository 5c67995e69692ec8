// Convex hulls of point sets, with a bound on the number of vertices.
//
// What: the vertices of the hull; of more than `most`, those that a greedy search adds to a first simplex and to the
// extremes along x, y and z, the farthest outside first; what is cut off is measured.
// How: qhull, in coordinates scaled to unit size; points in a plane or on a line are treated there.
// Cost: O(n log n) for n points, then O(V · most) for V hull vertices when V > most.
// Source: C. B. Barber, D. P. Dobkin, H. Huhdanpaa: The quickhull algorithm for convex hulls, ACM TOMS 22 (1996).
#pragma once

#include <vector>

#include "models/shapes/facets.h"

namespace delassus {

struct Hull {
  std::vector<Vector3<double>> vertices;  ///< some of the points given, sorted by x, y, z
  Index all = 0;                          ///< vertices of the whole hull
  double cut = 0;                         ///< largest distance of a point of the whole hull from the kept one [as given]
};

/// The whole surface of a hull.
struct HullFacets {
  int dimension = 0;                      ///< 3: solid, 2: flat, 1: a line, 0: a point
  std::vector<Vector3<double>> vertices;  ///< corners of the facets; the ends of a line; the point
  std::vector<Surface::Facet> facets;     ///< in space: triangles; flat: edges (first two corners, normal in the plane); offsets unused
  Vector3<double> flat_normal{0, 0, 1};   ///< of a flat one
};

/// Whether the library was built with qhull.
[[nodiscard]] bool has_hulls();

/// The hull of finite points, at least one, with at most `most` ≥ 10 vertices.
/// @throws std::runtime_error with qhull's message when it finds no hull; std::logic_error without qhull.
[[nodiscard]] Hull convex_hull(const std::vector<Vector3<double>>& points, Index most);

/// The surface of the hull of finite points, at least one, of the thickness `convex_hull` sees. @throws as convex_hull.
[[nodiscard]] HullFacets hull_facets(const std::vector<Vector3<double>>& points);

}  // namespace delassus
