// Small robots from the field, one per kind of file that was once misread, refused or read in silence.
#include <gtest/gtest.h>

#include <fstream>

#include "property_tests/unit/way_in/temporary.h"
#include "models/scene.h"
#include "models/formats/urdf_check.h"
#include "reference/definition.h"

namespace delassus::field_test {
namespace {

const std::string sphere_of_0_1 = R"(<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>)";

std::string inertial(const std::string& xyz, const std::string& mass, const std::string& inertia = sphere_of_0_1) {
  return "<inertial><origin xyz=\"" + xyz + "\" rpy=\"0 0 0\"/><mass value=\"" + mass + "\"/>" + inertia + "</inertial>";
}
std::string link(const std::string& name, const std::string& inside) { return "<link name=\"" + name + "\">" + inside + "</link>\n"; }
const std::string base = link("base", inertial("0 0 0", "1"));
const std::string b = link("b", inertial("0 0 -0.5", "2"));
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child, const std::string& more) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}
std::string turning(const std::string& limit = R"(lower="-9" upper="9" effort="1" velocity="1")") {
  return joint("j", "revolute", "base", "b", R"(<axis xyz="0 1 0"/><limit )" + limit + "/>");
}

/// A scene `robots: [{name: r, urdf: …, <more>}]` with the robot's links and joints written to a file.
Scene scene_of(const std::string& inside, const std::string& more = ", base: fixed", const std::string& top = "") {
  std::ofstream(test::temporary("field.urdf")) << "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" << inside << "</robot>\n";
  const auto file = test::temporary("field.yaml");
  std::ofstream(file) << top << "robots:\n  - {name: r, urdf: field.urdf" << more << "}\nconstraints:\n  - {kind: joint_friction, robot: r}\n";
  return load_scene(file.string());
}

MatrixX<double> mass_matrix(const Scene& s) { return reference::mass_matrix(problem_of(s)); }
/// M of one joint, to 30 ε of it.
void expect_mass(const Scene& s, double expected) {
  const MatrixX<double> M = mass_matrix(s);
  ASSERT_EQ(M.rows(), 1);
  EXPECT_LE(std::abs(M(0, 0) - expected), 30 * 0x1p-53 * expected) << M(0, 0);
}

/// The one warning of a scene, which is an error in strict mode.
void expect_warning(const std::string& inside, const std::string& kind, const std::vector<std::string>& parts, const std::string& more = ", base: fixed") {
  const Scene s = scene_of(inside, more);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_EQ(s.warnings[0].kind, kind);
  for (const std::string& part : parts) EXPECT_NE(s.warnings[0].text.find(part), std::string::npos) << s.warnings[0].text;
  EXPECT_THROW(scene_of(inside, more, "strict: true\n"), ModelError) << kind;
}

void expect_note(const Scene& s, const std::vector<std::string>& parts) {
  bool found = false;
  std::string all;
  for (const std::string& note : s.notes) {
    bool every = true;
    for (const std::string& part : parts) every = every && note.find(part) != std::string::npos;
    found = found || every;
    all += note + "\n";
  }
  EXPECT_TRUE(found) << parts[0] << " is not among the notes:\n" << all;
}

// M = I_yy + 2 (0.1² + 0.3²) + 0.1 + 1.3² = 2.19.
TEST(Field, blanks_around_numbers_change_nothing) {
  const auto robot = [](const std::string& xyz, const std::string& mass, const std::string& iyy) {
    return base + link("b", inertial(xyz, mass, "<inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"" + iyy + "\" iyz=\"0\" izz=\"0.15\"/>")) +
           link("c", inertial("0 0 -0.3", "1")) + turning() + joint("k", "fixed", "b", "c", R"(<origin xyz="0 0 -1"/>)");
  };
  const Scene plain = scene_of(robot("0.1 0.2 0.3", "2", "0.2"));
  expect_mass(plain, 2.19);
  for (const auto& written : {robot("0.1 0.2 0.3", "2 ", "0.2"), robot("0.1 0.2 0.3", "2", "0.2 "), robot("0.1\t0.2\t0.3", "2", "0.2"),
                              robot("0.1\n     0.2 0.3", "2", "0.2"), robot("0.1&#9;0.2&#10;0.3", "+2.0e0", " .2")})
    EXPECT_EQ(mass_matrix(scene_of(written))(0, 0), mass_matrix(plain)(0, 0)) << written;
}

// Each number of the text that urdfdom is given, changed by one unit: the two readings must disagree, loudly.
TEST(Field, another_reading_of_any_number_is_refused) {
  const std::string inside =
      link("a", R"(<inertial><origin xyz="31 32 33" rpy="0.34 0.35 0.36"/><mass value="37"/><inertia ixx="71" ixy="1.5" ixz="2.5" iyy="72" iyz="3.5" izz="73"/></inertial>)") +
      link("b", inertial("0 0 0", "1")) + link("c", inertial("0 0 0", "1")) + joint("k", "continuous", "a", "c", "") +
      joint("j", "revolute", "a", "b", R"(<origin xyz="41 42 43" rpy="0.44 0.45 0.46"/><axis xyz="51 52 53"/><limit lower="-61" upper="62" effort="63" velocity="64"/>)"
                                       R"(<dynamics damping="65" friction="66"/><mimic joint="k" multiplier="67" offset="68"/>)");
  std::ofstream(test::temporary("field.urdf")) << "<robot name=\"r\">\n" << inside << "</robot>\n";
  const std::string file = test::temporary("field.urdf").string();
  Findings findings;
  const CheckedUrdf checked = check_urdf(file, findings);
  EXPECT_NO_THROW((void)read_by_urdfdom(checked, findings));
  for (const char* number : {"31", "32", "33", "0.34", "0.35", "0.36", "37", "71", "1.5", "2.5", "72", "3.5", "73", "41", "42", "43", "0.44", "0.45",
                             "0.46", "51", "52", "53", "-61", "62", "63", "64", "65", "66", "67", "68"}) {
    CheckedUrdf other = checked;
    const std::size_t at = other.text.find(number);
    ASSERT_NE(at, std::string::npos) << number;
    other.text.insert(at + std::string(number).size(), number[1] == '.' || number[2] == '.' ? "001" : ".5");
    EXPECT_THROW((void)read_by_urdfdom(other, findings), ModelError) << number;
  }
  CheckedUrdf other = checked;
  other.text.replace(other.text.find("37"), 2, "37 ");  // urdfdom drops the inertial and says so
  EXPECT_THROW((void)read_by_urdfdom(other, findings), ModelError);
}

TEST(Field, fixed_joints_have_no_axis_limits_or_mimic) {
  const std::string tool = link("tool", "");
  for (const char* more : {R"(<axis xyz="0 0 0"/>)", R"(<axis xyz="0 0 1"/><limit lower="0.5" upper="-0.5" effort="1" velocity="1"/>)",
                           R"(<axis xyz="0 0 1"/><mimic joint="j"/>)", R"(<axis/><dynamics damping="-1" friction="x"/><limit lower="?"/>)"}) {
    const Scene s = scene_of(base + b + tool + joint("f", "fixed", "b", "tool", more) + turning());
    expect_mass(s, 0.1 + 2 * 0.25);
    EXPECT_TRUE(s.warnings.empty()) << more;
    EXPECT_EQ(s.model.constraints.size(), 1u) << more;
  }
  expect_note(scene_of(base + b + tool + joint("f", "fixed", "b", "tool", R"(<mimic joint="j"/>)") + turning()), {"\"f\"", "<mimic>"});
}

TEST(Field, an_inertia_without_mass_on_a_fixed_link_is_merged) {
  const auto robot = [](const std::string& moment) {
    return base + b + link("c", inertial("0 0 0", "0", "<inertia ixx=\"" + moment + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + moment + "\" iyz=\"0\" izz=\"" + moment + "\"/>")) +
           joint("f", "fixed", "b", "c", "") + turning();
  };
  expect_mass(scene_of(robot("1e-9")), 0.6 + 1e-9);
  expect_mass(scene_of(robot("0.25")), 0.85);
  expect_warning(robot("1e-9"), "inertia without mass", {"link \"c\" <inertial> (line 5)", "mass 0 kg"});
  // On a moving link of its own it is the whole inertia.
  const std::string alone = base + link("b", inertial("0 0 7", "0")) + turning();
  expect_mass(scene_of(alone), 0.1);
}

TEST(Field, effort_and_velocity_enter_nothing) {
  for (const char* limit : {R"(lower="-9" upper="9" effort="-1.0" velocity="1")", R"(lower="-9" upper="9" effort="inf" velocity="-3")", R"(lower="-9" upper="9")"}) {
    const Scene s = scene_of(base + b + turning(limit));
    expect_mass(s, 0.6);
    EXPECT_TRUE(s.warnings.empty());
    EXPECT_TRUE(s.model.bodies[0].joint.effort.empty()) << limit;
    EXPECT_EQ(s.model.bodies[0].joint.upper, std::vector<double>{9});
  }
  expect_note(scene_of(base + b + turning(R"(lower="-9" upper="9" effort="-1.0" velocity="1")")), {"negative, taken as no limit", "\"j\" <limit> (line 5) effort = -1"});
}

TEST(Field, point_masses_and_thin_rods_swing) {
  const std::string point = base + link("b", inertial("0 0 -0.5", "2", R"(<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>)")) + turning();
  expect_mass(scene_of(point), 0.5);
  expect_warning(point, "point mass", {"link \"b\" <inertial> (line 4)", "2 kg"});
  const std::string rod = base + link("b", inertial("0 0 -0.5", "2", R"(<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0"/>)")) + turning();
  expect_mass(scene_of(rod), 0.6);
  expect_warning(rod, "thin rod", {"link \"b\"", "(0 0.1 0.1)"});
}

/// The refusal of M, which names body, joint and file.
void expect_singular(const std::string& inside, const std::string& more, const std::vector<std::string>& parts) {
  try {
    (void)scene_of(inside, more);
    ADD_FAILURE() << "accepted: " << inside;
  } catch (const ModelError& e) {
    for (const std::string& part : parts) EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(Field, what_makes_the_inertia_matrix_singular_is_refused_by_name) {
  const std::string none = R"(<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>)";
  const std::string rod_z = R"(<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0"/>)";
  const std::string rod_y = R"(<inertia ixx="0.1" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.1"/>)";
  const std::string at_axis = base + link("b", inertial("0 0.3 0", "2", none)) + turning();  // on the axis of the joint
  expect_singular(at_axis, ", base: fixed", {"field.urdf", "r/b", "r/j", "point mass of 2 kg", "singular"});
  expect_mass(scene_of(at_axis, ", base: fixed, armature: 0.01"), 0.01);
  expect_mass(scene_of(base + link("b", inertial("0 0 0", "2", rod_z)) + turning()), 0.1);
  expect_singular(base + link("b", inertial("0 0 0", "2", rod_y)) + turning(), ", base: fixed", {"r/b", "singular"});
  expect_singular(link("b", inertial("0 0 0.3", "2", none)), "", {"r/b", "r/base", "singular"});  // a point mass floats
  EXPECT_EQ(scene_of(link("base", inertial("0 0 0.3", "2", none)) + b + turning(), "").model.dofs(), 7);  // with a body it does not
}

TEST(Field, what_makes_the_inertia_matrix_indefinite_is_refused_by_name) {
  const auto negative = [](const std::string& xyz, const std::string& izz) {
    return base + link("b", inertial(xyz, "2", "<inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"" + izz + "\" iyz=\"0\" izz=\"0.1\"/>")) + turning();
  };
  expect_singular(negative("0 0 0", "-0.2"), ", base: fixed", {"field.urdf", "r/b", "-0.2", "indefinite"});
  expect_singular(negative("0 0 -0.3", "-0.2"), ", base: fixed", {"indefinite"});  // -0.2 + 2 · 0.09
  expect_mass(scene_of(negative("0 0 -0.5", "-0.2")), 0.3);
  expect_warning(negative("0 0 -0.5", "-0.2"), "negative principal moment", {"(-0.2 0.1 0.1)", "by 1 of the largest"});
  expect_warning(negative("0 0 -0.5", "-1e-9"), "negative principal moment", {"(-1e-09 ", "by 1e-08 of the largest"});
  expect_singular(negative("0 0 -0.5", "-0.2"), "", {"r/b", "indefinite"});  // on a floating base
  expect_singular(base + link("b", inertial("0 0 0", "-2")) + turning(), ", base: fixed", {"-2 kg is negative"});
}

TEST(Field, the_triangle_inequality_is_doubtful_only) {
  const auto robot = [](const std::string& inertia) { return base + link("b", inertial("0 0 -0.05", "0.12", inertia)) + turning(); };
  const std::string talos = robot(R"(<inertia ixx="0.000115" ixy="0.000052" ixz="0.000025" iyy="0.000153" iyz="0.000034" izz="0.00019"/>)");
  expect_mass(scene_of(talos), 0.000153 + 0.12 * 0.05 * 0.05);
  expect_warning(talos, "triangle inequality", {"link \"b\" <inertial> (line 4)", "the largest exceeds the sum of the others"});
  const std::string rounded = robot(R"(<inertia ixx="1.00000000000e-06" ixy="0" ixz="0" iyy="1.0e-06" iyz="0" izz="2.000000000005e-06"/>)");
  expect_warning(rounded, "triangle inequality", {"2.000000000005e-06"});
}

TEST(Field, collision_shapes_of_no_size) {
  const auto robot = [](const std::string& shape) {
    return base + link("b", inertial("0 0 -0.5", "2") + "<collision><geometry>" + shape + "</geometry></collision>") + turning();
  };
  const std::string ground = "ground: {z: -2}\ncontacts: {detect: true, margin: 3}\n";
  const Scene point = scene_of(robot(R"(<sphere radius="0.0"/>)"), ", base: fixed", ground);
  ASSERT_EQ(point.model.constraints.size(), 2u);
  EXPECT_EQ(point.model.constraints[1].a.placement.translation, Vector3<double>(0, 0, -2));
  EXPECT_TRUE(point.warnings.empty());
  const Scene nothing = scene_of(robot(R"(<box size="0 0 0"/>)"), ", base: fixed", ground);
  EXPECT_EQ(nothing.model.constraints.size(), 1u);
  expect_note(nothing, {"touches nothing"});
  EXPECT_EQ(scene_of(robot(R"(<capsule radius="0" length="1"/>)"), ", base: fixed", ground).model.constraints.size(), 3u);
  EXPECT_EQ(scene_of(robot(R"(<capsule radius="0.1" length="0"/>)"), ", base: fixed", ground).model.constraints.size(), 2u);
  expect_warning(robot(R"(<box size="1 1 0"/>)"), "flat collision shape", {"box"});
  expect_warning(robot(R"(<cylinder radius="0" length="1"/>)"), "flat collision shape", {"cylinder"});
}

TEST(Field, an_angle_outside_its_limits_is_told) {
  const std::string robot = base + b + turning(R"(lower="-1" upper="1" effort="1" velocity="1")");
  expect_warning(robot, "angle outside its limits", {"field.yaml:2", "joint j = 57.3 rad lies outside its limits -1 to 1", "degrees"}, ", base: fixed, joints: {j: 57.3}");
  EXPECT_TRUE(scene_of(robot, ", base: fixed, joints: {j: 1}").warnings.empty());
  expect_note(scene_of(base + b + turning(R"(lower="0.5" upper="1" effort="1" velocity="1")")), {"j = 0 (0.5 to 1)"});
}

TEST(Field, a_reversed_range_is_no_range) {
  const std::string robot = base + b + turning(R"(lower="1" upper="-1" effort="1" velocity="1")");
  expect_warning(robot, "reversed limits", {"joint \"j\" <limit> (line 5)", "lower = 1", "upper = -1"});
  EXPECT_TRUE(scene_of(robot).model.bodies[0].joint.lower.empty());
  expect_warning(base + b + joint("j", "revolute", "base", "b", R"(<axis xyz="0 1 0"/>)"), "no limits", {"joint \"j\" (line 5)"});
}

TEST(Field, elements_that_mean_something_are_not_dropped_in_silence) {
  const std::string robot = base + b + turning();
  expect_warning(robot + "<xacro:leg prefix=\"fl\"/>\n", "unexpanded xacro", {"xacro:leg is not expanded", "run xacro first", "line 6"});
  expect_warning(base + link("b", inertial("0 0 -0.5", "2") + "<xacro:more/>") + turning(), "unexpanded xacro", {"xacro:more", "link \"b\""});
  expect_warning(robot + link("c", inertial("0 0 0", "1")) + joint("k", "continuous", "base", "c", "") +
                     "<loop_joint name=\"l\" type=\"revolute\"><link1 link=\"b\"/><link2 link=\"c\"/></loop_joint>\n",
                 "loop left out", {"loop_joint \"l\"", "constraint of the scene"});
  expect_warning(robot + "<gazebo><joint name=\"l\"/></gazebo>\n", "loop left out", {"<gazebo>"});
  expect_note(scene_of(robot + "<transmission name=\"t\"><actuator name=\"m\"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>\n"),
              {"1 transmission has", "\"50\"", "armature"});
  const Scene s = scene_of(robot + "<gazebo reference=\"b\"/><gazebo/><transmission name=\"t\"><actuator><mechanicalReduction>1</mechanicalReduction></actuator></transmission>\n");
  EXPECT_TRUE(s.warnings.empty());
  expect_note(s, {"\"gazebo\" (2, first in line 6)", "\"transmission\" (line 6)"});
  expect_note(scene_of(base + link("b", inertial("0 0 -0.5", "2") + "<contact><lateral_friction value=\"1\"/></contact>") + turning()), {"\"link/contact\""});
  expect_note(scene_of(base + b + turning(R"(lower="-9" upper="9" acceleration="3")")), {"\"limit acceleration=\""});
  expect_warning(base + link("b", inertial("0 0 -0.5", "2") + inertial("0 0 -0.5", "3")) + turning(), "given twice", {"<inertial>"});
}

TEST(Field, a_mimic_of_a_fixed_joint_is_told) {
  const std::string c = link("c", inertial("0 0 0", "1")) + joint("f", "fixed", "b", "c", "");
  expect_warning(base + b + c + joint("j", "continuous", "base", "b", R"(<mimic joint="f"/>)"), "mimic of a fixed joint", {"\"j\"", "\"f\""});
}

TEST(Field, a_root_named_world_does_not_move) {
  const std::string robot = link("world", "") + base + b + joint("w", "fixed", "world", "base", "") + turning();
  const Scene s = scene_of(robot, "");
  EXPECT_EQ(s.model.dofs(), 1);
  EXPECT_TRUE(s.warnings.empty());
  expect_note(s, {"link \"world\"", "the base is fixed"});
  EXPECT_EQ(scene_of(robot, ", base: free").model.dofs(), 7);
  expect_warning(robot, "moving world", {"link \"world\"", "base: fixed"}, ", base: free");
  EXPECT_TRUE(scene_of(robot, ", base: fixed").warnings.empty());
}

TEST(Field, one_armature_for_a_whole_robot) {
  const std::string robot = base + link("b", "") + link("c", "") + turning() +
                            joint("k", "continuous", "b", "c", R"(<dynamics armature="0.25"/>)");
  EXPECT_THROW((void)scene_of(robot), ModelError);
  const MatrixX<double> M = mass_matrix(scene_of(robot, ", base: fixed, armature: 0.5"));
  EXPECT_EQ(M, (MatrixX<double>(2, 2) << 0.5, 0, 0, 0.25).finished());
}

TEST(Field, a_robot_file_is_a_scene) {
  std::ofstream(test::temporary("arm.urdf")) << "<robot name=\"r\">\n" << base << b << turning() << "</robot>";
  const std::string file = test::temporary("arm.urdf").string();
  const Scene free = open_scene(file);
  EXPECT_EQ(free.model.dofs(), 7);
  ASSERT_EQ(free.robots.size(), 1u);
  EXPECT_EQ(free.robots[0].name, "arm");
  std::ofstream(test::temporary("arm.urdf")) << "<robot name=\"r\">\n" << link("world", "") << base << b << joint("w", "fixed", "world", "base", "") << turning() << "</robot>";
  EXPECT_EQ(open_scene(file).model.dofs(), 1);  // no base is asked for
  std::ofstream(test::temporary("arm.urdf")) << "<robot name=\"r\">\n" << base << b << turning() << "</robot>";
  const Scene fixed = open_scene(file, {.strict = true, .base = RobotOptions::Base::fixed, .armature = 0.125});
  EXPECT_EQ(mass_matrix(fixed), mass_matrix(scene_of(base + b + turning(), ", base: fixed, armature: 0.125")));
  EXPECT_THROW((void)open_scene("go2_standing", {.strict = false, .base = RobotOptions::Base::fixed, .armature = {}}), ModelError);
  EXPECT_NO_THROW((void)open_scene("go2_standing", {.strict = true, .base = {}, .armature = {}}));
}

}  // namespace
}  // namespace delassus::field_test
