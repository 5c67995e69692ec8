// Facets of the convex hull of a set of points, by qhull.
#pragma once

#include <array>
#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

/// The surface of a hull: triangles in space, edges in the plane (third index unused), outward normals.
struct Surface {
  struct Facet {
    std::array<int, 3> corner;
    Vector3<double> normal;
    double offset;  // normal · x + offset: height above the facet
  };
  int dimension = 3;
  std::vector<Facet> facets;
};

/// The hull of x[i], i in `of`, whose affine hull has `dimension` 2 (the first two coordinates) or 3. Facets of one plane have one normal.
/// @throws std::runtime_error with qhull's message; std::logic_error without qhull.
[[nodiscard]] Surface surface(const std::vector<Vector3<double>>& x, const std::vector<int>& of, int dimension);

}  // namespace delassus
