// Parallel projection of a scene onto paper, and the outlines of collision primitives in it.
#pragma once

#include <vector>

#include "algorithms/mechanism/model.h"

namespace delassus::bench {

using Point = Eigen::Vector2d;   ///< on paper [m], y downwards
using Outline = std::vector<Point>;

/// Orthographic view: `right` and `up` span the paper, `towards` points from the scene to the eye. World axes.
struct Camera {
  Vector3<double> right, up, towards;

  /// Seen from the side of `azimuth` [rad] about z (0: from +x) and `elevation` [rad] above the horizon.
  static Camera from(double azimuth, double elevation);
  [[nodiscard]] Point operator()(const Vector3<double>& p) const { return {right.dot(p), -up.dot(p)}; }
  [[nodiscard]] double nearness(const Vector3<double>& p) const { return towards.dot(p); }
};

/// One visible patch of a primitive. tone 0: faces upwards, 1: to the side, 2: to the other side or round.
struct Patch {
  Outline outline;
  int tone = 2;
};

/// The patches of a shape at the pose X_ws of its frame in the world, far ones first.
[[nodiscard]] std::vector<Patch> patches(const Shape& shape, const Pose<double>& pose, const Camera& camera);

/// Convex hull, counter-clockwise on paper with y downwards.
[[nodiscard]] Outline convex_hull(std::vector<Point> points);

}  // namespace delassus::bench
