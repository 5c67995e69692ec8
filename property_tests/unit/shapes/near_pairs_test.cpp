// The broad phase: all pairs and no others, at a cost that grows with their number, however the balls are spread.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "models/shapes/near_pairs.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::near_pairs_test {
namespace {

using V3 = Vector3<double>;
using unit::Random;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

Pairs all_pairs(const std::vector<Ball>& b) {
  Pairs out;
  for (std::size_t i = 0; i < b.size(); ++i)
    for (std::size_t j = i + 1; j < b.size(); ++j)
      if (b[i].object != b[j].object && !(b[i].rests && b[j].rests) &&
          (b[i].centre - b[j].centre).norm() <= b[i].radius + b[j].radius + std::max(b[i].margin, b[j].margin))
        out.emplace_back(i, j);
  return out;
}

// Sizes over five decades, margins of their own, some at rest, some of one object, some so far away that cells run out of numbers,
// some without numbers; in every fourth seed few enough to be held against each other.
TEST(NearPairs, are_those_of_brute_force) {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random r(seed);
    std::vector<Ball> balls;
    const Index count = seed % 4 == 0 ? 5 + seed / 2 : 150;
    for (Index i = 0; i < count; ++i) {
      const double radius = seed % 3 == 0 ? 0.1 : std::pow(10, r.number(-4, 1)) * (i % 10 == 0 ? 0 : 1);
      const double far = seed % 7 == 0 ? 1e19 : 0;
      balls.push_back({V3(r.number(-2, 2) + far, r.number(-2, 2), r.number(-2, 2)), radius, seed % 2 ? 1e-3 : r.number(0, 0.3), i / 3, i % 4 == 0});
    }
    if (seed % 5 == 0) {
      balls[3].margin = std::numeric_limits<double>::infinity();
      balls[7].margin = std::numeric_limits<double>::infinity(), balls[7].centre[1] = 1e300;
      balls[9].centre[2] = std::numeric_limits<double>::quiet_NaN();
      balls[11].centre[0] = std::numeric_limits<double>::infinity();
    }
    const Pairs found = near_pairs(balls), expected = all_pairs(balls);
    EXPECT_EQ(found, expected) << seed;
    total += found.size();
  }
  EXPECT_GT(total, 1000u);
}

// Balls that just touch, across the borders of cells.
TEST(NearPairs, touching_balls_are_near) {
  for (const double d : {0.125, 0.1, 1.0 / 3, 1.0}) {
    std::vector<Ball> balls;
    for (Index i = 0; i < 200; ++i) balls.push_back({V3(static_cast<double>(i) * d - 7, 0.3, -0.2), d / 2, 1e-9, i, false});
    const Pairs found = near_pairs(balls);
    EXPECT_EQ(found, all_pairs(balls)) << d;
    EXPECT_EQ(found.size(), 199u) << d;
  }
}

TEST(NearPairs, nothing_is_looked_at_where_all_is_one_object) {
  std::vector<Ball> balls(50, Ball{V3(0, 0, 0), 1, 0, 4, false});
  std::int64_t tested = 0;
  EXPECT_TRUE(near_pairs(balls, &tested).empty());
  EXPECT_EQ(tested, 0);
  balls[49].object = 5;
  EXPECT_EQ(near_pairs(balls, &tested).size(), 49u);
  EXPECT_TRUE(near_pairs({}).empty());
}

// Counted, not timed: pairs looked at per ball do not grow from 10³ to 10⁴ balls, and are few.
TEST(NearPairs, cost_is_near_linear_however_they_are_spread) {
  const auto root = [](Index n, int k) { return static_cast<Index>(std::ceil(std::pow(static_cast<double>(n), 1.0 / k) - 1e-9)); };
  const std::vector<std::pair<std::string, std::function<V3(Index, Index, Random&)>>> spreads{
      {"a row along x", [](Index i, Index, Random&) { return V3(static_cast<double>(i), 0, 0); }},
      {"a tower", [](Index i, Index, Random&) { return V3(0, 0, static_cast<double>(i)); }},
      {"a wall across x", [&](Index i, Index n, Random&) { return V3(0, static_cast<double>(i % root(n, 2)), static_cast<double>(i / root(n, 2))); }},
      {"a heap", [&](Index i, Index n, Random&) {
         const Index m = root(n, 3);
         return V3(static_cast<double>(i % m), static_cast<double>(i / m % m), static_cast<double>(i / m / m));
       }},
      {"at random in a cube", [&](Index, Index n, Random& r) { return V3(std::cbrt(static_cast<double>(n)) * V3(r.number(0, 1), r.number(0, 1), r.number(0, 1))); }},
  };
  for (const auto& [name, place] : spreads) {
    double per_ball[2];
    for (const int k : {0, 1}) {
      const Index n = k == 0 ? 1000 : 10000;
      Random r(3);
      std::vector<Ball> balls{{V3(0, 0, 0), 1e3, 1e-3, -1, true}};  // a floor
      for (Index i = 0; i < n; ++i) balls.push_back({place(i, n, r), 0.5 * r.number(0.4, 1.1), 1e-3, i, false});
      std::int64_t tested = 0;
      const Pairs found = near_pairs(balls, &tested);
      per_ball[k] = static_cast<double>(tested) / static_cast<double>(n);
      EXPECT_GT(found.size(), static_cast<std::size_t>(n / 10)) << name;
    }
    std::printf("%-20s pairs looked at per ball: %.1f of 10^3, %.1f of 10^4\n", name.c_str(), per_ball[0], per_ball[1]);
    EXPECT_LT(per_ball[1], 1.5 * per_ball[0]) << name;
    EXPECT_LT(per_ball[1], 150) << name;
  }
}

}  // namespace
}  // namespace delassus::near_pairs_test
