// Assembly of scenes against solutions made otherwise: four-bars in closed form, Newton in Quad on equations written
// here, gaps of known size. Seeded defects that these tests were seen to fail on are named at each.
#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/kinematics.h"
#include "property_tests/unit/mechanism/four_bars.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::loop_closing_test {
namespace {

using namespace four_bars;
using unit::ratio;

/// Coupler and rocker angles for a crank angle: the crossing of two circles above the ground.
void solve_four_bar(double crank, double& j2, double& j3) {
  const double x = 0.3 * std::cos(crank), z = 0.3 * std::sin(crank), dx = 1 - x, dz = -z;
  const double d = std::hypot(dx, dz), along = (0.8 * 0.8 - 0.6 * 0.6 + d * d) / (2 * d), up = std::sqrt(0.8 * 0.8 - along * along);
  const double px = x + (along * dx - up * dz) / d, pz = z + (along * dz + up * dx) / d;
  j2 = std::atan2(pz - z, px - x) - crank;
  j3 = std::atan2(pz, px - 1);
}

/// Gap of the pin of the four-bar, from sines and cosines alone.
double pin_gap(double j1, double j2, double j3) {
  return std::hypot(0.3 * std::cos(j1) + 0.8 * std::cos(j1 + j2) - 1 - 0.6 * std::cos(j3), 0.3 * std::sin(j1) + 0.8 * std::sin(j1 + j2) - 0.6 * std::sin(j3));
}

/// Answers of the closed form to rounding: κ of the pin's two equations is below 10 at these poses.
void expect_closed_form(const Scene& s) {
  double j2 = 0, j3 = 0;
  solve_four_bar(s.q[0], j2, j3);
  EXPECT_LT(ratio(s.q[1] - j2, 10), 30);
  EXPECT_LT(ratio(s.q[2] - j3, 10), 30);
}

// Fails when the columns of held joints are kept among the unknowns.
TEST(Assembly, a_locked_or_held_driver_stays) {
  const std::string urdf = four_bar("driver.urdf"), pose = "j1: 1.0, j2: -0.5, j3: 1.7";
  for (const std::string& loop : {point_loop, hinge_loop}) {
    for (const Scene& s : {scene_of(urdf, pose, loop + "  - {kind: joint_lock, joint: r/j1}\n"), scene_of(urdf, pose, loop, "hold: [r/j1]\n")}) {
      EXPECT_EQ(s.q[0], 1.0);
      expect_closed_form(s);
      EXPECT_EQ(s.q[3], 0);
      EXPECT_TRUE(has_note(s, "closing the loops changed given values: r/j2 by 0.0"));
      EXPECT_FALSE(has_note(s, "r/j1"));
    }
    const Scene free = scene_of(urdf, pose, loop);
    EXPECT_NE(free.q[0], 1.0);
    expect_closed_form(free);
    EXPECT_TRUE(has_note(free, "r/j1 by 0.0"));
    EXPECT_TRUE(free.warnings.empty());
  }
}

TEST(Assembly, what_moved_is_told_to_the_joint) {
  const std::string urdf = four_bar("moves.urdf");
  const Scene s = scene_of(urdf, "j1: 1.0, j2: -0.5, j3: 1.7", point_loop, "hold: [r/j1]\n");
  ASSERT_EQ(s.assembly.moves.size(), 2u);
  EXPECT_EQ(s.model.bodies[static_cast<std::size_t>(s.assembly.moves[0].body)].joint.name, "r/j2");
  EXPECT_EQ(s.assembly.moves[0].turned, std::fabs(s.q[1] + 0.5));
  EXPECT_EQ(s.assembly.moves[0].shifted, 0);
  const Scene closed = scene_of(urdf, "j1: 1.0, j2: -0.5652460210629805, j3: 1.7591248752996058", point_loop);
  EXPECT_TRUE(closed.assembly.moves.empty());
  EXPECT_FALSE(has_note(closed, "changed given values"));
}

/// j1 and j3 of mimloop2: the pin's two equations with j2 = −0.6 j1 + 0.02, by Newton in Quad.
void solve_coupled(Quad& j1, Quad& j3) {
  for (int k = 0; k < 30; ++k) {
    const Quad c = Quad(0.4) * j1 + Quad(0.02);  // j1 + j2
    const Quad fx = Quad(0.3) * cos(j1) + Quad(0.8) * cos(c) - Quad(1) - Quad(0.6) * cos(j3);
    const Quad fz = Quad(0.3) * sin(j1) + Quad(0.8) * sin(c) - Quad(0.6) * sin(j3);
    const Quad xx = -Quad(0.3) * sin(j1) - Quad(0.32) * sin(c), xz = Quad(0.3) * cos(j1) + Quad(0.32) * cos(c);
    const Quad yx = Quad(0.6) * sin(j3), yz = -Quad(0.6) * cos(j3);
    const Quad det = xx * yz - yx * xz;
    j1 -= (fx * yz - yx * fz) / det;
    j3 -= (xx * fz - fx * xz) / det;
  }
}

// Fails when the null space of the couplings is replaced by all directions.
TEST(Assembly, mimics_are_kept) {
  // The field case turns about +y; with the signs of all angles turned it is this one.
  const std::string apart = four_bar("mimic.urdf", {}, {}, "<mimic joint=\"j3\" multiplier=\"-1.5\" offset=\"0.2\"/>");
  const Scene s = scene_of(apart, "j1: 1.0, j2: -0.7, j3: 1.8", point_loop);
  EXPECT_LT(ratio(s.q[3] - (-1.5 * s.q[2] + 0.2), 1.5 * std::fabs(s.q[2]) + 0.2), 30);
  EXPECT_LT(ratio(pin_gap(s.q[0], s.q[1], s.q[2]), 4), 30);
  EXPECT_NE(s.q[2], 1.8);

  JointText follows;
  follows.more = "<mimic joint=\"j1\" multiplier=\"-0.6\" offset=\"-0.02\"/>";
  const Scene t = scene_of(four_bar("mimic2.urdf", follows), "j1: 1.0, j3: 1.8", point_loop);
  Quad j1 = -1.0, j3 = -1.8;
  solve_coupled(j1, j3);  // the equations are odd in z: angles with the other sign
  EXPECT_LT(ratio(t.q[0] + static_cast<double>(j1), 30), 30);  // κ below 30
  EXPECT_LT(ratio(t.q[2] + static_cast<double>(j3), 30), 30);
  EXPECT_LT(ratio(t.q[1] - (-0.6 * t.q[0] - 0.02), 1), 30);
  EXPECT_LT(std::fabs(t.q[0] - 1.083426), 5e-7);  // the six decimals of the field case
}

// Fails when couplings of the scene are left out of the unknowns' equations.
TEST(Assembly, couplings_keep_their_sum) {
  const std::string urdf = four_bar("coupled.urdf");
  const Scene s = scene_of(urdf, "j1: 1.0, j2: -0.7, j3: 1.8, j4: 0.3",
                           point_loop + "  - {kind: coupling, terms: [{joint: r/j4, coefficient: 2}, {joint: r/j3, coefficient: 3}]}\n");
  EXPECT_LT(ratio(2 * s.q[3] + 3 * s.q[2] - (2 * 0.3 + 3 * 1.8), 6), 30);
  EXPECT_LT(ratio(pin_gap(s.q[0], s.q[1], s.q[2]), 4), 30);
  EXPECT_NE(s.q[3], 0.3);
  // Held: the coupled joint holds j3 with it.
  const Scene held = scene_of(urdf, "j1: 1.0, j2: -0.7, j3: 1.8, j4: 0.3",
                              point_loop + "  - {kind: coupling, terms: [{joint: r/j4, coefficient: 2}, {joint: r/j3, coefficient: 3}]}\n", "hold: [r/j4]\n");
  EXPECT_EQ(held.q[3], 0.3);
  EXPECT_LT(ratio(held.q[2] - 1.8, 1.8), 30);
  EXPECT_LT(ratio(pin_gap(held.q[0], held.q[1], held.q[2]), 4), 30);
}

// Fails when weak directions are taken first: the crank turns by more than a radian for half of the gap.
TEST(Assembly, a_linkage_planar_but_for_its_decimals_stays_where_it_is) {
  JointText tilt2, tilt3;
  tilt2.origin = "rpy=\"0.00001 0 0\"", tilt3.origin = "rpy=\"0 0 0.00001\"";
  const Scene s = scene_of(four_bar("tilted.urdf", tilt2, tilt3), "j1: 1.000000, j2: -0.565246, j3: 1.759125", hinge_loop);
  EXPECT_TRUE(has_warning(s, "loop left open"));
  EXPECT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].text.find("loop_closing.yaml:4: constraints[0]: hinge r/coupler - r/rocker is open by "), std::string::npos) << s.warnings[0].text;
  EXPECT_GT(s.assembly.residual, 1e-6);
  EXPECT_LT(s.assembly.residual, 2e-5);
  EXPECT_LT(std::fabs(s.q[0] - 1), 1e-4);
  EXPECT_LT(pin_gap(s.q[0], s.q[1], s.q[2]), 2e-5);
}

/// Two bodies on slides along x (or arms of 10 m about z): what is off across cannot be closed.
std::string across(bool arms) {
  JointText a{"a", "base", "one"}, b{"b", "base", "two"};
  a.type = b.type = arms ? "revolute" : "prismatic", a.axis = b.axis = arms ? "0 0 1" : "1 0 0";
  return write("across.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + link("base") + link("one") + link("two") + joint(a) + joint(b) + "</robot>\n");
}

Scene gap(double g, const std::string& own = "", const std::string& more = "", bool arms = false) {
  const std::string at = arms ? "at: [10, 0, 0]" : "at: [0, 0, 0]", to = arms ? "to_at: [10, 0, " : "to_at: [0.5, 0, ";
  return scene_of(across(arms), "a: 0.1", "  - {kind: point, of: r/one, " + at + ", to: r/two, " + to + text(g) + "]" + own + "}\n", more);
}

Scene tilt(double angle, bool arms = false) {
  const std::string at = arms ? "[10, 0, 0]" : "[0, 0, 0]";
  return scene_of(across(arms), "a: 0.1", "  - {kind: hinge, of: r/one, at: " + at + ", rpy: [" + text(angle) + ", 0, 0], to: r/two, to_at: " + at + ", to_rpy: [0, 0, 0]}\n");
}

/// Half a limit is accepted with the gap stated, twice the limit is refused with it.
void expect_limit(double limit, const std::function<Scene(double)>& load) {
  const Scene s = load(limit / 2);
  EXPECT_TRUE(has_warning(s, "loop left open")) << limit;
  EXPECT_LT(std::fabs(s.assembly.residual - limit / 2), limit * 1e-3);
  expect_refused([&] { (void)load(2 * limit); }, {"loop_closing.yaml:4: constraints[0]", "open by ", "after ", "loop: false", "assembly: false", "tolerance"});
}

// Fails when accepted_gap is a million times wider, when a lever arm is left out, and when one tolerance is taken for the other.
TEST(Assembly, tolerances_at_half_and_twice_the_limit) {
  expect_limit(1e-4, [](double g) { return gap(g); });
  for (const bool arms : {false, true}) expect_limit(1e-4, [arms](double angle) { return tilt(angle, arms); });  // angles have no arm
  expect_limit(1e-3, [](double g) { return gap(g, "", "", true); });  // arms of 10 m
  expect_limit(1e-6, [](double g) { return gap(g, ", tolerance: 1e-6"); });
  expect_limit(1e-2, [](double g) { return gap(g, "", "assembly: {tolerance: 0.01}\n"); });
  expect_limit(1e-6, [](double g) { return gap(g, ", tolerance: 1e-6", "assembly: {tolerance: 0.01}\n"); });
  expect_limit(1e-2, [](double g) { return gap(g, ", tolerance: 0.01", "assembly: {tolerance: 1e-6}\n"); });
  // Rounding: 30 u times the joints on both ways and the closure, times 1 m.
  const double rounding = 30 * 0x1p-53 * 3;
  EXPECT_FALSE(has_warning(gap(rounding / 2, ", tolerance: 0"), "loop left open"));
  EXPECT_TRUE(has_warning(gap(2 * rounding), "loop left open"));
  expect_refused([&] { (void)gap(2 * rounding, "", "strict: true\n"); }, {":4", "is open by 1.9", "strict"});
  expect_refused([&] { (void)gap(2 * rounding, ", tolerance: 0"); }, {"open by 1.9", "at most 9.9"});
}

// Fails when limits are not looked at.
TEST(Assembly, limits_are_kept_or_their_violation_is_told) {
  const std::string pose = "j1: 1.0, j2: -0.5, j3: 1.7";
  const double free = scene_of(four_bar("limits.urdf"), pose, point_loop).q[1];
  ASSERT_LT(free, -0.51);
  JointText two;
  two.limits = "lower=\"" + text(free + 0.01) + "\" upper=\"2\"";
  const std::string limited = four_bar("limited.urdf", two);
  const Scene s = scene_of(limited, pose, point_loop);
  EXPECT_GE(s.q[1], free + 0.01);
  EXPECT_LT(s.q[1], free + 0.02);
  expect_closed_form(s);
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_TRUE(s.assembly.beyond.empty());
  JointText mirrored;  // the same from the other side
  mirrored.axis = "0 1 0", mirrored.limits = "lower=\"-2\" upper=\"" + text(-free - 0.01) + "\"";
  const Scene m = scene_of(four_bar("mirrored.urdf", mirrored), "j1: 1.0, j2: 0.5, j3: 1.7", point_loop);
  EXPECT_LE(m.q[1], -free - 0.01);
  EXPECT_LT(ratio(m.q[1] + s.q[1], 10), 30);
  const Scene beyond = scene_of(limited, pose, point_loop, "hold: [r/j1]\n");  // the other pose at this crank has j2 = −2.0
  expect_closed_form(beyond);
  ASSERT_EQ(beyond.assembly.beyond.size(), 1u);
  EXPECT_EQ(beyond.assembly.beyond[0].limit, free + 0.01);
  EXPECT_TRUE(has_warning(beyond, "limit broken by assembly"));
}

TEST(Assembly, what_cannot_be_closed_says_how_far_it_came_and_loads_open) {
  const std::string urdf = four_bar("open.urdf"), loop = "  - {kind: point, of: r/coupler, at: [0.2, 0, 0], to: r/rocker, to_at: [0.3, 0, 0]";
  const std::string pose = "j1: 0.2, j2: 0.1, j3: 3.0";
  expect_refused([&] { (void)scene_of(urdf, pose, loop + "}\n"); }, {"loop_closing.yaml:4: constraints[0]", "open by 0.19", "before", "loop: false"});
  expect_refused([&] { (void)scene_of(urdf, pose, loop + "}\n" + loop + "}\n"); }, {"; also open: point r/coupler - r/rocker by 0.19"});
  for (const Scene& s : {scene_of(urdf, pose, loop + ", loop: false}\n"), scene_of(urdf, pose, loop + "}\n", "assembly: false\n")}) {
    EXPECT_EQ(s.q[0], 0.2);
    EXPECT_EQ(s.q[1], 0.1);
    EXPECT_EQ(s.q[2], 3.0);
    EXPECT_EQ(s.damping.diagonal.size(), 3u);
  }
  EXPECT_TRUE(has_warning(scene_of(urdf, pose, loop + "}\n", "assembly: false\n"), "loop left open"));
}

TEST(Assembly, whole_robots_and_boxes_are_held) {
  const std::string text_of = "boxes:\n  - {name: a, mass: 1, size: [1, 1, 1]}\n  - {name: b, mass: 2, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n"
                              "constraints:\n  - {kind: point, of: a, at: [1, 0, 0], to: b, to_at: [-1, 0, 0]}\n";
  const Scene s = load_scene(write("held.yaml", text_of + "hold: [a]\n"));
  EXPECT_EQ(s.q.head<7>(), (VectorX<double>(7) << 0, 0, 0, 1, 0, 0, 0).finished());
  EXPECT_LT(ratio(s.assembly.residual, 6), 30);
  EXPECT_TRUE(has_note(s, "b/base by "));
  expect_refused([&] { (void)load_scene(write("held.yaml", text_of + "hold: [a, b]\n")); }, {"held.yaml:5", "open by 1 m"});
  expect_refused([&] { (void)load_scene(write("held.yaml", text_of + "hold: [c]\n")); }, {"held.yaml:6", "\"c\""});
  expect_refused([&] { (void)load_scene(write("held.yaml", text_of + "assembly: {tolerance: -1}\n")); }, {"held.yaml:6", "negative"});
}

}  // namespace
}  // namespace delassus::loop_closing_test
