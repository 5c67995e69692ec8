// Random pairs of shapes a little apart or a little into each other, for the laws of contacts. Independent of models/:
// supports and signed distances of the shapes, gaps of pairs by brute force.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "models/contacts.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::contact_test {

using V3 = Vector3<double>;
using Kind = Shape::Kind;
using unit::Random;

inline constexpr double eps = 0x1p-53, margin = 1e-3;
inline constexpr unsigned pairs = 60;

inline Shape random_shape(Kind kind, Random& r) {
  Shape s;
  s.kind = kind;
  const V3 size(r.number(0.1, 0.2), r.number(0.3, 0.4), r.number(0.5, 0.6));
  s.size = kind == Kind::box ? size : kind == Kind::sphere ? V3(size[0], 0, 0) : V3(size[0], size[1], 0);
  s.placement = {r.rotation(), r.vector()};
  if (kind == Kind::hull) {
    std::vector<V3> points;
    for (int k = 0; k < 12; ++k) points.push_back(size.cwiseProduct(r.unit()));
    s.size.setZero();
    for (const V3& x : points) s.size = s.size.cwiseMax(x.cwiseAbs());
    s.points = std::make_shared<const std::vector<V3>>(points);
  }
  return s;
}

/// max n·x over the shape.
inline double support(const Shape& s, const V3& n) {
  const V3 local = s.placement.rotation.transpose() * n;
  const double along = n.dot(s.placement.translation);
  switch (s.kind) {
    case Kind::sphere: return along + s.size[0] * n.norm();
    case Kind::capsule: return along + s.size[0] * n.norm() + s.size[1] * std::abs(local[2]);
    case Kind::hull: {
      double most = -1e9;
      for (const V3& x : *s.points) most = std::max(most, local.dot(x));
      return along + most;
    }
    case Kind::cylinder: return along + s.size[0] * std::hypot(local[0], local[1]) + s.size[1] * std::abs(local[2]);
    default: return along + s.size.dot(local.cwiseAbs());
  }
}

/// Signed distance of a point from the surface, negative inside.
inline double distance(const Shape& s, const V3& x) {
  const V3 p = (s.placement.rotation.transpose() * (x - s.placement.translation)).cwiseAbs();
  if (s.kind == Kind::box) return (p - s.size).cwiseMax(0).norm() + std::min((p - s.size).maxCoeff(), 0.0);
  const double along = s.kind == Kind::capsule ? std::max(p[2] - s.size[1], 0.0) : p[2];
  return std::hypot(p[0], p[1], along) - s.size[0];
}

inline double separation(const Shape& a, const Shape& b, const V3& n) { return -support(a, -n) - support(b, n); }

/// Least distance of two segments p ± u, q ± v: inside both, or with an end of one of them.
inline double segments(const V3& p, const V3& u, const V3& q, const V3& v) {
  auto to = [](const V3& x, const V3& c, const V3& w) {
    const double t = w.squaredNorm() > 0 ? std::clamp((x - c).dot(w) / w.squaredNorm(), -1.0, 1.0) : 0;
    return (x - c - t * w).norm();
  };
  double least = std::min({to(p + u, q, v), to(p - u, q, v), to(q + v, p, u), to(q - v, p, u)});
  const V3 n = u.cross(v);
  if (n.norm() == 0) return least;
  Matrix3<double> system;
  system << u, -v, n;
  const V3 x = system.inverse() * (q - p);
  return std::abs(x[0]) <= 1 && std::abs(x[1]) <= 1 ? std::min(least, std::abs(x[2]) * n.norm()) : least;
}

/// The gap of a pair: largest separation over the fifteen axes of boxes, distances of axes and centres for round shapes.
inline double gap_of(const Shape& a, const Shape& b) {
  const bool boxes[] = {a.kind == Kind::box, b.kind == Kind::box};
  const auto axis = [](const Shape& s) { return s.kind == Kind::capsule ? V3(s.size[1] * s.placement.rotation.col(2)) : V3(0, 0, 0); };
  if (!boxes[0] && !boxes[1]) return segments(a.placement.translation, axis(a), b.placement.translation, axis(b)) - a.size[0] - b.size[0];
  if (!boxes[0] || !boxes[1]) {
    const Shape &box = boxes[0] ? a : b, &round = boxes[0] ? b : a;
    const auto at = [&](double s) { return distance(box, round.placement.translation + s * axis(round)); };
    double low = -1, high = 1;  // the signed distance is convex along the axis: thirds
    for (int k = 0; k < 90; ++k) {
      const double third = (high - low) / 3;
      if (at(low + third) < at(high - third)) high -= third;
      else low += third;
    }
    return std::min({at(-1), at((low + high) / 2), at(1)}) - round.size[0];
  }
  double largest = -1e9;
  const auto consider = [&](const V3& n) {
    if (n.norm() > 1e-3) largest = std::max({largest, separation(a, b, n.normalized()), separation(a, b, -n.normalized())});
  };
  for (Index i = 0; i < 3; ++i) {
    consider(a.placement.rotation.col(i)), consider(b.placement.rotation.col(i));
    for (Index j = 0; j < 3; ++j) consider(a.placement.rotation.col(i).cross(b.placement.rotation.col(j)));
  }
  return largest;
}

/// Two bodies, each with one shape off its frame; body i is object i.
struct Pair {
  Model model;
  VectorX<double> q;
  Shape a, b;
  double size = 0;    // lengths that enter a place
  double spread = 1;  // least sine between edges that are not parallel: points where edges cross are worse by its square
};

inline Pair pair_of(const Shape& a, const Shape& b, Random& r) {
  Pair p{{}, VectorX<double>::Zero(14), a, b};
  for (const Shape* s : {&a, &b}) {
    Body body;
    body.name = s == &a ? "a" : "b";
    body.mass = 1, body.com = r.vector(), body.inertia.setIdentity();
    body.joint.type = JointType::floating;
    body.shapes = {*s};
    body.shapes[0].placement = {r.rotation(), r.vector()};
    const Pose<double> X = s->placement * body.shapes[0].placement.inverse();
    const Eigen::Quaterniond turn(X.rotation);
    p.q.segment<7>(7 * static_cast<Index>(p.model.bodies.size())) << X.translation, turn.w(), turn.x(), turn.y(), turn.z();
    p.size += 2 + X.translation.norm() + body.com.norm() + s->placement.translation.norm() + s->size.norm();
    p.model.add(body);
  }
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) {
      const double sine = a.placement.rotation.col(i).cross(b.placement.rotation.col(j)).norm();
      if (sine > 1e-3) p.spread = std::min(p.spread, sine);
    }
  return p;
}

struct Found {
  std::vector<ContactPoint> contacts;  // points in the world
  std::vector<std::string> notes;
};

inline Found find(const Pair& p, ContactSearch search = {}) {
  Poses<double> at;
  poses(p.model, p.q, at);
  search.object = {0, 1};
  if (search.margin == ContactSearch{}.margin) search.margin = margin;
  Found out;
  out.contacts = find_contacts(p.model, at, search, out.notes);
  for (ContactPoint& c : out.contacts) c.point += at.reference[static_cast<std::size_t>(c.body)];
  return out;
}

inline Shape shifted(Shape s, const V3& by) {
  s.placement.translation += by;
  return s;
}

/// a against b at this gap along a random direction.
inline Shape brought_to(const Shape& a, const Shape& b, const V3& direction, double gap) {
  const Shape centred = shifted(a, b.placement.translation - a.placement.translation);
  double high = 5;
  while (high > 0 && gap_of(shifted(centred, high * direction), b) > gap) high -= 0.01;  // a capsule may stick out on both sides
  double low = high;
  high += 0.01;
  for (int k = 0; k < 80; ++k) {
    const double middle = (low + high) / 2;
    (gap_of(shifted(centred, middle * direction), b) < gap ? low : high) = middle;
  }
  return shifted(centred, high * direction);
}

inline constexpr Kind kinds[] = {Kind::sphere, Kind::box, Kind::capsule};

inline void for_each_pair(const std::function<void(const Pair&, double gap, Random&, const std::string& what)>& law) {
  for (const Kind first : kinds)
    for (const Kind second : kinds)
      for (unsigned seed = 1; seed <= pairs; ++seed) {
        Random r(seed);
        const Shape b = random_shape(second, r);
        Shape a = random_shape(first, r);
        if (seed % 4 == 0) {  // faces and axes that rest on each other
          a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(r.number(0.2, 0.6), V3::Unit(seed / 4 % 3)).toRotationMatrix();
        }
        const double gap = seed % 3 == 0 ? r.number(0.1, 0.9) * margin : -r.number(0.1, 2) * margin;
        const V3 direction = seed % 4 == 0 ? V3(b.placement.rotation * (V3::Unit(seed / 4 % 3) + 0.2 * r.vector()).normalized()) : r.unit();
        law(pair_of(brought_to(a, b, direction, gap), b, r), gap, r,
            "kinds " + std::to_string(static_cast<int>(first)) + " and " + std::to_string(static_cast<int>(second)) + ", seed " + std::to_string(seed));
        if (testing::Test::HasFailure()) return;
      }
}

inline bool small(double error, double bound) { return unit::ratio(error, bound) < 30; }

}  // namespace delassus::contact_test
