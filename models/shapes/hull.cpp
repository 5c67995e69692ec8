#include "models/shapes/hull.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "algorithms/kit/index.h"

#include <Eigen/Geometry>

namespace delassus {

#ifndef DELASSUS_QHULL

bool has_hulls() { return false; }
Hull convex_hull(const std::vector<Vector3<double>>&, Index) { throw std::logic_error("built without qhull"); }
HullFacets hull_facets(const std::vector<Vector3<double>>&) { throw std::logic_error("built without qhull"); }

#else

namespace {

using V3 = Vector3<double>;
using Points = std::vector<V3>;

std::vector<int> vertices_of(const Surface& s) {
  std::set<int> out;
  for (const Surface::Facet& f : s.facets) out.insert(f.corner.begin(), f.corner.begin() + s.dimension);
  return {out.begin(), out.end()};
}

double height(const Surface::Facet& f, const V3& x) { return f.normal.dot(x) + f.offset; }

double to_segment(const V3& x, const V3& a, const V3& b) {
  const V3 d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp(d.dot(x - a) / d.squaredNorm(), 0.0, 1.0) : 0;
  return (x - a - t * d).norm();
}

/// Distance of a point from a triangle or an edge.
double to_facet(const Points& x, const Surface& s, const Surface::Facet& f, const V3& p) {
  const V3 &a = x[z(f.corner[0])], &b = x[z(f.corner[1])];
  if (s.dimension == 2) return to_segment(p, a, b);
  const V3 &c = x[z(f.corner[2])], n = (b - a).cross(c - a);
  bool inside = n.squaredNorm() > 0;
  for (const auto& [u, v] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) inside = inside && n.cross(v - u).dot(p - u) >= 0;
  if (inside) return std::abs(n.dot(p - a)) / n.norm();
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

/// Distance from the hull; 0 inside.
double outside(const Points& x, const Surface& s, const V3& p) {
  double least = std::numeric_limits<double>::infinity(), highest = 0;
  for (const Surface::Facet& f : s.facets) highest = std::max(highest, height(f, p));
  if (highest == 0) return 0;
  for (const Surface::Facet& f : s.facets) least = std::min(least, to_facet(x, s, f, p));
  return least;
}

template <class F> int farthest(const Points& x, const std::vector<int>& of, F&& distance) {
  return *std::max_element(of.begin(), of.end(), [&](int i, int j) { return distance(x[z(i)]) < distance(x[z(j)]); });
}

/// Farthest from the first point, from the line through both, from the plane through the three; and how far.
struct Spread {
  std::array<int, 4> corner{0, 0, 0, 0};
  std::array<double, 4> far{0, 0, 0, 0};
  Matrix3<double> axes = Matrix3<double>::Identity();  // columns: along the line, in the plane, its normal
};

Spread spread(const Points& x, const std::vector<int>& of) {
  Spread s;
  s.corner[0] = of.front();
  const V3 a = x[z(of.front())];
  auto measure = [&](std::size_t k, auto&& distance) {
    s.corner[k] = farthest(x, of, distance);
    s.far[k] = distance(x[z(s.corner[k])]);
  };
  measure(1, [&](const V3& p) { return (p - a).norm(); });
  if (s.far[1] == 0) return s;
  const V3 u = (x[z(s.corner[1])] - a).normalized();
  measure(2, [&](const V3& p) { return u.cross(p - a).norm(); });
  const V3 off = s.far[2] > 0 ? V3(x[z(s.corner[2])] - a) : u.unitOrthogonal(), v = (off - u.dot(off) * u).normalized();
  s.axes << u, v, u.cross(v);
  measure(3, [&](const V3& p) { return std::abs(s.axes.col(2).dot(p - a)); });
  return s;
}

/// At most `most` of the vertices.
std::vector<int> choose(const Points& x, const std::vector<int>& vertices, int dimension, std::size_t most) {
  const Spread first = spread(x, vertices);
  std::set<int> kept(first.corner.begin(), first.corner.begin() + dimension + 1);
  for (int k = 0; k < dimension; ++k)
    for (const double side : {-1.0, 1.0}) kept.insert(farthest(x, vertices, [&](const V3& p) { return side * p[k]; }));
  while (kept.size() < most) {
    const Surface s = surface(x, {kept.begin(), kept.end()}, dimension);
    std::map<int, double> outer;  // farthest outside each facet → height
    for (const Surface::Facet& f : s.facets) {
      const int i = farthest(x, vertices, [&](const V3& p) { return height(f, p); });
      const double h = height(f, x[z(i)]);
      if (h > 0 && !kept.count(i)) outer[i] = std::max(outer[i], h);
    }
    if (outer.empty()) break;
    std::vector<std::pair<double, int>> order;
    for (const auto& [i, h] : outer) order.emplace_back(-h, i);
    std::sort(order.begin(), order.end());
    const std::size_t room = std::min({most - kept.size(), std::max<std::size_t>(1, kept.size() / 2), order.size()});
    for (std::size_t k = 0; k < room; ++k) kept.insert(order[k].second);
  }
  return {kept.begin(), kept.end()};
}

/// Indices of the hull's vertices; the largest distance of a dropped one; and how many there were.
std::vector<int> hull_of(const Points& x, const std::vector<int>& of, int dimension, std::size_t most, Hull& out) {
  std::vector<int> vertices = vertices_of(surface(x, of, dimension));
  out.all = static_cast<Index>(vertices.size());
  if (vertices.size() <= most) return vertices;
  std::vector<int> kept = choose(x, vertices, dimension, most);
  const Surface s = surface(x, kept, dimension);
  for (const int i : vertices) out.cut = std::max(out.cut, outside(x, s, x[z(i)]));
  return kept;
}

bool before(const V3& a, const V3& b) { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); }

/// Equal points once, sorted, as numbers around 0 of size 1; returns the size.
double scaled(const Points& points, Points& distinct, Points& x) {
  distinct = points;
  std::sort(distinct.begin(), distinct.end(), before);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  V3 low = distinct.front(), high = low;
  for (const V3& p : distinct) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const V3 centre = low / 2 + high / 2;
  const double size = (high / 2 - low / 2).maxCoeff();
  for (const V3& p : distinct) x.push_back(size > 0 ? V3((p - centre) / size) : V3::Zero());
  return size;
}

/// Thickness below which a set of points of size 1 is flat, by rounding; and where qhull may give up.
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon(), too_thin = 1e-9;

}  // namespace

bool has_hulls() { return true; }

Hull convex_hull(const std::vector<Vector3<double>>& points, Index most) {
  if (points.empty() || most < 10) throw std::logic_error("convex_hull: needs points and room for 10 vertices");
  Points distinct, x;
  const double size = scaled(points, distinct, x);
  std::vector<int> of(x.size());
  std::iota(of.begin(), of.end(), 0);
  const Spread s = spread(x, of);
  Hull out;
  std::vector<int> kept{0};
  const auto limit = static_cast<std::size_t>(most);
  auto in_plane = [&] {
    for (V3& p : x) p = s.axes.transpose() * p, p[2] = 0;
    kept = hull_of(x, of, 2, limit, out);
    out.cut += s.far[3];
  };
  if (s.far[3] > rounding) {
    try {
      kept = hull_of(x, of, 3, limit, out);
    } catch (const std::runtime_error&) {  // thicker than rounding, too thin for qhull
      if (s.far[3] > too_thin) throw;
      in_plane();
    }
  } else if (s.far[2] > rounding) {
    in_plane();
  } else if (s.far[1] > 0) {
    kept = {0, s.corner[1]};  // the first in order is an end of the line
  }
  out.all = std::max<Index>(out.all, static_cast<Index>(kept.size()));
  out.cut *= size;
  for (const int i : kept) out.vertices.push_back(distinct[z(i)]);
  std::sort(out.vertices.begin(), out.vertices.end(), before);
  return out;
}

HullFacets hull_facets(const std::vector<Vector3<double>>& points) {
  if (points.empty()) throw std::logic_error("hull_facets: needs points");
  Points distinct, x;
  scaled(points, distinct, x);
  std::vector<int> of(x.size());
  std::iota(of.begin(), of.end(), 0);
  const Spread s = spread(x, of);
  HullFacets out;
  std::vector<int> corners{0};
  auto found = [&](const Surface& surface) {
    out.dimension = surface.dimension, out.facets = surface.facets, out.flat_normal = s.axes.col(2);
    corners = vertices_of(surface);
    std::map<int, int> place;
    for (std::size_t k = 0; k < corners.size(); ++k) place[corners[k]] = static_cast<int>(k);
    for (Surface::Facet& f : out.facets) {
      for (int k = 0; k < surface.dimension; ++k) f.corner[z(k)] = place.at(f.corner[z(k)]);
      if (surface.dimension == 2) f.normal = s.axes * f.normal;
    }
  };
  auto in_plane = [&] {
    Points flat = x;
    for (V3& p : flat) p = s.axes.transpose() * p, p[2] = 0;
    found(surface(flat, of, 2));
  };
  if (s.far[3] > rounding) {
    try {
      found(surface(x, of, 3));
    } catch (const std::runtime_error&) {
      if (s.far[3] > too_thin) throw;
      in_plane();
    }
  } else if (s.far[2] > rounding) {
    in_plane();
  } else if (s.far[1] > 0) {
    out.dimension = 1, corners = {0, s.corner[1]};
  }
  for (const int i : corners) out.vertices.push_back(distinct[z(i)]);
  return out;
}

#endif

}  // namespace delassus
