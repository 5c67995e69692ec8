// Rows of joint limits, and names that were probably meant.
#include <gtest/gtest.h>

#include "property_tests/unit/mechanism/four_bars.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/sdf_text.h"

namespace delassus::joint_limits_test {
namespace {

using namespace four_bars;

TEST(JointLimits, are_rows_of_their_side) {
  JointText two, three;
  two.limits = "lower=\"-1\" upper=\"2\"", three.limits = "lower=\"-1\" upper=\"2\"";
  const std::string urdf = four_bar("limit_rows.urdf", two, three);
  const auto rows = [&](const std::string& c) { return unit::constraint_jacobian(problem_of(scene_of(urdf, "j1: 0.5", c))); };
  MatrixX<double> expected = MatrixX<double>::Zero(2, 4);
  expected(0, 2) = 1, expected(1, 1) = -1;
  EXPECT_EQ(rows("  - {kind: joint_limit, joint: r/j3, side: lower}\n  - {kind: joint_limit, joint: r/j2, side: upper}\n"), expected);
  MatrixX<double> all(8, 4), lower = MatrixX<double>::Identity(4, 4);
  for (Index k = 0; k < 4; ++k) all.row(2 * k) = lower.row(k), all.row(2 * k + 1) = -lower.row(k);
  EXPECT_EQ(rows("  - {kind: joint_limit, robot: r}\n"), all);
  EXPECT_EQ(rows("  - {kind: joint_limit, robot: r, side: lower}\n"), lower);
  EXPECT_EQ(rows("  - {kind: joint_limit, robot: r, side: upper}\n"), -lower);
  const Scene s = scene_of(urdf, "j1: 0.5", "  - {kind: joint_limit, joint: r/j3}\n");
  EXPECT_EQ(s.model.constraints[0].name, "joint_limit r/j3 lower");
  EXPECT_EQ(s.model.constraints[1].name, "joint_limit r/j3 upper");
  expect_refused([&] { (void)rows("  - {kind: joint_limit, joint: r/j3, side: left}\n"); }, {":4", "left", "lower, upper"});
  expect_refused([&] { (void)rows("  - {kind: joint_limit, joint: r/j3, dof: 1}\n"); }, {":4", "1 degree"});
  expect_refused([&] { (void)rows("  - {kind: joint_limit, joint: r/none}\n"); }, {":4", "r/none"});
  expect_refused([&] { (void)rows("  - {kind: joint_limt, joint: r/j3}\n"); }, {":4", "joint_limt", "did you mean joint_limit?"});
  expect_refused([&] { (void)rows("  - {kind: joint_lock, joint: r/3j}\n"); }, {":4", "did you mean r/j3?"});
  expect_refused([&] { (void)rows("  - {kind: point, of: r/cupler, to: world}\n"); }, {":4", "did you mean r/coupler?"});
  expect_refused([&] { (void)scene_of(urdf, "j11: 0.5", "  - {kind: joint_limit, robot: r}\n"); }, {":2", "did you mean j1?"});
  expect_refused([&] { (void)scene_of(urdf, "j1: 0.5", "  - {kind: joint_limit, robt: r}\n"); }, {":4", "did you mean robot?"});
  expect_refused([&] { (void)open_scene("casie"); }, {"did you mean cassie?"});
  EXPECT_EQ(refusal([&] { (void)rows("  - {kind: point, of: gripper, to: world}\n"); }).find("did you mean"), std::string::npos);
  JointText endless;
  endless.type = "continuous", endless.limits = "";
  const std::string free = four_bar("limit_free.urdf", endless);
  expect_refused([&] { (void)scene_of(free, "j1: 0.5", "  - {kind: joint_limit, joint: r/j2}\n"); }, {":4", "no such limit"});
  EXPECT_EQ(scene_of(free, "j1: 0.5", "  - {kind: joint_limit, robot: r}\n").damping.diagonal.size(), 6u);
}

// The first axis of a universal joint has both limits, the second a lower one only: infinity is no row.
TEST(JointLimits, of_several_freedoms_are_each_their_own) {
  NEEDS_SDF;
  const std::string links = "<link name='a'>" + unit::sdf_inertial(1) + "</link><link name='b'>" + unit::sdf_inertial(1) + "</link>";
  const std::string joint = "<joint name='j' type='universal'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis>"
                            "<axis2><xyz>0 1 0</xyz><limit><lower>-3</lower></limit></axis2></joint>";
  const std::string file = unit::write_sdf("universal.sdf", unit::sdf(links + joint));
  const auto rows = [&](const std::string& more) {
    return unit::constraint_jacobian(problem_of(scene_of(file, "", "  - {kind: joint_limit, joint: r/j" + more + "}\n")));
  };
  MatrixX<double> all = MatrixX<double>::Zero(3, 2);
  all(0, 0) = 1, all(1, 0) = -1, all(2, 1) = 1;
  const auto expect = [&](const std::string& more, const MatrixX<double>& expected) {
    const MatrixX<double> found = rows(more);
    ASSERT_EQ(found.rows(), expected.rows()) << more;
    EXPECT_EQ(found, expected) << more;
  };
  expect("", all);
  expect(", side: lower", all({0, 2}, Eigen::all));
  expect(", side: upper", all.row(1));
  expect(", dof: 1", all.row(2));
  const Scene s = scene_of(file, "", "  - {kind: joint_limit, joint: r/j}\n");
  EXPECT_EQ(s.model.constraints[2].name, "joint_limit r/j 1 lower");
}

}  // namespace
}  // namespace delassus::joint_limits_test
