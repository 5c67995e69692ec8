#include "models/shapes/convex_contacts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "models/shapes/convex_axis.h"
#include "models/shapes/convex_face.h"
#include "models/shapes/farthest.h"
#include "models/shapes/segments.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// The pair along n, from b to a; size for what counts as one place.
struct Facing {
  const ConvexShape &a, &b;
  V3 n;
  double separation, size;
  double gap(const V3& on_a, const V3& on_b) const { return n.dot(on_a - on_b) - a.radius - b.radius; }
  /// Midway between the surfaces, from points of the cores one over the other.
  ShapeContact contact(const V3& on_a, const V3& on_b) const { return {(on_a + on_b + (b.radius - a.radius) * n) / 2, n, gap(on_a, on_b)}; }
};

/// Closest points of two edges that cross.
ShapeContact crossing(const Facing& f, const ConvexFace& a, const ConvexFace& b) {
  const V3 p = (a.corners[0] + a.corners[1]) / 2, q = (b.corners[0] + b.corners[1]) / 2, u = a.corners[1] - p, v = b.corners[1] - q;
  const auto [s, t] = closest_on_segments(p, u, q, v);
  return f.contact(p + s * u, q + t * v);
}

/// One point, at the gap of the pair: where two edges across n cross, else at a farthest point of one shape.
ShapeContact one_point(const Facing& f, const ConvexFace& a, const ConvexFace& b) {
  const auto across = [&](const ConvexFace& x) { return x.corners.size() == 2 && std::abs((x.corners[1] - x.corners[0]).dot(f.n)) <= 1e-7 * f.size; };
  const bool line_a = across(a), line_b = across(b);
  if (line_a && line_b) {
    const V3 u = a.corners[1] - a.corners[0], v = b.corners[1] - b.corners[0];
    if (u.cross(v).norm() > 1e-9 * u.norm() * v.norm()) return crossing(f, a, b);
  }
  if (line_a && !line_b) {
    const V3 q = support(f.b, f.n);
    return f.contact(q + f.separation * f.n, q);
  }
  const V3 p = support(f.a, -f.n);
  return f.contact(p, p - f.separation * f.n);
}

/// The ends of the overlap of two lines that are parallel as seen along n.
std::vector<ShapeContact> parallel_lines(const Facing& f, const ConvexFace& a, const ConvexFace& b) {
  const auto flat = [&](const V3& x) { return V3(x - x.dot(f.n) * f.n); };
  const V3 u = a.corners[1] - a.corners[0], v = b.corners[1] - b.corners[0], e = flat(u).normalized();
  if (flat(u).norm() <= 1e-7 * f.size || flat(v).norm() <= 1e-7 * f.size || std::abs(e.cross(flat(v).normalized()).dot(f.n)) > 1e-3) return {};
  // a point of each line by its coordinate along e
  const auto at = [&](const ConvexFace& x, const V3& along, double t) { return V3(x.corners[0] + (t - e.dot(x.corners[0])) / e.dot(along) * along); };
  const auto ends = [&](const ConvexFace& x) { return std::minmax({e.dot(x.corners[0]), e.dot(x.corners[1])}); };
  const auto [a_low, a_high] = ends(a);
  const auto [b_low, b_high] = ends(b);
  const double low = std::max(a_low, b_low), high = std::min(a_high, b_high);
  if (high - low <= 1e-7 * f.size) return {};
  return {f.contact(at(a, u, low), at(b, v, low)), f.contact(at(a, u, high), at(b, v, high))};
}

/// Points of `face` over the reference face; `sign` is 1 when that belongs to b.
std::vector<ShapeContact> face_points(const Facing& f, const ConvexFace& reference, const ConvexFace& face, double sign) {
  std::vector<ShapeContact> out;
  const V3 n = sign * f.n, o = reference.is_disc() ? reference.centre : reference.corners[0];
  for (const V3& x : overlap(reference, face, 1e-7 * f.size)) {
    const V3 foot = x - n.dot(x - o) * n;
    out.push_back(sign > 0 ? f.contact(x, foot) : f.contact(foot, x));
  }
  return out;
}

std::vector<ShapeContact> keep_four(const std::vector<ShapeContact>& points, const V3& n) {
  if (points.size() <= 4) return points;
  const V3 u = n.unitOrthogonal(), v = n.cross(u);
  std::vector<V3> at;
  std::vector<double> gap;
  for (const ShapeContact& c : points) at.emplace_back(u.dot(c.point - points[0].point), v.dot(c.point - points[0].point), 0), gap.push_back(c.gap);
  std::vector<ShapeContact> out;
  for (const std::size_t i : farthest(at, gap)) out.push_back(points[i]);
  return out;
}

}  // namespace

std::vector<ShapeContact> convex_contacts(const ConvexShape& a, const ConvexShape& b, double margin) {
  const auto axis = convex_axis(a, b, margin + a.radius + b.radius);
  if (!axis) return {};
  const Facing f{a, b, axis->n, axis->separation, a.size + b.size};
  const ConvexFace line_a = line_along(a, -f.n), line_b = line_along(b, f.n);
  std::vector<ShapeContact> points;
  if (axis->of == ConvexAxis::Of::face_of_a) points = face_points(f, face_across(a, -f.n), face_along(b, f.n), -1);
  else if (axis->of == ConvexAxis::Of::face_of_b) points = face_points(f, face_across(b, f.n), face_along(a, -f.n), 1);
  else if (line_a.corners.size() == 2 && line_b.corners.size() == 2) points = parallel_lines(f, line_a, line_b);
  std::erase_if(points, [&](const ShapeContact& c) { return c.gap > margin; });
  if (points.empty()) return {one_point(f, line_a, line_b)};
  return keep_four(points, f.n);
}

}  // namespace delassus
