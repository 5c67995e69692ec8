// The URDF loader: merging, joint types, mimic, armature, and the robots that come with the library.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "algorithms/mechanism/kinematics.h"
#include "models/scene.h"
#include "models/formats/urdf.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::urdf_test {
namespace {

constexpr double eps = 0x1p-53;

std::string write_urdf(const std::string& stem, const std::string& body) {
  const auto file = delassus::test::temporary("delassus_" + stem + ".urdf");
  std::ofstream(file) << "<robot name=\"r\">" << body << "</robot>";
  return file.string();
}

std::string link(const std::string& name, double mass = 2, double moment = 0.5, const std::string& xyz = "0 0 0") {
  const std::string m = std::to_string(moment);
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"" + xyz + "\"/><mass value=\"" + std::to_string(mass) + "\"/><inertia ixx=\"" + m +
         "\" ixy=\"0\" ixz=\"0\" iyy=\"" + m + "\" iyz=\"0\" izz=\"" + m + "\"/></inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "<axis xyz=\"0 0 2\"/>") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + more + "</joint>";
}

RobotOptions options(const std::string& file, RobotOptions::Base base = RobotOptions::Base::fixed) {
  RobotOptions o;
  o.file = file;
  o.robot = "r";
  o.base = base;
  return o;
}

// Two point-symmetric links of 2 kg, 1 m apart: c = 0.5 m, I = 2·0.5 + 2·2·0.5² about the axes across.
TEST(Urdf, a_fixed_joint_merges_inertia_and_keeps_the_frame) {
  Model m;
  const std::string fixed = "<origin xyz=\"1 0 0\"/>";
  const Robot r = add_urdf(m, options(write_urdf("merge", link("a") + link("b") + joint("j", "fixed", "a", "b", fixed)), RobotOptions::Base::free));
  ASSERT_EQ(m.bodies.size(), 1u);
  const Body& b = m.bodies[0];
  EXPECT_EQ(b.name, "r/a");
  EXPECT_EQ(b.mass, 4);
  EXPECT_EQ(b.com, Vector3<double>(0.5, 0, 0));
  EXPECT_LE((b.inertia.diagonal() - Vector3<double>(1, 2, 2)).cwiseAbs().maxCoeff(), 30 * eps * 2);
  EXPECT_EQ(r.links.at("b").body, 0);
  EXPECT_EQ(r.links.at("b").placement.translation, Vector3<double>(1, 0, 0));
}

TEST(Urdf, joint_types_limits_and_armature) {
  const std::string limit = "<limit lower=\"-1\" upper=\"2\" effort=\"3\"/><dynamics damping=\"0.25\" friction=\"0.5\" armature=\"0.125\"/>";
  const std::string file = write_urdf("types", link("a") + link("b") + link("c") + link("d") + link("e") +
      joint("rev", "revolute", "a", "b", "<axis xyz=\"0 3 0\"/>" + limit) + joint("con", "continuous", "b", "c") +
      joint("pla", "planar", "c", "d") + joint("flo", "floating", "c", "e"));
  Model m;
  RobotOptions o = options(file);
  o.joint_types["con"] = {JointType::spherical, {0, 1, 0}};
  o.armature["flo"] = 0.75;
  add_urdf(m, o);
  ASSERT_EQ(m.bodies.size(), 4u);
  EXPECT_EQ(m.dofs(), 1 + 3 + 3 + 6);
  const Joint& rev = m.bodies[0].joint;
  EXPECT_EQ(rev.axis, Vector3<double>(0, 1, 0));
  EXPECT_EQ(rev.armature, std::vector<double>{0.125});
  EXPECT_EQ(rev.damping, std::vector<double>{0.25});
  EXPECT_EQ(rev.friction, std::vector<double>{0.5});
  EXPECT_EQ(rev.lower, std::vector<double>{-1});
  EXPECT_EQ(rev.effort, std::vector<double>{3});
  EXPECT_TRUE(rev.velocity.empty());
  EXPECT_EQ(m.bodies[0].parent, ground);
  EXPECT_EQ(m.bodies[1].joint.type, JointType::spherical);
  EXPECT_EQ(m.bodies[3].joint.armature, std::vector<double>(6, 0.75));
}

TEST(Urdf, mimic_becomes_a_coupling_row) {
  const std::string file = write_urdf("mimic", link("a") + link("b") + link("c") + joint("j", "continuous", "a", "b") +
      joint("k", "continuous", "b", "c", "<axis xyz=\"1 0 0\"/><mimic joint=\"j\" multiplier=\"-2\" offset=\"0.5\"/>"));
  Model m;
  add_urdf(m, options(file));
  ASSERT_EQ(m.constraints.size(), 1u);
  const Constraint& c = m.constraints[0];
  EXPECT_EQ(c.kind, Constraint::Kind::coupling);
  ASSERT_EQ(c.terms.size(), 2u);
  EXPECT_EQ(c.terms[0].body, 1);
  EXPECT_EQ(c.terms[0].coefficient, 1);
  EXPECT_EQ(c.terms[1].body, 0);
  EXPECT_EQ(c.terms[1].coefficient, 2);
}

TEST(Urdf, primitives_are_kept_and_meshes_noted) {
  const std::string collisions =
      "<collision><geometry><box size=\"2 4 6\"/></geometry></collision><collision><geometry><sphere radius=\"0.5\"/></geometry></collision>"
      "<collision><geometry><cylinder radius=\"0.5\" length=\"3\"/></geometry></collision><collision><geometry><capsule radius=\"0.5\" length=\"3\"/></geometry></collision>"
      "<collision><geometry><mesh filename=\"x.stl\"/></geometry></collision></link>";
  std::string a = link("a");
  a.replace(a.find("</link>"), 7, collisions);
  Model m;
  const Robot r = add_urdf(m, options(write_urdf("shapes", a), RobotOptions::Base::free));
  ASSERT_EQ(m.bodies[0].shapes.size(), 4u);
  EXPECT_EQ(m.bodies[0].shapes[0].size, Vector3<double>(1, 2, 3));
  EXPECT_EQ(m.bodies[0].shapes[3].kind, Shape::Kind::capsule);
  EXPECT_EQ(m.bodies[0].shapes[3].size[1], 1.5);
  ASSERT_EQ(r.notes.size(), 1u);
  EXPECT_NE(r.notes[0].find("1 collision meshes"), std::string::npos);
}

// Masses as published, to their last digit.
TEST(Urdf, robots_of_the_library_weigh_what_they_should) {
  const std::pair<const char*, double> robots[] = {{"go2_standing", 15.206}, {"g1_standing", 33.341}, {"cassie", 33.312}};
  for (const auto& [scene, expected] : robots) {
    double mass = 0;
    for (const Body& b : open_scene(scene).model.bodies) mass += b.mass;
    EXPECT_EQ(std::round(1000 * mass), std::round(1000 * expected)) << scene;
  }
}

TEST(Urdf, a_long_chain_does_not_exhaust_the_stack) {
  std::string body = link("l0");
  const int links = 20000;
  for (int k = 1; k < links; ++k)
    body += link("l" + std::to_string(k)) + joint("j" + std::to_string(k), "continuous", "l" + std::to_string(k - 1), "l" + std::to_string(k));
  Model m;
  add_urdf(m, options(write_urdf("chain", body)));
  EXPECT_EQ(m.dofs(), links - 1);
}

}  // namespace
}  // namespace delassus::urdf_test
