// What stands in the world: links that are fixed to it and fixed boxes are touched like the ground.
#include <gtest/gtest.h>

#include <set>

#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_standing_test {
namespace {

using namespace stepping;

/// A box of 0.25 m that stands on z = 0 of the plane or of a fixed box, and is thrown along it.
Scene thrown(const std::string& on, const V3& at = {0, 0, 0}) {
  const auto place = [&](double x, double y, double z) { return "[" + std::to_string(at[0] + x) + ", " + std::to_string(at[1] + y) + ", " + std::to_string(at[2] + z) + "]"; };
  return read("gravity: [0, 0, -9.81]\nboxes:\n  - {name: box, mass: 2, size: [0.25, 0.25, 0.25], pose: {xyz: " + place(0.125, 0.25, 0.125) +
              "}, velocity: {linear: [1, 0.5, 0]}, friction: 0.5}\n" +
              (on == "plane" ? "ground: {z: 0, friction: 0.5}\n" : "  - {name: table, fixed: true, size: [8, 8, 1], friction: 0.5, pose: {xyz: " + place(0, 0, -0.5) + "}}\n") +
              "contacts: {detect: true, damping: 1.0e-4}\n");
}

// The largest difference of velocities over 400 steps: the box slides, stops and stands. Either is off from the exact step by what the
// solver leaves, 1e-10 m/s of every row; a step passes on what differs, friction takes it away.
TEST(Standing, a_box_on_a_fixed_box_moves_as_on_the_plane) {
  Settings settings = step_of(1e-3);
  settings.residual = 1e-12;
  Simulation<double> plane(thrown("plane"), settings), table(thrown("table"), settings);
  ASSERT_EQ(table.state().nu.size(), 6);
  double off = 0;
  Index rows = 0;
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(plane.step().ok() && table.step().ok()) << k << plane.last().message << table.last().message;
    off = std::max(off, (plane.state().nu - table.state().nu).cwiseAbs().maxCoeff());
    EXPECT_EQ(plane.last().rows, table.last().rows) << k;
    rows += table.last().rows;
  }
  EXPECT_EQ(rows, 400 * 12);
  EXPECT_LT(off, 400 * 1e-12);
  EXPECT_LT(table.state().nu.norm(), 1e-9);
  EXPECT_GT(table.state().q[0], 0.2);
}

// Coordinates with few bits, far away: nothing is rounded that was not.
TEST(Standing, bits_do_not_depend_on_where) {
  const V3 far(0x1p18, -0x1p16, 0x1p17);
  Simulation<double> here(thrown("table"), step_of(0x1p-10)), there(thrown("table", far), step_of(0x1p-10));
  ASSERT_TRUE(here.step().ok() && there.step().ok());
  EXPECT_GT(here.last().rows, 0);
  EXPECT_EQ(here.state().nu, there.state().nu);
}

TEST(Standing, the_coefficient_is_that_of_the_shapes_not_of_the_ground) {
  for (const double own : {0.2, 0.7}) {
    Scene s = thrown("table");
    s.has_ground = true, s.ground_friction = 0.9, s.ground_height = -10, s.motion.search.ground = true, s.motion.search.ground_height = -10;
    for (Standing& x : s.motion.search.standing) x.shape.friction = own;
    Simulation<double> run(s, step_of(1e-3));
    ASSERT_TRUE(run.step().ok());
    ASSERT_EQ(run.rows().size(), 4u);
    for (const auto& r : run.rows()) EXPECT_EQ(r.friction, std::min(0.5, own));
  }
}

/// A bench of two blocks under a table top, both fixed, and two boxes on it: one across the gap of the blocks.
Scene bench() {
  return read("gravity: [0, 0, -9.81]\nground: {z: -1, friction: 0.5}\nboxes:\n  - {name: across, mass: 2, size: [1, 0.25, 0.25], pose: {xyz: [0, 0, 0.125]}}\n"
              "  - {name: upon, mass: 1, size: [0.25, 0.25, 0.25], pose: {xyz: [0, 0, 0.375]}}\n  - {name: on_both, mass: 1, size: [0.25, 0.25, 0.25], pose: {xyz: [0.625, 0, -0.875]}}\n"
              "  - {name: left, fixed: true, mass: 0, size: [0.5, 1, 1], pose: {xyz: [-0.5, 0, -0.5]}}\n  - {name: right, fixed: true, size: [0.5, 1, 1], pose: {xyz: [0.25, 0, -0.5]}}\n"
              "contacts: {detect: true, friction: 0.5}\nsleeping: {linear: 0.01, angular: 0.01, after: 0.005}\n");
}

// Bodies that touch several things at once: no two rows are taken for one, and the next step knows all of them.
TEST(Standing, every_contact_has_an_identity_of_its_own) {
  Simulation<double> s(bench(), step_of(1e-3));
  ASSERT_TRUE(s.step().ok()) << s.last().message;
  std::set<Identity> all;
  for (const auto& r : s.rows()) EXPECT_TRUE(all.insert(r.identity).second) << r.body << " " << r.other;
  EXPECT_EQ(all.size(), 4u + 4u + 4u + 4u + 4u) << "across on left and right, upon on across, on_both on the plane and beside right";
  EXPECT_EQ(s.state().impulses.size(), all.size());
}

TEST(Standing, who_stands_on_it_falls_asleep) {
  Simulation<double> s(bench(), step_of(1e-3));
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(s.step().ok()) << s.last().message;
  EXPECT_NE(s.last().path, "asleep");
  const State<double> before = s.state();
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(s.step().ok());
  EXPECT_EQ(s.last().path, "asleep");
  EXPECT_LT((s.state().q - before.q).norm(), 1e-9);
}

}  // namespace
}  // namespace delassus::stepping_standing_test
