#include "models/shapes/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "models/shapes/hull.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// An edge between faces with these normals (opposite ones: the arc over `middle`).
Polytope::Edge edge_between(const std::vector<V3>& x, std::size_t p, std::size_t q, const V3& n, const V3& m, const V3& middle) {
  const V3 e = (x[q] - x[p]).normalized();
  V3 in = e.cross(n), out = -e.cross(m);
  if (in.dot(middle) < 0) in = -in, out = -out;
  const double angle = std::atan2(n.cross(m).norm(), n.dot(m));
  return {p, q, n, in, out, angle, false};
}

}  // namespace

Polytope segment_polytope(double half) {
  Polytope out;
  if (half == 0) {
    out.corners = {V3::Zero()};
    return out;
  }
  out.corners = {V3(0, 0, -half), V3(0, 0, half)};
  out.edges = {{0, 1, V3::UnitX(), V3::UnitY(), V3::Zero(), 2 * M_PI, true}};
  return out;
}

Polytope box_polytope(const Vector3<double>& half) {
  Polytope out;
  for (int k = 0; k < 8; ++k) out.corners.emplace_back(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
  for (int i = 0; i < 3; ++i)
    for (const double side : {-1.0, 1.0}) out.normals.push_back(side * V3::Unit(i));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t p = 0; p < 8; ++p) {
      const std::size_t q = p | (std::size_t{1} << i), j = (i + 1) % 3, k = (i + 2) % 3;
      if (p == q) continue;
      const V3 n = (p >> j & 1 ? 1 : -1) * V3::Unit(static_cast<Index>(j)), m = (p >> k & 1 ? 1 : -1) * V3::Unit(static_cast<Index>(k));
      out.edges.push_back({p, q, n, m, n, M_PI / 2, false});
    }
  return out;
}

Polytope hull_polytope(const std::vector<Vector3<double>>& points) {
  const HullFacets hull = hull_facets(points);
  Polytope out;
  out.corners = hull.vertices;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  if (hull.dimension == 1) {
    const V3 n = (out.corners[1] - out.corners[0]).unitOrthogonal();
    out.edges = {{0, 1, n, (out.corners[1] - out.corners[0]).normalized().cross(n), V3::Zero(), 2 * M_PI, true}};
  } else if (hull.dimension == 2) {
    const V3& n = hull.flat_normal;
    for (const Surface::Facet& f : hull.facets) out.edges.push_back(edge_between(out.corners, at(f.corner[0]), at(f.corner[1]), n, -n, f.normal));
    out.normals = {n, -n};
  } else if (hull.dimension == 3) {
    for (const Surface::Facet& f : hull.facets)
      if (std::none_of(out.normals.begin(), out.normals.end(), [&](const V3& n) { return (n - f.normal).norm() < 1e-5; })) out.normals.push_back(f.normal);
    std::map<std::pair<int, int>, std::vector<V3>> sides;
    for (const Surface::Facet& f : hull.facets)
      for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 2}})
        sides[std::minmax(f.corner[at(i)], f.corner[at(j)])].push_back(f.normal);
    for (const auto& [ends, n] : sides)
      if (n.size() == 2 && n[0] != n[1]) out.edges.push_back(edge_between(out.corners, at(ends.first), at(ends.second), n[0], n[1], n[0] + n[1]));
  }
  return out;
}

ConvexShape placed(const Polytope& polytope, const Pose<double>& placement, double radius) {
  ConvexShape out;
  out.polytope = polytope;
  out.radius = radius;
  out.centre.setZero();
  for (V3& x : out.polytope.corners) x = placement * x, out.centre += x / static_cast<double>(polytope.corners.size());
  for (const V3& x : out.polytope.corners) out.size = std::max(out.size, (x - out.centre).norm());
  for (V3& n : out.polytope.normals) n = placement.rotation * n;
  for (Polytope::Edge& e : out.polytope.edges) e.from = placement.rotation * e.from, e.in = placement.rotation * e.in, e.out = placement.rotation * e.out;
  return out;
}

ConvexShape placed_cylinder(double radius, double half, const Pose<double>& placement) {
  ConvexShape out;
  out.placement = placement, out.disc = radius, out.half = half;
  out.centre = placement.translation, out.size = std::hypot(radius, half);
  return out;
}

Vector3<double> support(const ConvexShape& s, const Vector3<double>& n) {
  if (!s.is_cylinder()) {
    std::size_t best = 0;
    double far = n.dot(s.polytope.corners[0]);
    for (std::size_t i = 1; i < s.polytope.corners.size(); ++i) {
      const double d = n.dot(s.polytope.corners[i]);
      if (d > far) far = d, best = i;
    }
    return s.polytope.corners[best];
  }
  const V3 z = s.axis(), across = s.across(n);
  const double length = across.norm();
  V3 out = s.centre + (n.dot(z) < 0 ? -s.half : s.half) * z;
  if (length > 0) out += s.disc / length * across;
  return out;
}

}  // namespace delassus
