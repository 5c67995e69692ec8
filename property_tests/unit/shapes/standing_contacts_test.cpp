// Contacts with what stands in the world: links that are fixed to it, and fixed boxes.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "models/contacts.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::standing_contacts_test {
namespace {

using V3 = Vector3<double>;
using Names = std::set<std::string>;

Scene read(const std::string& text, const std::string& robot = "", const std::string& name = "robot.urdf") {
  const auto folder = test::temporary("standing.yaml").parent_path();
  std::ofstream(folder / name) << robot;
  std::ofstream(folder / "standing.yaml") << text;
  return load_scene((folder / "standing.yaml").string());
}

std::string link(const std::string& name, const std::string& box, double middle) {
  return "<link name='" + name + "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial><collision><origin xyz='" + std::to_string(middle) +
         " 0 0'/><geometry><box size='" + box + "'/></geometry></collision></link>";
}

std::string joint(const std::string& parent, const std::string& child, double at) {
  return "<joint name='to_" + child + "' type='continuous'><parent link='" + parent + "'/><child link='" + child + "'/><origin xyz='" + std::to_string(at) +
         " 0 0'/><axis xyz='0 1 0'/></joint>";
}

/// An arm of two links and a tool on a base of two links that are fixed, a box beside the base that does not touch it.
Scene arm(const std::string& contacts, const std::string& base = "fixed") {
  return read("robots:\n  - {name: arm, file: robot.urdf, base: " + base + "}\nboxes:\n  - {name: box, mass: 1, size: [0.1, 0.1, 0.1], pose: {xyz: [-0.16, 0, 0]}}\ncontacts: " + contacts + "\n",
              "<robot name='arm'>" + link("base", "0.2 0.2 0.2", 0) + link("stand", "0.2 0.2 0.2", 0) + link("upper", "0.4 0.1 0.1", 0.25) + link("lower", "0.6 0.1 0.1", 0.3) +
                  "<joint name='weld' type='fixed'><parent link='base'/><child link='stand'/><origin xyz='0 0 -0.2'/></joint>" + joint("base", "upper", 0.15) + joint("upper", "lower", 0.5) + "</robot>");
}

/// Names of what touches with the lower arm folded over the upper one by an angle, and the box brought near the base.
std::set<std::string> touching(const Scene& s, double fold, double box) {
  VectorX<double> q = s.q;
  q[1] = fold, q[2] = box;
  Poses<double> at;
  poses(s.model, q, at);
  std::vector<std::string> notes;
  std::set<std::string> out;
  for (const ContactPoint& c : find_contacts(s.model, at, s.motion.search, notes)) {
    const std::string other = c.standing >= 0 ? s.motion.search.standing[static_cast<std::size_t>(c.standing)].name : s.model.bodies[static_cast<std::size_t>(c.other)].name;
    EXPECT_EQ(c.standing >= 0, c.other == ground);
    out.insert(s.model.bodies[static_cast<std::size_t>(c.body)].name + " " + other);
  }
  return out;
}

TEST(Standing, a_fixed_base_is_touched_by_others_and_by_its_own_arm_where_asked_for) {
  const Scene s = arm("detect"), self = arm("{detect: true, self: true}");
  ASSERT_EQ(s.motion.search.standing.size(), 2u);
  EXPECT_EQ(touching(s, 0, -0.16), (Names{}));
  EXPECT_EQ(touching(s, 0, -0.1501), (Names{"box arm/base"}));
  EXPECT_EQ(touching(s, M_PI, -0.16), (Names{}));
  EXPECT_EQ(touching(self, M_PI, -0.16), (Names{"arm/lower arm/base"})) << "the upper arm is a neighbour of the base";
  EXPECT_EQ(touching(self, 0, -0.1501), (Names{"box arm/base"}));
  EXPECT_EQ(s.notes, std::vector<std::string>{}) << "nothing is left out";
}

// Two robots on bases that stand, each with a body that floats: each arm leaves its own base alone, and touches the other's.
TEST(Standing, each_arm_leaves_its_own_base_alone) {
  const std::string floats = "<joint name='free' type='floating'><parent link='base'/><child link='loose'/><origin xyz='0 5 0'/></joint>";
  const std::string robot = "<robot name='arm'>" + link("base", "0.2 0.2 0.2", 0) + link("upper", "0.4 0.1 0.1", 0.25) + link("loose", "0.1 0.1 0.1", 0) + joint("base", "upper", -0.1) + floats + "</robot>";
  const auto scene = [&](double apart) {
    return read("robots:\n  - {name: one, file: robot.urdf, base: fixed}\n  - {name: two, file: robot.urdf, base: fixed, pose: {xyz: [" + std::to_string(apart) + ", 0, 0]}}\ncontacts: detect\n", robot);
  };
  EXPECT_TRUE(scene(3).model.constraints.empty());
  EXPECT_FALSE(scene(0.4).model.constraints.empty()) << "the arm of one lies in the base of two";
}

// What touches its own base at the given pose stands so by its model.
TEST(Standing, what_touches_its_base_from_the_start_is_left_out) {
  const std::string robot = "<robot name='arm'>" + link("base", "0.2 0.2 0.2", 0) + link("upper", "0.4 0.1 0.1", 0.25) + link("lower", "0.9 0.1 0.1", -0.45) + joint("base", "upper", 0.15) +
                            joint("upper", "lower", 0.5) + "</robot>";
  const Scene s = read("robots:\n  - {name: arm, file: robot.urdf, base: fixed}\ncontacts: {detect: true, self: true}\n", robot);
  EXPECT_TRUE(s.model.constraints.empty());
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("1 pairs of links of one robot touch"), std::string::npos) << s.notes[0];
}

// Contacts at the pose: with the table as with the plane, named by it, its coefficient the table's or the smaller one.
TEST(Standing, rows_at_the_pose) {
  for (const double own : {0.2, 0.7}) {
    const Scene s = read("boxes:\n  - {name: box, mass: 2, size: [0.25, 0.25, 0.25], pose: {xyz: [3, 2, 1.125]}, friction: 0.5}\n  - {name: table, fixed: true, size: [1, 1, 0.5], friction: " +
                         std::to_string(own) + ", pose: {xyz: [3, 2, 0.75]}}\nground: {z: 0, friction: 0.9}\ncontacts: detect\n");
    ASSERT_EQ(s.model.constraints.size(), 4u);
    for (const Constraint& c : s.model.constraints) {
      EXPECT_EQ(c.name, "contact box - table");
      EXPECT_EQ(c.b.body, ground);
      EXPECT_EQ(c.friction, std::min(own, 0.5));
      EXPECT_EQ(c.b.placement.translation[2], 1);
      EXPECT_EQ(c.a.placement.translation[2], -0.125);
    }
  }
}

// A box on two blocks that stand, and on a plane between them: no two contacts are taken for one.
TEST(Standing, every_contact_has_a_feature_of_its_own) {
  const Scene s = read("boxes:\n  - {name: box, mass: 2, size: [1, 0.25, 0.25], pose: {xyz: [0, 0, 0.125]}}\n  - {name: left, fixed: true, size: [0.25, 1, 1], pose: {xyz: [-0.375, 0, -0.5]}}\n"
                       "  - {name: right, fixed: true, size: [0.25, 1, 1], pose: {xyz: [0.375, 0, -0.5]}}\nground: {z: 0}\ncontacts: detect\n");
  Poses<double> at;
  poses(s.model, s.q, at);
  std::vector<std::string> notes;
  std::set<Index> features;
  for (const ContactPoint& c : find_contacts(s.model, at, s.motion.search, notes)) EXPECT_TRUE(c.other == ground && features.insert(c.feature).second);
  EXPECT_EQ(features.size(), 12u);
}

// Of a file with bodies that float, what stands is a table like any other to these, and a base to the rest.
TEST(Standing, who_floats_in_the_same_file_stands_on_it) {
  const std::string file = "<mujoco><worldbody><geom type='box' size='1 1 0.5' pos='0 0 -0.5'/><body name='free' pos='0 0 0.1'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>"
                           "<body name='swing' pos='0.5 0 0.05'><joint type='hinge' axis='0 1 0'/><geom type='box' size='0.05 0.05 0.05'/></body></worldbody></mujoco>";
  for (const char* contacts : {"detect", "{detect: true, self: true}"}) {
    Scene s;
    try {
      s = read("robots:\n  - {name: all, file: robot.xml}\ncontacts: " + std::string(contacts) + "\n", file, "robot.xml");
    } catch (const ModelError& e) {
      if (std::string(e.what()).find("libmujoco") != std::string::npos || std::string(e.what()).find("without") != std::string::npos) GTEST_SKIP() << e.what();
      throw;
    }
    Names found;
    for (const Constraint& c : s.model.constraints) found.insert(c.name);
    EXPECT_EQ(found, (Names{"contact all/free - all/world"})) << contacts;
  }
}

TEST(Standing, a_fixed_box_is_the_world_to_constraints_and_has_no_velocity) {
  const Scene s = read("boxes:\n  - {name: box, mass: 1, size: [1, 1, 1]}\n  - {name: wall, fixed: true, size: [1, 1, 1], pose: {xyz: [0, 2, 0]}}\n"
                       "constraints:\n  - {kind: point, of: box, to: wall, to_at: [0, -2, 0]}\n");
  ASSERT_EQ(s.model.bodies.size(), 1u);
  EXPECT_EQ(s.model.constraints[0].b.body, ground);
  EXPECT_EQ(s.model.constraints[0].b.placement.translation, V3(0, 0, 0));
  EXPECT_THROW((void)read("boxes:\n  - {name: box, mass: 1, size: [1, 1, 1]}\n  - {name: wall, fixed: true, size: [1, 1, 1], velocity: {linear: [1, 0, 0]}}\n"), ModelError);
  EXPECT_THROW((void)read("boxes:\n  - {name: wall, fixed: true, size: [1, 1, 1]}\n"), ModelError) << "nothing moves";
}

}  // namespace
}  // namespace delassus::standing_contacts_test
