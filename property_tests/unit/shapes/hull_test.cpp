// Hulls against their definition, and the ground contacts of hulls against brute force.
#include <gtest/gtest.h>

#include <random>

#include <Eigen/Geometry>

#include "models/contacts.h"
#include "models/shapes/hull.h"

namespace delassus::hull_test {
namespace {

constexpr double eps = 0x1p-53;
using V3 = Vector3<double>;
using Points = std::vector<V3>;

double support(const Points& points, const V3& n) {
  double out = -std::numeric_limits<double>::infinity();
  for (const V3& p : points) out = std::max(out, n.dot(p));
  return out;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number() { return normal_(engine_); }
  V3 vector() { return {number(), number(), number()}; }
  Matrix3<double> rotation() { return Eigen::Quaterniond(number(), number(), number(), number()).normalized().toRotationMatrix(); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

Points cube_corners(const V3& half) {
  Points out;
  for (int k = 0; k < 8; ++k) out.emplace_back(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
  return out;
}

#define NEEDS_QHULL \
  if (!has_hulls()) GTEST_SKIP() << "built without qhull"

TEST(Hulls, reach_as_far_as_the_points) {
  NEEDS_QHULL;
  Random random(1);
  for (int round = 0; round < 40; ++round) {
    Points points;
    const V3 at = 100 * random.vector();
    const double size = std::pow(10.0, round % 9 - 6);
    for (int i = 0; i < 60; ++i) points.push_back(at + size * random.vector());
    const Hull hull = convex_hull(points, 64);
    EXPECT_EQ(static_cast<Index>(hull.vertices.size()), hull.all);
    EXPECT_EQ(hull.cut, 0);
    for (const V3& v : hull.vertices) EXPECT_EQ(std::count(points.begin(), points.end(), v), 1);
    for (int k = 0; k < 100; ++k) {
      const V3 n = random.vector().normalized();
      EXPECT_LT((support(points, n) - support(hull.vertices, n)) / (eps * (at.norm() + 10 * size)), 30);
    }
  }
}

TEST(Hulls, what_is_cut_is_bounded_and_the_bound_is_reached) {
  NEEDS_QHULL;
  Random random(2);
  for (const Index most : {10, 16, 64}) {
    Points points;
    for (int i = 0; i < 1000; ++i) points.push_back(random.vector().normalized().cwiseProduct(V3(0.3, 0.2, 0.1)));
    const Hull hull = convex_hull(points, most);
    EXPECT_EQ(static_cast<Index>(hull.vertices.size()), most);
    EXPECT_EQ(hull.all, 1000);
    double worst = 0;  // the distance of two convex sets, one in the other, is the largest difference of their supports
    for (int k = 0; k < 20000; ++k) {
      const V3 n = random.vector().normalized();
      worst = std::max(worst, support(points, n) - support(hull.vertices, n));
    }
    EXPECT_LE(worst, hull.cut + 30 * eps);
    EXPECT_GT(worst, 0.8 * hull.cut) << most;
    for (int k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0}) EXPECT_EQ(support(points, side * V3::Unit(k)), support(hull.vertices, side * V3::Unit(k)));
  }
}

TEST(Hulls, of_points_in_a_plane_on_a_line_and_of_one) {
  NEEDS_QHULL;
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const Matrix3<double> R = random.rotation();
    Points square, line;
    for (int i = 0; i <= 4; ++i)
      for (int j = 0; j <= 4; ++j) square.push_back(R * V3(i, j, 0));
    for (int i = 0; i <= 8; ++i) line.push_back(i * R.col(0));
    for (const V3& corner : {V3(0, 0, 0), V3(4, 0, 0), V3(0, 4, 0), V3(4, 4, 0)}) {
      const Points v = convex_hull(square, 64).vertices;
      EXPECT_EQ(std::count(v.begin(), v.end(), V3(R * corner)), 1);
    }
    EXPECT_EQ(convex_hull(line, 64).vertices.size(), 2u);
  }
  EXPECT_EQ(convex_hull({V3(1, 2, 3), V3(1, 2, 3)}, 64).vertices, Points{V3(1, 2, 3)});
  Points circle;
  for (int i = 0; i < 200; ++i) circle.emplace_back(std::cos(0.01 * M_PI * i), std::sin(0.01 * M_PI * i), 1);
  const Hull hull = convex_hull(circle, 32);
  EXPECT_EQ(hull.vertices.size(), 32u);
  EXPECT_GT(hull.cut, 1 - std::cos(M_PI / 32 / 2));  // a regular polygon of 32 corners is the best there is
  EXPECT_LT(hull.cut, 4 * (1 - std::cos(M_PI / 32)));
}

TEST(Hulls, do_not_depend_on_the_order_of_the_points) {
  NEEDS_QHULL;
  Random random(4);
  Points points;
  for (int i = 0; i < 300; ++i) points.push_back(random.vector().normalized());
  const Hull a = convex_hull(points, 20);
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(a.vertices, convex_hull(points, 20).vertices);
}

// Contacts ------------------------------------------------------------------------------------------------------------

Shape hull_shape(const Points& points) {
  V3 low = points[0], high = low;
  for (const V3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return {Shape::Kind::hull, low.cwiseAbs().cwiseMax(high.cwiseAbs()), {}, -1, std::make_shared<const Points>(points)};
}

/// Ground contacts of one free body with this shape.
std::vector<ContactPoint> on_ground(const Shape& shape, const Pose<double>& pose, double margin, double height) {
  Model model;
  Body body;
  body.name = "body", body.joint.name = "base", body.joint.type = JointType::floating;
  body.mass = 1, body.inertia = Matrix3<double>::Identity();
  model.add(body);
  model.bodies[0].shapes = {shape};
  VectorX<double> q(7);
  const Eigen::Quaterniond r(pose.rotation);
  q << pose.translation, r.w(), r.x(), r.y(), r.z();
  Poses<double> at;
  poses(model, q, at);
  ContactSearch search;
  search.margin = margin, search.ground = true, search.ground_height = height, search.object = {0};
  std::vector<std::string> notes;
  std::vector<ContactPoint> out = find_contacts(model, at, search, notes);
  for (ContactPoint& c : out) c.point += at.reference[0];
  return out;
}

TEST(HullContacts, are_vertices_within_the_margin_and_none_is_missed) {
  Random random(5);
  int several = 0;
  for (int round = 0; round < 2000; ++round) {
    Points points;
    for (int i = 0; i < 12; ++i) points.push_back(random.vector().normalized());
    const Pose<double> pose{random.rotation(), random.vector()};
    const double margin = 0.3, height = pose.translation[2] - 1.1;
    const std::vector<ContactPoint> found = on_ground(hull_shape(points), pose, margin, height);
    std::vector<double> gaps;
    for (const V3& p : points) gaps.push_back((pose * p)[2] - height);
    const auto within = std::count_if(gaps.begin(), gaps.end(), [&](double g) { return g <= margin; });
    several += within > 1;
    EXPECT_LE(static_cast<long>(found.size()), std::min<long>(within, 4));
    EXPECT_GE(static_cast<long>(found.size()), std::min<long>(within, 3));
    double deepest = 1e9;
    for (const ContactPoint& c : found) {
      deepest = std::min(deepest, c.gap);
      const bool known = std::any_of(points.begin(), points.end(), [&](const V3& p) {
        const V3 x = pose * p;
        return (x - V3(c.point[0], c.point[1], height + c.gap)).norm() < 30 * eps * 8;
      });
      EXPECT_TRUE(known);
      EXPECT_NEAR(c.point[2], height, 30 * eps * 4);
      EXPECT_EQ(c.normal, V3(0, 0, 1));
      EXPECT_EQ(c.other, ground);
    }
    if (within > 0) {
      EXPECT_NEAR(deepest, *std::min_element(gaps.begin(), gaps.end()), 30 * eps * 8);
    }
  }
  EXPECT_GT(several, 200);
}

/// Of many points, those kept are the farthest from the deepest, from the line through both, and outside of the triangle.
TEST(HullContacts, of_many_keep_those_that_reach_farthest) {
  Random random(6);
  int four = 0;
  for (int round = 0; round < 500; ++round) {
    Points points;
    for (int i = 0; i < 30; ++i) points.emplace_back(random.number(), random.number(), 0.001 * i / 30);  // the first is the lowest
    const V3 shift(random.number(), random.number(), random.number());
    const std::vector<ContactPoint> found = on_ground(hull_shape(points), {Matrix3<double>::Identity(), shift}, 10, 0);
    using P2 = Eigen::Vector2d;
    auto cross = [](const P2& a, const P2& b) { return a[0] * b[1] - a[1] * b[0]; };
    std::vector<P2> all, kept;
    for (const V3& p : points) all.push_back((p - points[0]).head<2>());
    for (const ContactPoint& c : found) kept.push_back((c.point - shift - points[0]).head<2>());
    auto most = [](const std::vector<P2>& of, auto&& f) { double out = 0; for (const P2& p : of) out = std::max(out, f(p)); return out; };
    const double tolerance = 30 * eps * 20;
    EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [&](const P2& p) { return p.norm() < tolerance; }));  // the deepest
    EXPECT_NEAR(most(all, [](const P2& p) { return p.norm(); }), most(kept, [](const P2& p) { return p.norm(); }), tolerance);
    const P2 b = *std::max_element(all.begin(), all.end(), [](const P2& x, const P2& y) { return x.norm() < y.norm(); });
    auto off = [&](const P2& p) { return std::abs(cross(b, p)) / b.norm(); };
    EXPECT_NEAR(most(all, off), most(kept, off), tolerance);
    const P2 c = *std::max_element(all.begin(), all.end(), [&](const P2& x, const P2& y) { return off(x) < off(y); });
    const double side = cross(b, c) > 0 ? 1 : -1;
    auto beyond = [&](const P2& p) {
      return std::max({-side * cross(b, p) / b.norm(), -side * cross(c - b, p - b) / (c - b).norm(), -side * cross(-c, p - c) / c.norm()});
    };
    EXPECT_NEAR(most(all, beyond), most(kept, beyond), tolerance);
    four += found.size() == 4;
  }
  EXPECT_GT(four, 450);
}

TEST(HullContacts, on_an_edge_are_its_two_ends) {
  Points edge;
  for (int i = 0; i < 9; ++i) edge.emplace_back(0.1 * (i < 5 ? i : i - 9), 0, 0);
  const std::vector<ContactPoint> found = on_ground(hull_shape(edge), {Matrix3<double>::Identity(), V3(0, 0, 0)}, 1e-3, 0);
  ASSERT_EQ(found.size(), 3u);  // the first of the deepest, and the ends
  double length = 0;
  for (const ContactPoint& a : found)
    for (const ContactPoint& b : found) length = std::max(length, (a.point - b.point).norm());
  EXPECT_NEAR(length, 0.8, 30 * eps);
}

TEST(HullContacts, do_not_flicker_under_rounding) {
  Points drum;
  for (int i = 0; i < 32; ++i)
    for (const double s : {-0.1, 0.1}) drum.emplace_back(0.2 * std::cos(M_PI * i / 16), 0.2 * std::sin(M_PI * i / 16), s);
  const Shape shape = hull_shape(drum);
  const std::vector<ContactPoint> first = on_ground(shape, {Matrix3<double>::Identity(), V3(0, 0, 0.1)}, 1e-3, 0);
  ASSERT_EQ(first.size(), 4u);
  V3 centre = V3::Zero();
  for (const ContactPoint& c : first) centre += c.point / 4;
  EXPECT_LT(centre.norm(), 0.02);  // the drum rests inside its points
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    const Matrix3<double> R = Eigen::AngleAxisd(1e-14 * random.number(), random.vector().normalized()).toRotationMatrix();
    const std::vector<ContactPoint> again = on_ground(shape, {R, V3(0, 0, 0.1) + 1e-15 * random.vector()}, 1e-3, 0);
    ASSERT_EQ(again.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((again[k].point - first[k].point).norm(), 1e-12);
  }
}

TEST(HullContacts, of_a_cube_are_those_of_a_box) {
  Random random(8);
  int touching = 0;
  const V3 half(0.1, 0.2, 0.3);
  Shape box{Shape::Kind::box, half, {}, -1, {}};
  for (int round = 0; round < 1000; ++round) {
    const Matrix3<double> R = round % 3 == 0 ? Matrix3<double>::Identity() : round % 3 == 1 ? Matrix3<double>(Eigen::AngleAxisd(random.number(), V3::UnitZ())) : random.rotation();
    const double reach = half.dot(R.row(2).transpose().cwiseAbs());
    const Pose<double> pose{R, V3(random.number(), random.number(), reach + 0.002 * random.number())};
    auto sorted = [](std::vector<ContactPoint> c) {
      std::sort(c.begin(), c.end(), [](const auto& x, const auto& y) {
        return std::lexicographical_compare(x.point.data(), x.point.data() + 2, y.point.data(), y.point.data() + 2);
      });
      return c;
    };
    const auto a = sorted(on_ground(box, pose, 1e-3, 0)), b = sorted(on_ground(hull_shape(cube_corners(half)), pose, 1e-3, 0));
    ASSERT_EQ(a.size(), b.size());
    touching += !a.empty();
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(a[k].point == b[k].point && a[k].gap == b[k].gap);
  }
  EXPECT_GT(touching, 300);
}

TEST(ZeroSize, gives_each_point_once) {
  const Pose<double> pose{Matrix3<double>::Identity(), V3(1, 2, 0.5e-3)};
  auto count = [&](Shape::Kind kind, const V3& size) { return on_ground({kind, size, {}, -1, {}}, pose, 1e-3, 0).size(); };
  EXPECT_EQ(count(Shape::Kind::sphere, {0, 0, 0}), 1u);
  EXPECT_EQ(count(Shape::Kind::capsule, {0, 0, 0}), 1u);
  EXPECT_EQ(count(Shape::Kind::capsule, {1e-4, 0, 0}), 1u);
  EXPECT_EQ(count(Shape::Kind::box, {0.1, 0.2, 0}), 4u);
  EXPECT_EQ(count(Shape::Kind::box, {0.1, 0, 0}), 2u);
  EXPECT_EQ(count(Shape::Kind::cylinder, {0.1, 0, 0}), 4u);
  EXPECT_EQ(count(Shape::Kind::cylinder, {0, 1e-4, 0}), 2u);
  for (const double turn : {0.0, M_PI}) {  // a plate thinner than the margin, either side up: its lower corners
    const Pose<double> flat{Eigen::AngleAxisd(turn, V3::UnitX()).toRotationMatrix().array().round(), V3(0, 0, 4e-4)};
    const auto plate = on_ground({Shape::Kind::box, {0.1, 0.2, 1e-4}, {}, -1, {}}, flat, 1e-3, 0);
    ASSERT_EQ(plate.size(), 4u);
    for (const ContactPoint& c : plate) EXPECT_NEAR(c.gap, 3e-4, 30 * eps);
  }
  const auto point = on_ground({Shape::Kind::sphere, {0, 0, 0}, {}, -1, {}}, pose, 1e-3, 0)[0];
  EXPECT_EQ(point.gap, 0.5e-3);
  EXPECT_EQ(point.point, V3(1, 2, 0));
}

}  // namespace
}  // namespace delassus::hull_test
