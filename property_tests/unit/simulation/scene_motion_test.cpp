// What a scene says of motion: velocities, springs, motors, wrenches, restitution; and what is refused.
#include <gtest/gtest.h>

#include "property_tests/unit/mechanism/four_bars.h"

namespace delassus::scene_motion_test {
namespace {

using namespace four_bars;

Scene with(const std::string& robot, const std::string& more) {
  return load_scene(write("moving.yaml", "robots:\n  - {name: r, urdf: " + four_bar("moving.urdf") + robot + "}\nboxes:\n  - {name: crate, mass: 2, size: [1, 1, 1], pose: {rpy: [0, 0, 1.5707963267948966]}, "
                                         "velocity: {angular: [0, 0, 3], linear: [1, 2, 0]}}\n" + more));
}

TEST(SceneMotion, keys_are_read) {
  const Scene s = with(", base: free, velocities: {j2: 0.5}, velocity: {linear: [0, 0, -1]}",
                       "springs: [{joint: r/j1, stiffness: 3, rest: 0.25, damping: 0.5}]\nmotors:\n  - {joint: r/j2, torque: -0.5, target: 1, stiffness: 2, damping: 4}\n"
                       "  - {joint: r/j3, torque: 9, effort: 2}\nwrenches: [{of: crate, force: [1, 2, 3], at: [0.5, 0, 0]}]\nground: {z: 0}\n"
                       "contacts: {detect: true, margin: 0.01, friction: 0.25, torsional_friction: 0.02, rolling_friction: 0.003, restitution: 0.5, damping: 1e-3}\nsleeping: {linear: 0.01, angular: 0.02, after: 0.5}\n");
  const SceneMotion& m = s.motion;
  const Index crate = s.model.find("crate"), j2 = s.model.find("r/coupler");
  ASSERT_EQ(m.nu.size(), s.model.dofs());
  EXPECT_EQ(m.nu[s.model.first_dof[static_cast<std::size_t>(j2)]], 0.5);
  EXPECT_EQ(m.nu[5], -1);
  const auto of_crate = m.nu.segment<6>(s.model.first_dof[static_cast<std::size_t>(crate)]);
  EXPECT_LT((of_crate - (VectorX<double>(6) << 0, 0, 3, 2, -1, 0).finished()).norm(), 1e-15 * 10);  // turned by a quarter about z
  ASSERT_EQ(m.springs.size(), 1u);
  EXPECT_EQ(m.springs[0].stiffness, 3); EXPECT_EQ(m.springs[0].rest, 0.25); EXPECT_EQ(m.springs[0].damping, 0.5);
  EXPECT_NE(m.springs[0].where.find("moving.yaml:5"), std::string::npos) << m.springs[0].where;
  ASSERT_EQ(m.motors.size(), 2u);
  EXPECT_EQ(m.motors[0].torque, -0.5); EXPECT_EQ(m.motors[0].target, 1); EXPECT_EQ(m.motors[0].stiffness, 2); EXPECT_EQ(m.motors[0].damping, 4);
  EXPECT_EQ(m.motors[0].effort, 1) << "the effort of the robot's file";
  EXPECT_EQ(m.motors[1].effort, 2);
  ASSERT_EQ(m.wrenches.size(), 1u);
  EXPECT_EQ(m.wrenches[0].at.body, crate);
  EXPECT_TRUE(m.wrenches[0].at.placement.translation == Vector3<double>(0.5, 0, 0));
  EXPECT_TRUE(m.wrenches[0].force == Vector3<double>(1, 2, 3));
  EXPECT_TRUE(m.detects);
  EXPECT_EQ(m.search.margin, 0.01); EXPECT_EQ(m.friction, 0.25); EXPECT_EQ(m.restitution, 0.5); EXPECT_EQ(m.contact_damping, 1e-3);
  EXPECT_EQ(m.sleeping.linear, 0.01); EXPECT_EQ(m.sleeping.angular, 0.02); EXPECT_EQ(m.sleeping.after, 0.5);
  EXPECT_EQ(m.torsional_friction, 0.02); EXPECT_EQ(m.rolling_friction, 0.003);
  EXPECT_EQ(m.search.object.size(), s.model.bodies.size());
}

TEST(SceneMotion, nothing_said_is_nothing) {
  const Scene s = open_scene("go2_standing");
  EXPECT_EQ(s.motion.nu.size(), 0);
  EXPECT_TRUE(s.motion.springs.empty() && s.motion.motors.empty() && s.motion.wrenches.empty());
  EXPECT_EQ(s.motion.restitution, 0);
  EXPECT_LT(s.motion.sleeping.linear, 0);
}

TEST(SceneMotion, what_is_wrong_is_refused_with_its_line) {
  const auto refused = [](const std::string& robot, const std::string& more, std::initializer_list<const char*> parts) {
    try {
      (void)with(robot, more);
      ADD_FAILURE() << "accepted: " << robot << more;
    } catch (const ModelError& e) {
      for (const char* part : parts) EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what() << "\nwithout " << part;
    }
  };
  refused(", base: fixed, velocity: {linear: [0, 0, 1]}", "", {"moving.yaml:2", "base does not float"});
  refused(", velocities: {j11: 1}", "", {"moving.yaml:2", "no moving joint", "did you mean j1?"});
  refused(", velocities: {j1: [1, 2]}", "", {"2 entries", "1 numbers"});
  refused("", "springs: [{joint: r/j1, stiffness: -1}]\n", {"moving.yaml:5", "stiffness", "-1"});
  refused("", "springs: [{joint: r/j1}]\n", {"stiffness is missing"});
  refused("", "springs: [{joint: r/j1, stiffness: 1, dof: 1}]\n", {"1 degrees of freedom"});
  refused("", "motors: [{joint: r/base, torque: 1}]\n", {"moving.yaml:5", "does not exist or is fixed"});
  refused("", "motors: [{joint: r/j1, torque: 1, effort: -2}]\n", {"effort", "-2"});
  refused("", "wrenches: [{of: world, force: [1, 0, 0]}]\n", {"the world does not move"});
  refused("", "wrenches: [{of: crate, force: [1, 0]}]\n", {"force"});
  refused("", "ground: {z: 0}\ncontacts: {detect: true, restitution: 1.5}\n", {"moving.yaml:6", "1.5 is above 1"});
  refused("", "ground: {z: 0}\ncontacts: {detect: true, rolling_friction: -0.1}\n", {"moving.yaml:6", "rolling_friction", "-0.1"});
  refused("", "sleeping: {linear: 0.1, after: 1}\n", {"moving.yaml:5", "angular is missing"});
  refused("", "sleeping: {linear: -0.1, angular: 1, after: 1}\n", {"moving.yaml:5", "linear", "-0.1"});
  refused("", "ground: {z: 0}\ncontacts: {detect: true, torsion: 0.1}\n", {"moving.yaml:6", "torsion", "torsional_friction"});
}

}  // namespace
}  // namespace delassus::scene_motion_test
