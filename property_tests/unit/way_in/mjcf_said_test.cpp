// Robots from MJCF: what is left out is said, what is wrong is refused, newer files are read.
#include <gtest/gtest.h>

#include "property_tests/unit/way_in/mjcf_text.h"

namespace delassus::mjcf_said_test {
namespace {

using namespace mjcf_test;

using Kind = Constraint::Kind;

TEST(Mjcf, what_is_left_out_is_said) {
  RobotOptions o = options(mjcf("said", std::string(tree) + closures + "<actuator><motor joint=\"knee\"/></actuator>"));
  const Read r = read(o);
  EXPECT_TRUE(said(r.robot.notes, "\"off\" is left out: it is not active"));
  EXPECT_TRUE(said(r.robot.notes, "1 actuator(s)"));
  EXPECT_TRUE(said(r.robot.notes, "plane(s)"));
  EXPECT_TRUE(said(r.robot.notes, "ellipsoid"));
  ASSERT_EQ(r.robot.warnings.size(), 1u);
  EXPECT_EQ(r.robot.warnings[0].kind, "curved coupling");
  o.strict = true;
  EXPECT_THROW(static_cast<void>(read(o)), ModelError);
}

TEST(Mjcf, what_mujoco_refuses_is_refused_in_its_words) {
  EXPECT_NE(refusal(mjcf("unknown", "<worldbody><bdy/></worldbody>")).find("unrecognized"), std::string::npos);
  EXPECT_NE(refusal(mjcf("massless", "<worldbody><body><joint/></body></worldbody>")).find("mass and inertia"), std::string::npos);
  EXPECT_NE(refusal(mjcf("nobody", "<worldbody/><equality><connect body1=\"x\" anchor=\"0 0 0\"/></equality>")).find("unknown element"), std::string::npos);
  for (const char* text : {"", "<?xml version=\"1.0\"?>", "<!-- nothing -->", "</a>", "<mujoco>", "<mujocoinclude/>", "<robot/>", "<mujoco><worldbody><body></mujoco>"})
    EXPECT_NE(refusal(write("broken.xml", text)), "") << text;
  EXPECT_NE(refusal("/nowhere/robot.xml"), "");
  const std::string long_turn = "<worldbody><body name=\"b\" quat=\"1e308 0.1 0 0\"><joint/><geom size=\"1\"/></body></worldbody>";
  EXPECT_NE(refusal(mjcf("long_turn", long_turn)).find("body \"b\" quat"), std::string::npos);
}

TEST(Mjcf, missing_meshes_are_left_out_when_no_inertia_needs_them) {
  const auto with = [&](const std::string& inertial) {
    return mjcf("missing", "<asset><mesh name=\"m\" file=\"missing.stl\"/><texture name=\"t\" type=\"2d\" file=\"missing.png\"/><material name=\"w\" texture=\"t\"/></asset><worldbody><body name=\"a\"><joint/>" +
                               inertial + "<geom type=\"mesh\" mesh=\"m\" material=\"w\"/><geom type=\"box\" size=\"1 1 1\" material=\"w\" mass=\"1\"/></body></worldbody>");
  };
  const std::string given = with("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>");
  const Read r = read(options(given));
  EXPECT_EQ(r.robot.warnings.size(), 2u);  // the mesh and its geom; textures do not matter
  EXPECT_EQ(r.model.bodies[0].shapes.size(), 1u);
  EXPECT_EQ(r.model.bodies[0].mass, 1);
  expect_agreement("without meshes", options(given), r);
  write("missing.stl", "version https://git-lfs.github.com/spec/v1\n");
  EXPECT_EQ(read(options(given)).robot.warnings.size(), 2u);
  EXPECT_NE(refusal(with("")).find("inertia of its body"), std::string::npos);
}

TEST(Mjcf, what_stands_on_the_world_needs_no_mesh_for_its_inertia) {
  RobotOptions o = options(mjcf("stand", "<asset><mesh name=\"m\" file=\"nowhere.stl\"/></asset><worldbody><body name=\"foot\"><geom type=\"mesh\" mesh=\"m\"/>"
      "<body name=\"arm\"><joint/><geom type=\"sphere\" size=\"0.1\"/></body></body></worldbody>"));
  const Read r = read(o);
  EXPECT_EQ(r.model.dofs(), 1);
  EXPECT_EQ(r.robot.warnings.size(), 2u);
  o.base_given = true, o.base = RobotOptions::Base::free;
  EXPECT_THROW(static_cast<void>(read(o)), ModelError);
}

TEST(Mjcf, newer_files_are_read_without_what_does_not_matter) {
  const std::string limb = "<inertial pos=\"0 0 0.1\" mass=\"1\" diaginertia=\"1 1 1\"/><site name=\"";
  const std::string file = mjcf("newer", "<option integrator=\"implicitfast\"><flag island=\"enable\"/></option><size memory=\"1M\"/><compiler angle=\"radian\"/>"
      "<worldbody><light type=\"spot\"/><body name=\"a\" gravcomp=\"1\"><freejoint align=\"false\"/>" + limb + "s\" pos=\"0.1 0.2 0.3\"/>"
      "<body name=\"b\"><joint name=\"j\" range=\"-1 1\" actuatorfrcrange=\"-1 1\"/>" + limb + "t\" pos=\"0.4 0 0\" euler=\"0.1 0.2 0.3\"/>"
      "<body name=\"c\"><joint name=\"k\" axis=\"1 0 0\"/>" + limb + "u\"/></body></body></body></worldbody>"
      "<equality><connect name=\"p\" site1=\"s\" site2=\"t\"/><weld site1=\"u\" site2=\"s\" active=\"false\"/><joint joint1=\"j\" joint2=\"k\" polycoef=\"0.5\"/></equality>"
      "<actuator><position joint=\"j\" dampratio=\"1\"/></actuator>");
  Read r = read(options(file));
  EXPECT_TRUE(said(r.robot.notes, "refuses the file"));
  EXPECT_EQ(body(r.model, "b").joint.upper, std::vector<double>{1});
  EXPECT_EQ(r.robot.mimics.at(0).multiplier, 1);
  EXPECT_EQ(r.robot.mimics.at(0).offset, 0.5);
  ASSERT_EQ(r.model.constraints.size(), 2u);
  const Constraint& p = constraint(r.model, "p");
  EXPECT_EQ(p.kind, Kind::point);
  EXPECT_EQ(p.a.placement.translation, Vector3<double>(0.1, 0.2, 0.3));
  EXPECT_EQ(p.b.body, r.robot.links.at("b").body);
  expect_agreement("newer", options(file), r);
  EXPECT_TRUE(said(r.robot.notes, "\"sites u - s\" is left out: it is not active"));
}

TEST(Mjcf, tendons_without_a_row_are_left_out_with_a_warning) {
  const Read r = read(options(mjcf("tendons", std::string(tree) + "<tendon><fixed name=\"t\"><joint joint=\"knee\" coef=\"1\"/><joint joint=\"wrist\" coef=\"1\"/></fixed></tendon><equality><tendon tendon1=\"t\"/></equality>")));
  EXPECT_TRUE(r.model.constraints.empty());
  ASSERT_EQ(r.robot.warnings.size(), 1u);
  EXPECT_EQ(r.robot.warnings[0].kind, "spatial tendon");
}

TEST(Mjcf, equalities_that_a_flag_switches_off_are_left_out_with_a_warning) {
  const Read r = read(options(mjcf("switched", "<option><flag equality=\"disable\"/></option>" + std::string(fourbar))));
  EXPECT_TRUE(r.model.constraints.empty());
  ASSERT_EQ(r.robot.warnings.size(), 1u);
  EXPECT_EQ(r.robot.warnings[0].kind, "equalities switched off");
}

}  // namespace
}  // namespace delassus::mjcf_said_test
