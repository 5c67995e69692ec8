// Closest points of segments: the conditions of the least distance, which is convex, hold.
#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Geometry>

#include "models/shapes/segments.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::segments_test {
namespace {

using V3 = Vector3<double>;
using unit::Random;
constexpr double eps = 0x1p-53;

/// How far the slope of the distance along a parameter in [−1, 1] is from that of a least one: 0 within, outwards falling at the ends.
double defect(double parameter, double slope) { return parameter >= 1 ? std::max(0.0, slope) : parameter <= -1 ? std::max(0.0, -slope) : std::abs(slope); }

// For s the last line of the function says it to rounding; t is off by what s has lost, the rounding of the lines' closest points: over the sine twice.
void expect_closest(const V3& p, const V3& u, const V3& q, const V3& v, const std::string& what) {
  const auto [s, t] = closest_on_segments(p, u, q, v);
  ASSERT_TRUE(std::abs(s) <= 1 && std::abs(t) <= 1) << what;
  const V3 r = (q - p) + t * v - s * u;
  const double size = (q - p).norm() + u.norm() + v.norm(), sine = u.cross(v).norm() / (u.norm() * v.norm());
  EXPECT_LE(defect(s, -r.dot(u)), 30 * eps * size * u.norm()) << what;
  EXPECT_LE(defect(t, r.dot(v)), 30 * eps * size * v.norm() / (sine > 1e-9 ? sine * sine : 1)) << what;
}

TEST(Segments, are_closest) {
  int inside = 0;
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    Random r(seed);
    const V3 p = r.vector(), q = r.vector(), u = std::pow(10, r.number(-3, 1)) * r.vector(), v = std::pow(10, r.number(-3, 1)) * r.vector();
    expect_closest(p, u, q, v, std::to_string(seed));
    const auto [s, t] = closest_on_segments(p, u, q, v);
    inside += std::abs(s) < 1 && std::abs(t) < 1;
    const auto [s2, t2] = closest_on_segments(q, v, p, u);
    const double there = (q + s2 * v - p - t2 * u).norm(), here = (p + s * u - q - t * v).norm();
    EXPECT_NEAR(there, here, 30 * eps * (p.norm() + q.norm() + u.norm() + v.norm())) << seed;
  }
  EXPECT_GT(inside, 50);
}

// Crossing nearly parallel, down to angles of 1e-8: the lines meet at (s, t) = (0.5, −0.25), and so says the function, to rounding over the angle.
TEST(Segments, cross_at_small_angles) {
  for (const double angle : {1.0, 1e-2, 1e-5, 1e-8}) {
    const V3 u(1, 0, 0), v(std::cos(angle), std::sin(angle), 0), p(0, 0, 0), q = 0.5 * u + 0.25 * v + V3(0, 0, 1);
    const auto [s, t] = closest_on_segments(p, u, q, v);
    EXPECT_NEAR(s, 0.5, 30 * eps / angle) << angle;
    EXPECT_NEAR(t, -0.25, 30 * eps / angle) << angle;
  }
}

TEST(Segments, parallel_ones_and_points) {
  using Pair = std::pair<double, double>;
  const V3 u(1, 0, 0), none(0, 0, 0), up(0, 0, 1);
  EXPECT_EQ(closest_on_segments(none, u, up, u), Pair(0, 0));
  EXPECT_EQ(closest_on_segments(none, u, up + 3 * u, u), Pair(1, -1));
  EXPECT_EQ(closest_on_segments(none, u, up + 1.5 * u, u), Pair(0.5, -1)) << "the end of the second, above the first";
  EXPECT_EQ(closest_on_segments(none, u, up + 0.5 * u, none), Pair(0.5, 0));
  EXPECT_EQ(closest_on_segments(none, none, up - 3 * u, u), Pair(0, 1));
  EXPECT_EQ(closest_on_segments(none, none, up, none), Pair(0, 0));
}

}  // namespace
}  // namespace delassus::segments_test
