#include "bench/page/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace delassus::bench {

namespace {

constexpr int sides = 28;  // of the polygon that stands for a circle

double cross(const Point& o, const Point& a, const Point& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

/// The circle of radius r about the world point c, spanned by the unit vectors u and v.
void add_circle(std::vector<Point>& out, const Camera& camera, const Vector3<double>& c, const Vector3<double>& u,
                const Vector3<double>& v, double r) {
  for (int i = 0; i < sides; ++i) {
    const double t = 2 * std::numbers::pi * i / sides;
    out.push_back(camera(c + r * (std::cos(t) * u + std::sin(t) * v)));
  }
}

std::vector<Patch> box_patches(const Vector3<double>& half, const Pose<double>& pose, const Camera& camera) {
  std::vector<Patch> out;
  for (int k = 0; k < 3; ++k) {
    const Vector3<double> axis = pose.rotation.col(k);
    const double side = axis.dot(camera.towards) >= 0 ? 1 : -1;  // of the two faces across k, the visible one
    const Vector3<double> c = pose.translation + side * half[k] * axis;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Vector3<double> u = half[i] * pose.rotation.col(i), v = half[j] * pose.rotation.col(j);
    const int tone = std::fabs(axis.z()) > 0.7 ? 0 : std::fabs(axis.dot(camera.right)) < 0.7 ? 1 : 2;
    out.push_back({{camera(c + u + v), camera(c + u - v), camera(c - u - v), camera(c - u + v)}, tone});
  }
  return out;
}

std::vector<Patch> cylinder_patches(double r, double half, const Pose<double>& pose, const Camera& camera) {
  const Vector3<double> u = pose.rotation.col(0), v = pose.rotation.col(1), axis = pose.rotation.col(2);
  const double side = axis.dot(camera.towards) >= 0 ? 1 : -1;
  std::vector<Point> near, all;
  add_circle(near, camera, pose.translation + side * half * axis, u, v, r);
  all = near;
  add_circle(all, camera, pose.translation - side * half * axis, u, v, r);
  return {{convex_hull(all), 2}, {near, 0}};
}

}  // namespace

Camera Camera::from(double azimuth, double elevation) {
  const double ca = std::cos(azimuth), sa = std::sin(azimuth), ce = std::cos(elevation), se = std::sin(elevation);
  return {{-sa, ca, 0}, {-se * ca, -se * sa, ce}, {ce * ca, ce * sa, se}};
}

Outline convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  const auto half = [](auto begin, auto end) {
    Outline chain;
    for (auto p = begin; p != end; ++p) {
      while (chain.size() > 1 && cross(chain[chain.size() - 2], chain.back(), *p) <= 0) chain.pop_back();
      chain.push_back(*p);
    }
    return chain;
  };
  Outline lower = half(points.begin(), points.end());
  const Outline upper = half(points.rbegin(), points.rend());
  if (upper.size() > 2) lower.insert(lower.end(), upper.begin() + 1, upper.end() - 1);
  return lower;
}

std::vector<Patch> patches(const Shape& shape, const Pose<double>& pose, const Camera& camera) {
  const Vector3<double> axis = pose.rotation.col(2);
  std::vector<Point> points;
  switch (shape.kind) {
    case Shape::Kind::box: return box_patches(shape.size, pose, camera);
    case Shape::Kind::cylinder: return cylinder_patches(shape.size[0], shape.size[1], pose, camera);
    case Shape::Kind::capsule:
      for (const double side : {-1.0, 1.0})
        add_circle(points, camera, pose.translation + side * shape.size[1] * axis, camera.right, camera.up, shape.size[0]);
      return {{convex_hull(points), 2}};
    case Shape::Kind::hull:
      for (const Vector3<double>& p : *shape.points) points.push_back(camera(pose * p));
      return {{convex_hull(points), 2}};
    case Shape::Kind::sphere:
      add_circle(points, camera, pose.translation, camera.right, camera.up, shape.size[0]);
      return {{points, 2}};
  }
  return {};
}

}  // namespace delassus::bench
