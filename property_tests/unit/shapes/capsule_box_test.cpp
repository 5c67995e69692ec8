// A capsule and a box: where it rests on edges, the depth by brute force however deep, and what rounding must not decide.
#include <gtest/gtest.h>

#include "models/shapes/capsule_box.h"
#include "property_tests/unit/shapes/contact_pairs.h"

namespace delassus::capsule_box_test {
namespace {

using namespace contact_test;

constexpr double radius = 0.05;

std::vector<ShapeContact> on_beam(const V3& centre, const V3& half_axis) {  // a beam along y, 0.2 m wide, its top at z = 0
  return capsule_box(centre, half_axis, radius, {V3(0.1, 1, 0.1), {Matrix3<double>::Identity(), V3(0, 0, -0.1)}}, margin);
}

TEST(CapsuleBox, RestsOnBothEdgesOfABeamWithBothEndsBesideIt) {
  const auto found = on_beam(V3(0.02, 0, radius - 1e-4), V3(0.5, 0, 0));
  ASSERT_EQ(found.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(found[k].point[0], k == 0 ? -0.1 : 0.1, 30 * eps);
    EXPECT_NEAR(found[k].gap, -1e-4, 30 * eps);
    EXPECT_NEAR(found[k].normal[2], 1, 30 * eps);
  }
}

TEST(CapsuleBox, RestsOnOneEndAndOneEdgeWhereItReachesBeyond) {
  const auto found = on_beam(V3(0.5, 0, radius), V3(0.5, 0, 0));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].point[0], 0, 30 * eps);
  EXPECT_NEAR(found[1].point[0], 0.1, 30 * eps);
}

TEST(CapsuleBox, LiesOnAFaceWithBothEnds) {
  const auto found = on_beam(V3(0, 0, radius), V3(0, 0.5, 0));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].point[1], -0.5, 30 * eps);
  EXPECT_NEAR(found[1].point[1], 0.5, 30 * eps);
}

TEST(CapsuleBox, CrossesAnEdgeAtOnePoint) {  // at 45° over the edge x = 0.1, z = 0
  const double lift = (radius - 1e-4) / std::sqrt(2.0);
  const auto found = on_beam(V3(0.1 + lift, 0, lift), V3(0.4, 0.1, -0.4));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, -1e-4, 30 * eps);
  EXPECT_NEAR((found[0].normal - V3(1, 0, 1).normalized()).norm(), 0, 30 * eps);
}

TEST(CapsuleBox, StandsOnOneEnd) { EXPECT_EQ(on_beam(V3(0, 0, 0.5 + radius), V3(0, 0, 0.5)).size(), 1u); }

TEST(CapsuleBox, NothingWhereItPassesBeside) { EXPECT_TRUE(on_beam(V3(0, 0, radius + 2 * margin), V3(0.5, 0.1, 0)).empty()); }

// Deep ones, too, where the axis goes through the box: the signed distance of 10⁴ points of the axis, least of which the contacts have.
TEST(CapsuleBox, NoPointOfTheAxisIsDeeperThanTheContacts) {
  const int points = 10000;
  int through = 0, several = 0;
  for (unsigned seed = 1; seed <= 500; ++seed) {
    Random r(seed);
    Shape box;
    box.kind = Kind::box;
    box.size = V3(r.number(0.05, 0.4), r.number(0.05, 0.4), r.number(0.05, 0.4));
    box.placement = {r.rotation(), r.vector()};
    const V3 h = 0.6 * (seed % 5 == 0 ? V3(box.placement.rotation.col(seed / 5 % 3)) : r.unit());
    const V3 c = box.placement.translation + 0.3 * r.vector();
    const auto found = capsule_box(c, h, radius, {box.size, box.placement}, margin);
    double least = 1e9;
    for (int k = 0; k <= points; ++k) least = std::min(least, distance(box, c + (2.0 * k / points - 1) * h) - radius);
    through += least < -radius;
    several += found.size() > 1;
    if (least > margin) {
      EXPECT_TRUE(found.empty() || found[0].gap > margin - h.norm() / points) << seed;  // it may be between two points
      continue;
    }
    ASSERT_FALSE(found.empty()) << seed;
    ASSERT_LE(found.size(), 4u) << seed;
    double deepest = 1e9;
    for (const ShapeContact& x : found) {
      deepest = std::min(deepest, x.gap);
      EXPECT_LE(x.gap, margin) << seed;
    }
    // Distances change by no more than the way: two points of the brute force are 2 |h| / 10⁴ apart. A millionth of the axis is one depth.
    EXPECT_LE(deepest, least + 1e-6 * h.norm()) << seed;
    EXPECT_GE(deepest, least - h.norm() / points) << seed;
  }
  EXPECT_GT(through, 50);
  EXPECT_GT(several, 50);
}

// Rounding decides nothing: flat on a face, moved by last bits, the same points.
TEST(CapsuleBox, FlatOnAFaceItKeepsItsPointsUnderRounding) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Random r(seed);
    const double tilt = r.number(-1, 1) * 1e-9;
    const auto found = on_beam(V3(0.01, 0, radius - 1e-5 + r.number(-1, 1) * 1e-12), V3(0.5, r.number(-1, 1) * 1e-9, tilt));
    ASSERT_EQ(found.size(), 2u) << seed;
    EXPECT_NEAR(found[0].point[0], -0.1, 1e-6);
    EXPECT_NEAR(found[1].point[0], 0.1, 1e-6);
  }
}

}  // namespace
}  // namespace delassus::capsule_box_test
