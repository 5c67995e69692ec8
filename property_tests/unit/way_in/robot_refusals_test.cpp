// What is wrong with a robot's file: every refusal names the file, the line, the value, what is accepted and what to do; and,
// inside a scene, where the scene asks for the file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::robot_refusals_test {
namespace {

struct Refusal {
  std::string text;                  ///< of the robot's file
  int line;                          ///< of it, that the message names; 0: what is asked of the file is wrong
  std::string value, accepted, to_do;
  std::string asked = {};            ///< more keys of the scene's entry, `, base: free`
  int scene_line = 2;                ///< that the message names
};

std::string written(const std::string& name, const std::string& text) {
  const auto file = test::temporary("robot_refusals/" + name);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
  return file.string();
}

template <class F> std::string message_of(const F& f) {
  try {
    f();
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

/// The five parts, in a scene and, where nothing is asked for, of the file alone.
void expect_parts(const std::string& name, const Refusal& r) {
  const std::string robot = written(name, r.text);
  const std::string scene = written("scene.yaml", "robots:\n  - {name: r, file: " + name + r.asked + "}\n");
  const std::string said = message_of([&] { (void)load_scene(scene); });
  ASSERT_NE(said, "") << "accepted: " << r.value;
  EXPECT_EQ(said.rfind(robot + ": ", 0), 0u) << said;
  if (r.line > 0) {
    EXPECT_NE(said.find("line " + std::to_string(r.line)), std::string::npos) << said;
  }
  EXPECT_NE(said.find(r.value), std::string::npos) << r.value << " is not in\n" << said;
  const std::size_t accepted = said.find(" (accepted: "), end = said.rfind("), read for " + scene + ":" + std::to_string(r.scene_line) + ": robots[0]");
  ASSERT_NE(accepted, std::string::npos) << said;
  ASSERT_NE(end, std::string::npos) << said;
  const std::string advice = said.substr(accepted, end - accepted);
  EXPECT_NE(advice.find(r.accepted), std::string::npos) << said;
  const std::size_t then = advice.find("; ");
  ASSERT_NE(then, std::string::npos) << said;
  EXPECT_NE(advice.find(r.to_do, then), std::string::npos) << said;
  if (!r.asked.empty()) return;
  const std::string alone = message_of([&] { (void)load_robot(robot); });
  EXPECT_EQ(alone + said.substr(end + 1), said);
}

/// Whether a file of the format can be read in this build; the message otherwise names the package.
bool is_read(const std::string& name, const std::string& text, const std::string& package) {
  const std::string said = message_of([&] { (void)load_robot(written(name, text)); });
  if (said.find("built without") == std::string::npos) return true;
  EXPECT_NE(said.find("install " + package), std::string::npos) << said;
  return false;
}

const std::string inertial = R"(<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
std::string urdf(const std::string& joints) {
  return "<robot name=\"r\">\n<link name=\"a\">" + inertial + "</link>\n<link name=\"b\">" + inertial + "</link>\n<link name=\"c\">" + inertial + "</link>\n" + joints + "</robot>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child, const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}

TEST(RobotRefusals, urdf) {
  const std::string shoulder = joint("shoulder", "continuous", "a", "b"), elbow = joint("elbow", "continuous", "b", "c");
  const auto follower = [&](const std::string& master) { return shoulder + joint("elbow", "continuous", "b", "c", "<mimic joint=\"" + master + "\"/>"); };
  const std::string massless = "<robot name=\"r\">\n<link name=\"a\">" + inertial + "</link>\n<link name=\"b\"/>\n" + shoulder + "</robot>";
  for (const Refusal& r : std::vector<Refusal>{
           {urdf(follower("sholder")), 6, "\"sholder\" does not exist", "did you mean shoulder? a moving joint", "correct the name"},
           {urdf(follower("elbow")), 6, "\"elbow\", itself", "another moving joint", "take the <mimic> out"},
           {urdf(joint("shoulder", "planar", "a", "b") + joint("elbow", "continuous", "b", "c", "<mimic joint=\"shoulder\"/>")), 6, "\"shoulder\" has 3 degrees of freedom",
            "joints with one degree of freedom", "coupling of the scene"},
           {urdf(shoulder + elbow), 0, "\"sholder\" does not exist", "did you mean shoulder? ", "`delassus describe FILE` lists them", ",\n     armature: {\n       sholder: 1}", 4},
           {urdf(joint("shoulder", "fixed", "a", "b") + elbow), 0, "\"shoulder\" is fixed", "a moving joint", "leave this one out", ",\n     joint_types: {shoulder: spherical}", 3},
           {urdf(shoulder + elbow), 0, "is parallel to its axis, (1 0 0)", "two different directions", "turn axis2", ",\n     joint_types: {shoulder: {type: universal, axis2: [1, 0, 0]}}", 3},
           {urdf(shoulder + elbow), 0, "\"home\": a URDF file has no keyframes", "an MJCF file", "joints: {name: value}", ",\n     keyframe: home", 3},
           {"\n<rob/>", 2, "<rob>", "<robot> (URDF), <mujoco> (MJCF), <sdf> (SDF)", "a scene of robots is a .yaml file"}})
    expect_parts("robot.urdf", r);
  written("robot.urdf", massless);
  const std::string scene = written("scene.yaml", "robots:\n  - {name: r, file: robot.urdf}\n");
  const std::string said = message_of([&] { (void)load_scene(scene); });
  for (const std::string& part : {std::string("robot.urdf: r/b (line 3): "), ", read for " + scene + ":2: robots[0]"}) EXPECT_NE(said.find(part), std::string::npos) << said;
}

// Nothing in it says what it is; its name does.
TEST(RobotRefusals, a_robot_s_file_without_an_element) {
  for (const char* name : {"robot.urdf", "robot.sdf", "robot.xml"})
    for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{{"", "is empty"}, {" \n", "is empty"}, {"hello", "broken XML"}, {std::string("\0", 1), "NUL"}}) {
      const std::string file = written(name, text), said = message_of([&] { (void)open_scene(file); });
      EXPECT_EQ(said.find(file + ": "), 0u) << said;
      EXPECT_NE(said.find(part), std::string::npos) << said;
    }
}

std::string sdf(const std::string& inside) {
  const std::string body = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>\n";
  return "<sdf version='1.9'><model name='m'>\n<link name='a'>" + body + "<link name='b'>" + body + inside + "</model></sdf>\n";
}
std::string sdf_joint(const std::string& type, const std::string& parent, const std::string& child, const std::string& more) {
  return "<joint name='j_" + type + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child + "</child>" + more + "</joint>\n";
}

TEST(RobotRefusals, sdf) {
  if (!is_read("robot.sdf", sdf(""), "libsdformat-dev")) GTEST_SKIP() << "built without libsdformat";
  const std::string z = "<axis><xyz>0 0 1</xyz></axis>", turning = sdf_joint("revolute", "a", "b", z);
  for (const Refusal& r : std::vector<Refusal>{
           {"<sdf version='1.9'><model name='m'>\n<link name='a'><inertial>\n<mass>1e999</mass></inertial></link></model></sdf>", 3, "<mass> (line 3): \"1e999\"", "finite numbers", "correct the text"},
           {"\n<sdf version='1.9'/>", 2, "has no link", "a <model>", "mesh_path"},
           {sdf(sdf_joint("universal", "a", "b", z + "<axis2><xyz>0 0 1</xyz></axis2>")), 4, "(0 0 1) and (0 0 1), are parallel", "two independent axes", "turn <axis2>"},
           {sdf(sdf_joint("screw", "a", "b", z + "<thread_pitch>0</thread_pitch>")), 4, "thread_pitch is 0", "[rad/m] other than 0", "revolute joint"},
           {sdf(turning + sdf_joint("screw", "a", "b", z + "<thread_pitch>2</thread_pitch>")), 5, "a screw cannot close a loop", "other joints", "last in the file"},
           {sdf(turning + sdf_joint("universal", "a", "b", z + "<axis2><xyz>0 0.6 0.8</xyz></axis2>")), 5, "their cosine is 0.8", "perpendicular axes", "turn one"},
           {sdf(turning + sdf_joint("gearbox", "a", "b", "<gearbox_reference_body>a</gearbox_reference_body>" + z + "<axis2><xyz>0 0 1</xyz></axis2>")), 5, "\"a\" has no revolute joint",
            "one for the parent", "check <gearbox_reference_body>"},
           {sdf("<link name='c'><inertial><mass>1</mass></inertial></link>" + turning + "<joint name='k' type='revolute'><parent>a</parent><child>c</child>" + z + "</joint>\n<joint name='g' type='gearbox'><parent>b</parent><child>c</child>"
                "<gearbox_ratio>0</gearbox_ratio><gearbox_reference_body>a</gearbox_reference_body>" + z + "<axis2><xyz>0 0 1</xyz></axis2></joint>"), 6, "gearbox_ratio is 0", "a ratio other than 0", "fix the child's joint"},
           {"<sdf version='1.9'><model name='m'>\n<link name='a'>\n<collision name='c'><geometry><sphere><radius>-0.25</radius></sphere></geometry></collision></link></model></sdf>", 2, "-0.25",
            "", ""},
           {sdf(sdf_joint("revolut", "a", "b", z)), 4, "joint \"j_revolut\" (line 4): type \"revolut\" is none of SDF", "did you mean revolute? ball, ", "correct the type"},
           {sdf(sdf_joint("revolute", "a", "b", "\n<axis><xyz>0 0 0</xyz></axis>")), 5, "<xyz> (line 5): \"0 0 0\" is no direction", "a vector that is not 0", "give the axis"},
           {"<sdf version='1.9'><model name='m'>\n<link name='a::b'/></model></sdf>", 2, "link \"a::b\" (line 2)", "names without ::", "rename it"},
           {sdf(sdf_joint("revolute", "a", "zz", z)), 4, "joint \"j_revolute\" (line 4): libsdformat: Child frame with name[zz]", "an SDF file that libsdformat", "correct what it says"},
           {sdf("<joint name='j' type='ball'>\n<child>b</child></joint>"), 4, "joint \"j\" (line 4): has no <parent>", "a <parent> and a <child>", "write the link's name"},
           {sdf("<static>maybe</static>"), 4, "<static> (line 4): \"maybe\"; libsdformat: ", "an SDF file that libsdformat", "correct what it says"},
           {sdf("<link name='a'/>"), 2, "link \"a\" (line 2 or 4): libsdformat: link with name[a] already exists", "an SDF file that libsdformat", "correct what it says"},
           {sdf("<frame name='f' attached_to='g'/>\n<frame name='g' attached_to='f'/>"), 4, "frame \"m::f\" (line 4): libsdformat: FrameAttachedToGraph cycle", "an SDF file that libsdformat", "correct what it says"},
           {sdf(turning), 0, "\"j_revolut\" does not exist", "did you mean j_revolute? ", "`delassus describe FILE`", ",\n     armature: {j_revolut: 1}", 3},
           {sdf(turning + sdf_joint("ball", "a", "b", "")), 0, "\"j_ball\" closes a loop", "a moving joint", "leave this one out", ", armature: {j_ball: 1}"},
           {sdf(turning), 0, "SDF states the types", "no joint_types", "change <joint type>", ",\n     joint_types: {j_revolute: spherical}", 3}})
    expect_parts("robot.sdf", r);
  const std::string file = written("robot.sdf", sdf("<static>maybe</static>"));
  testing::internal::CaptureStderr();
  static_cast<void>(message_of([&] { (void)load_robot(file); }));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "libraries print beside the message";
}

TEST(RobotRefusals, sdf_warnings_have_lines) {
  if (!is_read("robot.sdf", sdf(""), "libsdformat-dev")) GTEST_SKIP() << "built without libsdformat";
  const Scene scene = load_robot(written("robot.sdf", sdf("\n<frame name='f' colour='3'/>")));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].text.find("frame \"f\" (line 5): XML Attribute[colour]"), std::string::npos) << scene.warnings[0].text;
}

TEST(RobotRefusals, axes_of_fixed_joints_are_nothing_to_refuse) {
  if (!is_read("robot.sdf", sdf(""), "libsdformat-dev")) GTEST_SKIP() << "built without libsdformat";
  for (const std::string axis : {"0 0 0", "nan 0 0", "x"})
    EXPECT_EQ(message_of([&] { (void)load_robot(written("robot.sdf", sdf(sdf_joint("fixed", "a", "b", "<axis><xyz>" + axis + "</xyz></axis>")))); }), "");
}

TEST(RobotRefusals, mjcf) {
  const std::string tree = "<mujoco>\n<worldbody>\n<body name='a'><joint name='shoulder'/><geom size='1'/></body>\n<body name='b'><geom size='1'/></body>\n</worldbody>\n";
  if (!is_read("robot.xml", tree + "</mujoco>", "libmujoco-dev")) GTEST_SKIP() << "built without MuJoCo";
  const std::string keys = "<keyframe><key name='home' qpos='1'/></keyframe>", mesh = "<asset><mesh name='m' file='none.stl'/></asset>\n<worldbody>\n<body name='a'>";
  for (const Refusal& r : std::vector<Refusal>{
           {"<mujoco>\n<worldbody>\n<bdy/></worldbody></mujoco>", 3, "unrecognized element", "a file that MuJoCo", "give the robot as URDF"},
           {"<mujoco>\n<worldbody>\n<body name='b'><joint/>\n<inertial pos='0 0 0' mass='1e999' diaginertia='1 1 1'/></body></worldbody></mujoco>", 4,
            "<inertial> (line 4): mass \"1e999\" is beyond the range of double", "finite numbers", "check the exponent"},
           {"<mujoco>\n<worldbody>\n<body name='b' pos='0 1,5 0'><joint/><geom size='1'/></body></worldbody></mujoco>", 3,
            "body \"b\" (line 3): pos \"0 1,5 0\": \"1,5\" is no number", "finite numbers", "decimal point"},
           {"<mujoco>\n<worldbody>\n<body name='b'><joint/>\n<inertial pos='0 0' mass='1' diaginertia='1 1 1'/></body></worldbody></mujoco>", 4,
            "<inertial> (line 4): pos \"0 0\"; MuJoCo: ", "a file that MuJoCo", "correct what it says"},
           {"<mujoco>\n<worldbody>\n<body name='b'><joint/>\n<inertial pos='0 0 0' mass='-1' diaginertia='1 1 1'/></body></worldbody></mujoco>", 3,
            "its <inertial> (line 4) has pos \"0 0 0\" mass \"-1\"", "a file that MuJoCo", "correct what it says"},
           {tree + "<equality>\n<connect body1='a' body2='c' anchor='0 0 0'/></equality></mujoco>", 7, "unknown element 'c'", "a file that MuJoCo", "correct what it says"},
           {"\n<mujocoinclude/>", 2, "<mujocoinclude>", "<mujoco> (MJCF)", "a scene of robots"},
           {"<mujoco>\n" + mesh + "<joint/>\n<geom type='mesh' mesh='m'/></body></worldbody></mujoco>", 5, "mesh \"m\" (line 5)", "the file in its place", "<inertial>"},
           {"<mujoco>\n" + mesh + "\n<geom type='mesh' mesh='m'/></body></worldbody></mujoco>", 4, "body \"a\" (line 4)", "the files in their places", "base: fixed", ", base: free"},
           {tree + "<equality>\n<connect name='e' site1='x' site2='y'/></equality></mujoco>", 7, "\"x\" does not exist", "a site of this file", "correct the name"},
           {tree + keys + "</mujoco>", 0, "\"hom\" does not exist", "did you mean home? home", "take one of these", ",\n     keyframe: hom", 3},
           {tree + "</mujoco>", 0, "\"home\" does not exist", "no keyframe", "joints: {name: value}", ", keyframe: home"},
           {tree + "</mujoco>", 0, "\"sholder\" does not exist", "did you mean shoulder? ", "`delassus describe FILE`", ",\n     armature: {sholder: 1}", 3},
           {tree + "</mujoco>", 0, "MJCF states the types", "no joint_types", "change <joint type>", ", joint_types: {shoulder: spherical}"},
           {tree + "</mujoco>", 0, "a (on joints of its own), b (fixed)", "one root that is free or fixed", "leave base out", ",\n     base: free", 3}})
    expect_parts("robot.xml", r);
}

}  // namespace
}  // namespace delassus::robot_refusals_test
