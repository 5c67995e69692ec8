// What readers of robots say, whole: every sentence from the name of the file to what is to be done, and none beside it.
#include <gtest/gtest.h>

#include <fstream>

#include "models/scene.h"
#include "models/formats/urdf_check.h"
#include "models/formats/xml_lines.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::said_test {
namespace {

using Sentences = std::vector<std::string>;

std::string written(const std::string& name, const std::string& text) {
  const auto file = test::temporary(name);
  std::ofstream(file) << text;
  return file.string();
}

/// A link on one line, as line 2 of a robot, with a mass of 1 kg unless `inside` brings its own.
std::string robot_of(const std::string& inside, const std::string& inertial = R"(<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>)") {
  return "<robot name=\"r\">\n<link name=\"a\"><inertial>" + inertial + "</inertial>" + inside + "</link>\n</robot>\n";
}

constexpr auto on_the_ground = RobotOptions::Base::fixed;

Scene read(const std::string& text, bool strict = false, RobotOptions::Base base = RobotOptions::Base::free) {
  return open_scene(written("said.urdf", text), {.strict = strict, .base = base, .armature = {}});
}

std::string complaint(const std::string& text) {
  try {
    (void)read(text, false, on_the_ground);
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

/// The warnings, without the name of the file that each begins with; in strict mode the first is the refusal.
Sentences warnings_of(const std::string& text) {
  const Scene s = read(text);
  const std::string file = test::temporary("said.urdf").string() + ": ";
  Sentences out;
  for (const Warning& w : s.warnings) {
    EXPECT_EQ(w.text.find(file), 0u) << w.text;
    out.push_back(w.text.substr(std::min(file.size(), w.text.size())));
  }
  if (out.empty()) EXPECT_NO_THROW((void)read(text, true));
  else EXPECT_THROW((void)read(text, true), ModelError);
  return out;
}

std::string inertial(const std::string& mass, const std::string& ixx, const std::string& iyy, const std::string& izz) {
  return "<mass value=\"" + mass + "\"/><inertia ixx=\"" + ixx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + iyy + "\" iyz=\"0\" izz=\"" + izz + "\"/>";
}

TEST(Said, of_inertias) {
  const auto said = [](const std::string& mass, const std::string& ixx, const std::string& iyy, const std::string& izz) {
    const std::string text = robot_of("");
    return warnings_of(text.substr(0, text.find("</robot>")) + "<link name=\"b\"><inertial>" + inertial(mass, ixx, iyy, izz) +
                       "</inertial></link>\n<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><dynamics armature=\"1\"/></joint></robot>\n");
  };
  const std::string place = "link \"b\" <inertial> (line 3): ";
  EXPECT_EQ(said("0", "0", "0", "0"), Sentences{});
  EXPECT_EQ(said("2", "1", "1", "2"), Sentences{});
  EXPECT_EQ(said("2", "0", "0", "0"), Sentences{place + "mass 2 kg and no inertia (taken as a point mass)"});
  EXPECT_EQ(said("0", "1", "1", "1"), Sentences{place + "an inertia, and mass 0 kg (the inertia is kept; give the mass)"});
  EXPECT_EQ(said("2", "1", "1", "0"), Sentences{place + "principal moments (0 1 1) kg m^2: the smallest is zero (taken as a thin rod)"});
  EXPECT_EQ(said("2", "1", "4", "1"), Sentences{place + "principal moments (1 1 4) kg m^2 break the triangle inequality: the largest exceeds the sum of the others by 2 kg m^2, 0.5 of it "
                                                        "(no body of positive density is like that; M is positive definite all the same)"});
}

TEST(Said, of_collision_shapes) {
  const std::string place = "link \"a\" <collision> (line 2): ";
  for (const char* nothing : {"<collision/>", "<collision><geometry/></collision>", "<collision><origin xyz=\"1 2 3\"/></collision>"})
    EXPECT_EQ(warnings_of(robot_of(nothing)), Sentences{place + "has no geometry and is left out (box, cylinder, sphere, capsule or mesh)"}) << nothing;
  const auto geometry = [](const std::string& g) { return robot_of("<collision><geometry>" + g + "</geometry></collision>"); };
  const std::string mesh = "link \"a\" <mesh> (line 2): ";
  EXPECT_EQ(warnings_of(geometry("<mesh/>")), Sentences{mesh + "names no file and is left out (filename=\"...\")"});
  for (const std::string scale : {"1 1", "1 1 1 1", "1 x 1", "1 nan 1", "inf 1 1", ""})
    EXPECT_EQ(warnings_of(geometry("<mesh filename=\"x.stl\" scale=\"" + scale + "\"/>")),
              Sentences{mesh + "scale = \"" + scale + "\" is not understood, the mesh is left out (3 finite numbers)"});
  EXPECT_EQ(warnings_of(geometry("<mesh filename=\"x.stl\" scale=\"1 -2 3\"/>")), Sentences{});
  EXPECT_EQ(warnings_of(geometry("<cylinder radius=\"0\" length=\"1\"/>")), Sentences{"link \"a\" <cylinder> (line 2): a cylinder without volume is left out (lengths > 0 [m])"});
}

// A capsule is one whatever its length, but for 0.
TEST(Said, capsules_without_length_are_spheres) {
  for (const double length : {0.0, 0.5, 2.0}) {
    const Scene s = read("<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"><inertial>" + inertial("1", "1", "1", "1") + "</inertial><collision><geometry><capsule radius=\"0.25\" length=\"" +
                         std::to_string(length) + "\"/></geometry></collision></link>\n<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>\n", false, on_the_ground);
    ASSERT_EQ(s.model.bodies[0].shapes.size(), 1u);
    const Shape& shape = s.model.bodies[0].shapes[0];
    EXPECT_EQ(shape.kind, length == 0 ? Shape::Kind::sphere : Shape::Kind::capsule) << length;
    EXPECT_EQ(shape.size, Vector3<double>(0.25, length / 2, 0));
  }
}

// What is judged only when all is read still says where it stands: a body of one link, one of two.
TEST(Said, of_bodies_that_cannot_be) {
  const auto far_away = [](const std::string& of_c, const std::string& of_b, const std::string& joint_of_c) {
    return complaint("<robot name=\"r\">\n<link name=\"a\"/>\n\n<link name=\"b\"><inertial><origin xyz=\"" + of_b + " 0 0\"/>" + inertial("1", "1", "1", "1") +
                     "</inertial></link>\n<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>\n<link name=\"c\"><inertial><origin xyz=\"" +
                     of_c + " 0 0\"/>" + inertial("1", "1", "1", "1") + "</inertial></link>\n<joint name=\"k\" type=\"" + joint_of_c + "\"><parent link=\"b\"/><child link=\"c\"/></joint></robot>\n");
  };
  const std::string file = test::temporary("said.urdf").string();
  EXPECT_EQ(far_away("0", "1e200", "continuous"), file + ": said/b (line 4): mass 1 kg at 1e+200 m, largest moment 1 kg m^2: M leaves the range of double (accepted: m l^2 and moments below "
                                                         "1e300 kg m^2; check the units of mass, inertia and origins)");
  EXPECT_EQ(far_away("1e200", "0", "fixed"),
            file + ": said/b (line 4): mass, com or inertia is not finite (accepted: finite numbers [kg, m, kg m^2]; check the units of the file they come from)");
  EXPECT_EQ(far_away("1000", "0", "fixed"), "");
}

TEST(Said, of_what_urdfdom_does_not_read) {
  const std::string file = written("said.urdf", robot_of(""));
  Findings findings;
  CheckedUrdf checked = check_urdf(file, findings);
  checked.text = R"(<robot name="r"><link name="a"/><joint name="j" type="revolute"><limit effort="x"/></joint></robot>)";
  try {
    (void)read_by_urdfdom(checked, findings);
    FAIL();
  } catch (const ModelError& e) {
    EXPECT_EQ(e.what(), file + ": robot: urdfdom: effort value (x) is not a valid float; Could not parse limit element for joint [j]; joint xml is not initialized correctly "
                               "(accepted: a URDF 1.0 robot; correct what urdfdom names)");
  }
}

// Lines are for messages: a file without any gives none.
TEST(Said, lines_of_names) {
  const XmlLines none("no/such/file.sdf"), broken(written("said.sdf", "<sdf><link name='a'>")), empty(written("said.sdf", "<!-- nothing -->"));
  for (const XmlLines* lines : {&none, &broken, &empty}) {
    EXPECT_EQ(lines->line("link", "a"), 0);
    EXPECT_EQ(lines->element("link", "a"), "link \"a\"");
  }
  const XmlLines lines(written("said.sdf", "<sdf>\n<link name='a'/>\n<link name='b'>\n<link name='b'/></link>\n<joint name='b'/><link/>\n<link name='c'/><link name='c'/><link name='c'/></sdf>"));
  EXPECT_EQ(lines.element("link", "a"), "link \"a\" (line 2)");
  EXPECT_EQ(lines.element("link", "m::n::a"), "link \"m::n::a\" (line 2)");
  EXPECT_EQ(lines.element("link", "b"), "link \"b\" (line 3 or 4)");
  EXPECT_EQ(lines.element("joint", "b"), "joint \"b\" (line 5)");
  EXPECT_EQ(lines.element("link", "c"), "link \"c\"");
  EXPECT_EQ(lines.element("joint", "a"), "joint \"a\"");
}

/// What a scene file is refused with, without the file's name.
std::string scene_complaint(const std::string& text) {
  const std::string file = written("said.yaml", text);
  try {
    (void)load_scene(file);
  } catch (const ModelError& e) {
    const std::string said = e.what();
    EXPECT_EQ(said.find(file), 0u) << said;
    return said.substr(std::min(file.size(), said.size()));
  }
  return "";
}

TEST(Said, of_scene_files) {
  EXPECT_EQ(scene_complaint("gravity: [0, 0, 0]\n---\n").substr(0, 3), ":3:") << "where the second one, empty, ends";
  EXPECT_EQ(scene_complaint("gravity: [0, 0, 0]\n---\na: 1\n").substr(0, 3), ":3:");
  EXPECT_NE(scene_complaint("boxes:\n  - {name: [b], mass: 1, size: [1, 1, 1]}\n").find("is no text"), std::string::npos);
  EXPECT_NE(scene_complaint("boxes:\n  - {name: '', mass: 1, size: [1, 1, 1]}\n").find("is no text"), std::string::npos);
}

// A joint is looked for in the robot that is named before the slash, and in no other.
TEST(Said, of_joints_of_another_robot) {
  const std::string links = R"(<link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)";
  (void)written("said.urdf", "<robot name=\"r\">" + links + "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>");
  const auto held = [](const std::string& joint) {
    return scene_complaint("robots:\n  - {name: arm, urdf: said.urdf, base: fixed}\n  - {name: ar, urdf: said.urdf, base: fixed}\nconstraints:\n  - {kind: joint_lock, joint: " + joint + "}\n");
  };
  EXPECT_EQ(held("arm/j"), "");
  EXPECT_EQ(held("ar/j"), "");
  for (const char* joint : {"arn/j", "leg/j", "ar-j", "j", "arm"}) EXPECT_NE(held(joint).find(std::string("joint \"") + joint + "\" does not exist or is fixed"), std::string::npos) << held(joint);
}

}  // namespace
}  // namespace delassus::said_test
