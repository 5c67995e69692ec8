// Assembly on joints of several degrees of freedom: what is locked, held, coupled and told of them; limits that are broken
// before it begins.
#include <gtest/gtest.h>

#include <cmath>

#include "property_tests/unit/mechanism/four_bars.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::assembly_joints_test {
namespace {

using namespace four_bars;
using unit::ratio;

/// A plate that turns about z and slides in its plane, and a carriage on x.
std::string plate() {
  JointText slide{"s", "base", "carriage"}, flat{"p", "base", "plate"};
  slide.type = "prismatic", slide.axis = "1 0 0";
  flat.type = "planar", flat.axis = "0 0 1", flat.limits = "";
  return write("plate.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + link("base") + link("carriage") + link("plate") + joint(slide) + joint(flat) + "</robot>\n");
}

/// The joint's entries of q.
VectorX<double> values(const Scene& s, const std::string& link) {
  const auto i = static_cast<std::size_t>(s.model.find("r/" + link));
  return s.q.segment(s.model.first_q[i], q_size(s.model.bodies[i].joint.type));
}

const std::string pin = "  - {kind: point, of: r/plate, at: [1, 0, 0], to: r/carriage, to_at: [0, 0, 0]}\n";

TEST(Assembly, a_locked_joint_of_several_freedoms_stays_in_all_of_them) {
  const VectorX<double> start = (VectorX<double>(3) << 0.25, 0.5, -std::sin(0.25)).finished();
  const std::string pose = "s: 1.25, p: [0.25, 0.5, " + text(start[2]) + "]";
  for (const Scene& s : {scene_of(plate(), pose, pin + "  - {kind: joint_lock, joint: r/p}\n"), scene_of(plate(), pose, pin, "hold: [r/p]\n")}) {
    EXPECT_EQ(values(s, "plate"), start);
    EXPECT_LT(ratio(values(s, "carriage")[0] - (0.5 + std::cos(0.25)), 2), 30);
  }
  const Scene other = scene_of(plate(), pose, pin, "hold: [r/s]\n");
  EXPECT_EQ(values(other, "carriage")[0], 1.25);
  EXPECT_NE(values(other, "plate"), start);
}

// What the plate turned and what it slid are told apart.
TEST(Assembly, turns_and_shifts_of_a_planar_joint_are_told_apart) {
  const Scene s = scene_of(plate(), "s: 1, p: [0, 0, 0.25]", pin, "hold: [r/s]\n");
  const VectorX<double> at = values(s, "plate");
  ASSERT_EQ(s.assembly.moves.size(), 1u);
  EXPECT_LT(ratio(at[1] + std::cos(at[0]) - 1, 2), 30);
  EXPECT_LT(ratio(at[2] + std::sin(at[0]), 2), 30);
  EXPECT_EQ(s.assembly.moves[0].turned, std::fabs(at[0]));
  EXPECT_LT(ratio(s.assembly.moves[0].shifted - std::hypot(at[1], at[2] - 0.25), 1), 30);
  EXPECT_GT(std::fabs(at[0]), 0.01);
  EXPECT_GT(std::fabs(at[2] - 0.25), 0.01);
}

TEST(Assembly, a_coupling_keeps_the_freedom_it_names) {
  const std::string coupling = "  - {kind: coupling, terms: [{joint: r/s, coefficient: 2}, {joint: r/p, dof: 2, coefficient: 3}]}\n";
  const Scene s = scene_of(plate(), "s: 1, p: [0.1, 0, 0.25]", pin + coupling);
  const VectorX<double> at = values(s, "plate");
  EXPECT_LT(ratio(2 * values(s, "carriage")[0] + 3 * at[2] - 2.75, 6), 30);
  EXPECT_LT(ratio(at[1] + std::cos(at[0]) - values(s, "carriage")[0], 3), 30);
  EXPECT_LT(ratio(at[2] + std::sin(at[0]), 2), 30);
  EXPECT_NE(at[2], 0.25);
}

// A note for terms that turn freely, none for those of a planar joint; what only slid is not said to have turned, nor the other way.
TEST(Assembly, notes_say_what_moved_and_what_has_no_position) {
  const auto coupled = [&](const std::string& joint) { return "  - {kind: coupling, terms: [{joint: r/s, coefficient: 2}, {joint: " + joint + ", coefficient: 3}]}\n"; };
  const Scene s = scene_of(plate(), "s: 1, p: [0, 0, 0.25]", pin + coupled("r/p"));
  EXPECT_FALSE(has_note(s, "have no position"));
  const Scene slid = scene_of(plate(), "s: 1.25, p: [0, 0, 0]", pin, "hold: [r/p]\n");
  EXPECT_TRUE(has_note(slid, "given values: r/s by 0.25 m (hold")) << slid.notes.at(0);
  const Scene bar = scene_of(four_bar("told.urdf"), "j1: 1.0, j2: -0.5, j3: 1.7", point_loop, "hold: [r/j1]\n");
  EXPECT_TRUE(has_note(bar, " rad (hold")) << bar.notes.at(0);
}

TEST(Assembly, of_many_joints_that_moved_six_are_named_and_the_others_counted) {
  std::string links = link("base"), joints, given;
  for (int k = 1; k <= 8; ++k) {
    const std::string n = std::to_string(k);
    links += link("l" + n);
    joints += joint({"j" + n, k == 1 ? "base" : "l" + std::to_string(k - 1), "l" + n, k == 1 ? "xyz=\"0 0 0\"" : "xyz=\"1 0 0\""});
    given += (k == 1 ? "" : ", ") + ("j" + n) + ": 0.3";
  }
  const Scene s = scene_of(write("eight.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + links + joints + "</robot>\n"), given,
                           "  - {kind: point, of: r/l8, at: [1, 0, 0], to: world, to_at: [3, 0, 4], loop: true}\n");
  ASSERT_EQ(s.assembly.moves.size(), 8u);
  EXPECT_TRUE(has_note(s, " rad and 2 more (hold")) << s.notes.at(0);
}

TEST(Assembly, a_held_robot_keeps_its_base) {
  const std::string robot = "robots:\n  - {name: r, urdf: " + plate() + ", base: free, joints: {s: 0.5}}\n", box = "boxes:\n  - {name: b, mass: 1, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n";
  const std::string loop = "constraints:\n  - {kind: point, of: r/carriage, at: [0, 0, 0], to: b, to_at: [-1, 0, 0]}\n";
  const Scene s = load_scene(write("held_robot.yaml", robot + box + loop + "hold: [r]\n"));
  EXPECT_EQ(s.q.head<7>(), (VectorX<double>(7) << 0, 0, 0, 1, 0, 0, 0).finished());
  EXPECT_EQ(values(s, "carriage")[0], 0.5);
  EXPECT_LT(ratio(s.assembly.residual, 6), 30);
  EXPECT_GT((s.q.segment<3>(s.q.size() - 7) - Vector3<double>(3, 0, 0)).norm(), 0.5);
}

// A value beyond its limit before assembly is a doubt of its own: assembly is to blame only where it goes further.
TEST(Assembly, a_limit_broken_before_is_where_the_value_is) {
  JointText back, further;  // j2 closes at -0.565
  back.limits = "lower=\"-9\" upper=\"-1\"", further.limits = "lower=\"0\" upper=\"2\"";
  const Scene s = scene_of(four_bar("back.urdf", back), "j1: 1.0, j2: -0.5, j3: 1.7", point_loop, "hold: [r/j1]\n");
  EXPECT_TRUE(has_warning(s, "angle outside its limits"));
  EXPECT_FALSE(has_warning(s, "limit broken by assembly"));
  EXPECT_TRUE(s.assembly.beyond.empty());
  const Scene t = scene_of(four_bar("further.urdf", further), "j1: 1.0, j2: -0.5, j3: 1.7", point_loop, "hold: [r/j1]\n");
  EXPECT_TRUE(has_warning(t, "limit broken by assembly"));
  ASSERT_EQ(t.assembly.beyond.size(), 1u);
  EXPECT_EQ(t.assembly.beyond[0].limit, -0.5);
}

TEST(Assembly, an_upper_limit_broken_before_is_where_the_value_is) {
  JointText further;  // j2 closes at -0.565, above both
  further.limits = "lower=\"-0.9\" upper=\"-0.85\"";
  const Scene s = scene_of(four_bar("upper.urdf", further), "j1: 1.0, j2: -0.7, j3: 1.7", point_loop, "hold: [r/j1]\n");
  EXPECT_TRUE(has_warning(s, "limit broken by assembly"));
  ASSERT_EQ(s.assembly.beyond.size(), 1u);
  EXPECT_EQ(s.assembly.beyond[0].limit, -0.7);
}

// Two coupled slides pass their limits, which differ, at once: held there, they would close the loop and break the coupling.
TEST(Assembly, limits_do_not_break_couplings) {
  const auto slide = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& limits) {
    JointText j{name, parent, child};
    j.type = "prismatic", j.axis = "1 0 0", j.limits = limits;
    return joint(j);
  };
  const std::string urdf = write("slides.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + link("base") + link("one") + link("two") + link("end") +
                                 slide("s1", "base", "one", "lower=\"-9\" upper=\"0.5\"") + slide("s2", "one", "two", "lower=\"-9\" upper=\"0.625\"") +
                                 slide("s3", "base", "end", "lower=\"-9\" upper=\"9\"") + "</robot>\n");
  const Scene s = scene_of(urdf, "s3: 2", "  - {kind: point, of: r/two, at: [0, 0, 0], to: r/end, to_at: [0, 0, 0]}\n  - {kind: coupling, terms: [{joint: r/s1, coefficient: 1}, {joint: r/s2, coefficient: -1}]}\n");
  const double one = values(s, "one")[0], two = values(s, "two")[0], end = values(s, "end")[0];
  EXPECT_LT(ratio(one - two, 4), 30) << one << " " << two;
  EXPECT_LT(ratio(one + two - end, 4), 30);
  EXPECT_LE(one, 0.5);
}

}  // namespace
}  // namespace delassus::assembly_joints_test
