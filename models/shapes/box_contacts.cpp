#include "models/shapes/box_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "models/shapes/segments.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// Half width of a box along a unit direction.
double reach(const PlacedBox& box, const V3& n) { return box.half.dot((box.placement.rotation.transpose() * n).cwiseAbs()); }

/// A direction from b to a along which the boxes are farthest apart, among those tried so far.
struct Separation {
  V3 n{0, 0, 1};
  double separation = -std::numeric_limits<double>::infinity();
  int kind = 0;  // 0: face of a, 1: face of b, 2: pair of edges
};

void try_axis(const PlacedBox& a, const PlacedBox& b, V3 n, int kind, double head_start, Separation& best) {
  const V3 d = a.placement.translation - b.placement.translation;
  if (n.dot(d) < 0) n = -n;
  const double separation = n.dot(d) - reach(a, n) - reach(b, n);
  if (separation > best.separation + head_start) best = {n, separation, kind};
}

/// Faces of a first, then of b, then pairs of edges; a later kind wins only by a clear lead, so that resting faces do
/// not flicker between equal descriptions. Of two faces equally far apart the larger one wins, whatever the order of
/// the boxes.
Separation best_axis(const PlacedBox& a, const PlacedBox& b) {
  const double lead = 1e-6 * (a.half.norm() + b.half.norm());
  const auto area = [](const PlacedBox& box, int k) { return box.half[(k + 1) % 3] * box.half[(k + 2) % 3]; };
  Separation best;
  double largest = 0;  // face of a
  for (int k = 0; k < 3; ++k) {
    const double before = best.separation;
    try_axis(a, b, a.placement.rotation.col(k), 0, k == 0 ? 0 : lead, best);
    if (best.separation > before) largest = area(a, k);
  }
  for (int k = 0; k < 3; ++k) try_axis(a, b, b.placement.rotation.col(k), 1, area(b, k) > largest && best.kind == 0 ? -lead : lead, best);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V3 n = a.placement.rotation.col(i).cross(b.placement.rotation.col(j));
      if (n.squaredNorm() > 1e-6) try_axis(a, b, n.normalized(), 2, lead, best);  // parallel edges add no direction
    }
  return best;
}

/// The face of a box that looks most along n.
struct Face {
  int axis;
  V3 normal, centre, u, v;
  double half_u, half_v;
};

Face face_along(const PlacedBox& box, const V3& n) {
  const V3 local = box.placement.rotation.transpose() * n;
  Face f{};
  local.cwiseAbs().maxCoeff(&f.axis);
  const int i = (f.axis + 1) % 3, j = (f.axis + 2) % 3;
  f.normal = (local[f.axis] < 0 ? -1 : 1) * box.placement.rotation.col(f.axis);
  f.centre = box.placement.translation + box.half[f.axis] * f.normal;
  f.u = box.placement.rotation.col(i), f.v = box.placement.rotation.col(j);
  f.half_u = box.half[i], f.half_v = box.half[j];
  return f;
}

/// Sutherland–Hodgman: the part of a polygon with n·x ≤ limit.
std::vector<V3> clip(const std::vector<V3>& polygon, const V3& n, double limit) {
  std::vector<V3> out;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const V3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double hp = n.dot(p) - limit, hq = n.dot(q) - limit;
    if (hp <= 0) out.push_back(p);
    if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) out.push_back(p + hp / (hp - hq) * (q - p));
  }
  return out;
}

/// Of more than 4 points, the farthest along each diagonal of the face.
void keep_four(std::vector<ShapeContact>& points, const Face& f) {
  if (points.size() <= 4) return;
  std::vector<ShapeContact> kept;
  for (const auto& [s, t] : std::array<std::pair<double, double>, 4>{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}) {
    const V3 d = (f.half_u > 0 ? s / f.half_u : 0) * f.u + (f.half_v > 0 ? t / f.half_v : 0) * f.v;
    const auto it = std::max_element(points.begin(), points.end(), [&](const auto& x, const auto& y) { return d.dot(x.point) < d.dot(y.point); });
    kept.push_back(*it);
    points.erase(it);
  }
  points = std::move(kept);
}

/// Points of two faces; `sign` is +1 when the reference face belongs to b (its normal points from b to a).
std::vector<ShapeContact> face_face(const Face& reference, const Face& incident, double sign, double margin) {
  std::vector<V3> polygon;
  for (const auto& [s, t] : std::array<std::pair<double, double>, 4>{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}})
    polygon.push_back(incident.centre - reference.centre + s * incident.half_u * incident.u + t * incident.half_v * incident.v);
  for (const double s : {-1.0, 1.0}) {
    polygon = clip(polygon, s * reference.u, reference.half_u);
    polygon = clip(polygon, s * reference.v, reference.half_v);
  }
  std::vector<ShapeContact> out;
  for (const V3& p : polygon) {
    const double gap = reference.normal.dot(p);
    if (gap <= margin) out.push_back({reference.centre + p - gap / 2 * reference.normal, sign * reference.normal, gap});
  }
  keep_four(out, reference);
  return out;
}

/// The point midway between the two supporting edges, where they are closest.
ShapeContact edge_edge(const PlacedBox& a, const PlacedBox& b, const Separation& axis) {
  auto edge = [](const PlacedBox& box, const V3& n, V3& direction) {
    const V3 local = box.placement.rotation.transpose() * n;
    int along = 0;
    local.cwiseAbs().minCoeff(&along);
    V3 corner = local.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; }).cwiseProduct(box.half);
    corner[along] = 0;
    direction = box.half[along] * box.placement.rotation.col(along);
    return box.placement * corner;
  };
  V3 u, v;
  const V3 p = edge(a, -axis.n, u), q = edge(b, axis.n, v);
  const auto [s, t] = closest_on_segments(p, u, q, v);
  return {(p + s * u + q + t * v) / 2, axis.n, axis.separation};
}

}  // namespace

std::vector<ShapeContact> box_box(const PlacedBox& a, const PlacedBox& b, double margin) {
  const Separation axis = best_axis(a, b);
  if (axis.separation > margin) return {};
  if (axis.kind == 2) return {edge_edge(a, b, axis)};
  if (axis.kind == 1) {
    const Face reference = face_along(b, axis.n);
    return face_face(reference, face_along(a, -reference.normal), 1, margin);
  }
  const Face reference = face_along(a, -axis.n);
  return face_face(reference, face_along(b, -reference.normal), -1, margin);
}

ShapeContact sphere_box(const Vector3<double>& centre, double radius, const PlacedBox& box) {
  const V3 local = box.placement.inverse() * centre;
  V3 nearest = local.cwiseMax(-box.half).cwiseMin(box.half), normal = local - nearest;
  double distance = normal.norm();
  if (distance > 0) {
    normal /= distance;
  } else {  // centre inside: out through the nearest face
    int k = 0;
    const V3 depth = box.half - local.cwiseAbs();
    distance = -depth.minCoeff(&k);
    normal = V3::Unit(k) * (local[k] < 0 ? -1 : 1);
    nearest[k] = normal[k] * box.half[k];
  }
  const double gap = distance - radius;
  return {box.placement * V3(nearest + gap / 2 * normal), box.placement.rotation * normal, gap};
}

}  // namespace delassus
