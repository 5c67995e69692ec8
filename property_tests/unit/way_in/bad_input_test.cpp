// Input that cannot be right: always a ModelError that names file, element and value, never a crash, never output.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "property_tests/unit/way_in/temporary.h"
#include "models/scene.h"
#include "models/formats/urdf.h"

namespace delassus::bad_input_test {
namespace {

std::string write(const std::string& name, const std::string& text) {
  const auto file = delassus::test::temporary("delassus_bad_" + name);
  std::ofstream(file, std::ios::binary) << text;
  return file.string();
}

/// The message of the ModelError that `f` throws; fails when it throws none, or prints.
template <class F> std::string complaint(const std::string& what, const F& f) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::string message;
  try {
    f();
    ADD_FAILURE() << what << ": accepted";
  } catch (const ModelError& e) {
    message = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << what;
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << what;
  EXPECT_LT(message.size(), 2000u) << what;
  EXPECT_NE(message.find("accepted"), std::string::npos) << message;
  return message;
}

std::string complaint_of_urdf(const std::string& what, const std::string& text) {
  RobotOptions o;
  o.file = write("robot.urdf", text);
  o.robot = "r";
  const std::string message = complaint(what, [&] {
    Model m;
    add_urdf(m, o);
    validate(m, o.file);
  });
  EXPECT_NE(message.find("delassus_bad_robot.urdf"), std::string::npos) << message;
  return message;
}

std::string inertial(const std::string& mass, const std::string& moments = "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"") {
  return "<inertial><mass value=\"" + mass + "\"/><inertia " + moments + "/></inertial>";
}
std::string link(const std::string& name, const std::string& inside) { return "<link name=\"" + name + "\">" + inside + "</link>"; }
std::string good(const std::string& name) { return link(name, inertial("1")); }
std::string joint(const std::string& name, const std::string& parent, const std::string& child, const std::string& more = "",
                  const std::string& type = "continuous") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + more + "</joint>";
}
std::string robot(const std::string& inside) { return "<robot name=\"r\">\n" + inside + "\n</robot>"; }

struct Case {
  const char* what;
  std::string text;
  std::vector<std::string> named;  // what the message must contain
};

TEST(BadUrdf, every_fault_is_named) {
  const std::string ab = good("a") + good("b");
  const std::vector<Case> cases{
      {"empty file", "", {"is empty"}},
      {"only a declaration", "<?xml version=\"1.0\"?>", {"no element"}},
      {"only a comment", "<!-- robot -->", {"no element"}},
      {"only a document type", "<!DOCTYPE robot>", {"no element"}},
      {"only an end", "</a>", {"root element"}},
      {"a declaration and an end", "<?xml version=\"1.0\"?></robot>", {"root element"}},
      {"a byte order mark", "\xef\xbb\xbf", {"is empty"}},
      {"a zero byte", robot(good("a")) + std::string(1, '\0') + "<more/>", {"NUL"}},
      {"a second root", robot(good("a")) + robot(good("b")), {"second root element", "line 3"}},
      {"text behind the root", robot(good("a")) + "hello", {"broken XML", "line 3"}},
      {"an attribute twice", robot("<link name=\"a\" name=\"b\"/>"), {"broken XML", "line 2"}},
      {"zeros", std::string(7, '\0'), {"NUL"}},
      {"no XML", "hello", {"XML"}},
      {"broken XML", "<robot name=\"r\"><link name=\"a\">", {"broken XML"}},
      {"another root", "<sdf/>", {"\"sdf\""}},
      {"no link", "<robot/>", {"has no link"}},
      {"empty robot", robot(""), {"no link"}},
      {"only xacro", robot("<xacro:include filename=\"x\"/>"), {"no link", "run xacro first"}},
      {"a number of xacro", robot(link("a", inertial("${m}"))), {"\"${m}\" is not expanded", "run xacro first"}},
      {"negative mass", robot(link("a", inertial("-1"))), {"\"a\"", "-1 kg", "line 2"}},
      {"mass NaN", robot(link("a", inertial("nan"))), {"\"a\"", "\"nan\""}},
      {"mass infinite", robot(link("a", inertial("1e999"))), {"1e999"}},
      {"mass with a unit", robot(link("a", inertial("1 kg"))), {"1 kg"}},
      {"mass missing", robot(link("a", "<inertial><inertia ixx=\"1\"/></inertial>")), {"<mass> is missing"}},
      {"moment missing", robot(link("a", inertial("1", "ixx=\"1\""))), {"ixy", "missing"}},
      {"origin infinite", robot(ab + joint("j", "a", "b", "<origin xyz=\"0 inf 0\"/>")), {"\"j\"", "0 inf 0"}},
      {"origin short", robot(ab + joint("j", "a", "b", "<origin xyz=\"0 0\"/>")), {"wrong length"}},
      {"zero axis", robot(ab + joint("j", "a", "b", "<axis xyz=\"0 0 0\"/>")), {"\"j\"", "0 0 0"}},
      {"unknown link", robot(good("a") + joint("j", "a", "b")), {"\"b\" does not exist"}},
      {"link to itself", robot(good("a") + joint("j", "a", "a")), {"to itself"}},
      {"two parents", robot(ab + good("c") + joint("j", "a", "c") + joint("k", "b", "c")), {"\"c\"", "\"j\""}},
      {"cycle", robot(ab + joint("j", "a", "b") + joint("k", "b", "a")), {"cycle"}},
      {"cycle apart", robot(ab + good("c") + joint("j", "a", "b") + joint("k", "b", "a")), {"cycle"}},
      {"two roots", robot(ab), {"second root", "\"a\"", "\"b\""}},
      {"same link name", robot(good("a") + good("a")), {"taken"}},
      {"same joint name", robot(ab + good("c") + joint("j", "a", "b") + joint("j", "a", "c")), {"taken", "\"j\""}},
      {"unknown type", robot(ab + joint("j", "a", "b", "", "ball")), {"\"ball\"", "revolute"}},
      {"negative damping", robot(ab + joint("j", "a", "b", "<dynamics damping=\"-1\"/>")), {"damping", "-1"}},
      {"armature NaN", robot(ab + joint("j", "a", "b", "<dynamics armature=\"nan\"/>")), {"armature", "nan"}},
      {"no parent", robot(good("a") + "<joint name=\"j\" type=\"fixed\"><child link=\"a\"/></joint>"), {"<parent>"}},
      {"massless tip", robot(good("a") + link("b", "") + joint("j", "a", "b")), {"r/b", "armature"}},
      {"massless robot", robot(link("a", "")), {"r/a", "mass"}},
      {"mimic unknown", robot(ab + joint("j", "a", "b", "<mimic joint=\"x\"/>")), {"\"x\"", "mimic"}},
      {"mimic itself", robot(ab + joint("j", "a", "b", "<mimic joint=\"j\"/>")), {"\"j\"", "follow"}},
      {"radius negative", robot(link("a", inertial("1") + "<collision><geometry><sphere radius=\"-1\"/></geometry></collision>")), {"radius", "-1", "m"}},
      {"radius no number", robot(link("a", inertial("1") + "<collision><geometry><sphere radius=\"x\"/></geometry></collision>")), {"radius", "\"x\""}}};
  for (const Case& c : cases) {
    const std::string message = complaint_of_urdf(c.what, c.text);
    for (const std::string& part : c.named) EXPECT_NE(message.find(part), std::string::npos) << c.what << ": " << message;
  }
}

TEST(BadUrdf, names_of_a_million_characters_are_cut) {
  const std::string name(1000000, 'x');
  const std::string message = complaint_of_urdf("long names", robot(good(name) + joint(name, name, name + "y")));
  EXPECT_NE(message.find("1000000 characters"), std::string::npos);
}

TEST(BadUrdf, control_and_foreign_characters_in_names) {
  EXPECT_NE(complaint_of_urdf("names", robot(good("&#1;\xff\xfe") + good("b"))).find("second root"), std::string::npos);
}

TEST(BadUrdf, deep_nesting) {
  std::string text;
  for (int k = 0; k < 100000; ++k) text += "<a>";
  (void)complaint_of_urdf("deep", text);
}

TEST(BadUrdf, a_missing_file) {
  RobotOptions o;
  o.file = "no/such/robot.urdf";
  const std::string message = complaint("missing", [&] { Model m; add_urdf(m, o); });
  EXPECT_NE(message.find("no/such/robot.urdf"), std::string::npos);
}

TEST(BadUrdf, overrides_of_unknown_or_fixed_joints) {
  RobotOptions o;
  o.file = write("robot.urdf", robot(good("a") + good("b") + joint("j", "a", "b", "", "fixed")));
  o.armature["x"] = 1;
  EXPECT_NE(complaint("unknown", [&] { Model m; add_urdf(m, o); }).find("\"x\""), std::string::npos);
  o.armature.clear();
  o.joint_types["j"] = {};
  EXPECT_NE(complaint("fixed", [&] { Model m; add_urdf(m, o); }).find("fixed"), std::string::npos);
}

std::string complaint_of_scene(const std::string& what, const std::string& text) {
  const std::string file = write("scene.yaml", text);
  const std::string message = complaint(what, [&] { (void)load_scene(file); });
  EXPECT_NE(message.find("delassus_bad_"), std::string::npos) << message;
  return message;
}

TEST(BadScene, every_fault_is_named) {
  const std::string a = "boxes:\n  - {name: a, mass: 1, size: [1, 1, 1]}\n", b = "  - {name: b, mass: 1, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n";
  const std::string con = a + b + "constraints:\n  - ";
  write("tip.urdf", robot(good("a") + good("b") + good("c") + joint("j", "a", "b") + joint("k", "b", "c", "<mimic joint=\"j\"/>")));
  write("far.urdf", robot(good("a") + link("b", "<inertial><origin xyz=\"1e160 0 0\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>") + joint("j", "a", "b", "<axis xyz=\"0 0 1\"/>")));
  write("ball.urdf", robot(good("a") + good("b") + joint("j", "a", "b")));
  const std::string ball = "robots:\n  - {name: r, urdf: delassus_bad_ball.urdf";
  const std::string r = "robots:\n  - {name: r, urdf: delassus_bad_tip.urdf";
  const std::vector<Case> cases{
      {"empty", "", {"mapping"}},
      {"broken", "a: [", {"YAML", ":"}},
      {"list", "- 1", {"mapping"}},
      {"unknown key", a + "grond: 1\n", {"yaml:3", "grond", "ground"}},
      {"key twice", a + "ground: {z: 0}\nground: {z: 1}\n", {"yaml:4", "twice"}},
      {"nothing", "ground: {z: 0}", {"move"}},
      {"gravity length", a + "gravity: [0, 0]\n", {"yaml:3", "gravity", "3 numbers"}},
      {"gravity type", a + "gravity: [0, 0, down]\n", {"down", "m/s^2"}},
      {"gravity NaN", a + "gravity: [0, 0, .nan]\n", {".nan"}},
      {"mass zero", "boxes:\n  - {name: a, mass: 0, size: [1, 1, 1]}\n", {"yaml:2", "mass", "kg"}},
      {"mass unit", "boxes:\n  - {name: a, mass: 1 kg, size: [1, 1, 1]}\n", {"1 kg"}},
      {"size negative", "boxes:\n  - {name: a, mass: 1, size: [1, -1, 1]}\n", {"size", "m"}},
      {"size missing", "boxes:\n  - {name: a, mass: 1}\n", {"size", "missing"}},
      {"name twice", a + "  - {name: a, mass: 1, size: [1, 1, 1]}\n", {"taken"}},
      {"name reserved", "boxes:\n  - {name: world, mass: 1, size: [1, 1, 1]}\n", {"world"}},
      {"negative friction", a + "ground: {friction: -1}\n", {"friction", "-1"}},
      {"no URDF", "robots:\n  - {name: r, urdf: none.urdf}\n", {"yaml:2", "none.urdf"}},
      {"base", r + ", base: flying}\n", {"flying", "planar"}},
      {"unknown joint", r + ", joints: {x: 1}}\n", {"x", "joint"}},
      {"mimic value", r + ", joints: {k: 1}}\n", {"follows"}},
      {"joint length", r + ", joints: {j: [1, 2]}}\n", {"2 entries"}},
      {"joint type", r + ", joint_types: {j: ball}}\n", {"ball", "spherical"}},
      {"joint type length", ball + ", joint_types: {j: spherical}, joints: {j: 1}}\n", {"4 numbers"}},
      {"quaternion zero", ball + ", joint_types: {j: spherical}, joints: {j: [0, 0, 0, 0]}}\n", {"quaternion"}},
      {"armature", r + ", armature: {j: -1}}\n", {"armature", "-1"}},
      {"kind", con + "{kind: glue, of: a, to: b}\n", {"yaml:5", "glue", "weld"}},
      {"key of a kind", con + "{kind: point, of: a, to: b, length: 1}\n", {"length", "to_at"}},
      {"unknown end", con + "{kind: point, of: a, to: c}\n", {"\"c\""}},
      {"to itself", con + "{kind: point, of: a, to: a}\n", {"one body"}},
      {"world to world", con + "{kind: point, of: world, to: ground}\n", {"one body"}},
      {"distance zero", con + "{kind: distance, of: a, to: world, to_at: [0, 0, 0]}\n", {"coincide"}},
      {"loop", con + "{kind: point, of: a, to: b, loop: 1}\n", {"true, false"}},
      {"axes parallel", con + "{kind: hinge, of: a, to: b, axes: {z: [0, 0, 1], x: [0, 0, 2]}}\n", {"parallel"}},
      {"rpy and axes", con + "{kind: hinge, of: a, to: b, rpy: [0, 0, 0], axes: {z: [0, 0, 1]}}\n", {"one of them"}},
      {"unknown robot", con + "{kind: joint_friction, robot: a}\n", {"\"a\""}},
      {"coupling dof", r + "}\nconstraints:\n  - {kind: coupling, terms: [{joint: r/j, dof: 1, coefficient: 1}]}\n", {"degrees of freedom"}},
      {"coupling empty", con + "{kind: coupling, terms: []}\n", {"empty"}},
      {"general columns", con + "{kind: general, terms: [{of: a, K: [[1, 2]]}]}\n", {"6"}},
      {"general rows", con + "{kind: general, terms: [{of: a, K: [[1, 0, 0, 0, 0, 0]]}, {of: b, K: []}]}\n", {"rows"}},
      {"cannot close", con + "{kind: distance, of: a, at: [0, 0, 0], to: b, to_at: [0, 0, 0], length: 1}\n"
                             "  - {kind: distance, of: a, at: [0, 0, 0], to: b, to_at: [0, 0, 0], length: 2}\n", {"loop"}},
      {"damping negative", con + "{kind: point, of: a, to: b, damping: -1}\n", {"yaml:5", "damping", "1/kg"}},
      {"damping list", con + "{kind: point, of: a, to: b}\ndamping: [1, 2]\n", {"yaml:6", "2 entries", "3 numbers"}},
      {"damping asymmetric", con + "{kind: point, of: a, to: b, damping: [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}\n", {"symmetric"}},
      {"damping indefinite", con + "{kind: point, of: a, to: b, damping: [[1, 2, 0], [2, 1, 0], [0, 0, 1]]}\n", {"eigenvalue"}},
      {"damping shape", con + "{kind: point, of: a, to: b, damping: [[1, 2], [2, 1]]}\n", {"rows"}},
      {"contacts", a + "contacts: some\n", {"some", "detect"}},
      {"contact without ground", a + "contacts:\n  - {of: a}\n", {"no ground"}},
      {"contact without normal", a + b + "contacts:\n  - {of: a, to: b}\n", {"normal"}},
      {"contact with itself", a + "contacts:\n  - {of: a, to: a, normal: [0, 0, 1]}\n", {"one body"}},
      {"normal zero", a + "contacts:\n  - {of: a, normal: [0, 0, 0]}\n", {"direction"}},
      {"huge lever", "robots:\n  - {name: r, urdf: delassus_bad_far.urdf, base: fixed}\n", {"r/b", "range of double"}},
      {"a second document", a + "---\n" + a, {"second document"}},
      {"pose", a + "pose: maybe\n", {"maybe", "provisional"}}};
  for (const Case& c : cases) {
    const std::string message = complaint_of_scene(c.what, c.text);
    for (const std::string& part : c.named) EXPECT_NE(message.find(part), std::string::npos) << c.what << ": " << message;
  }
}

TEST(BadScene, hostile_yaml) {
  (void)complaint_of_scene("deep", "boxes: " + std::string(100000, '['));
  (void)complaint_of_scene("binary", std::string("\x00\x01\xff\xfe\x80", 5));
  (void)complaint_of_scene("long key", std::string(1000000, 'k') + ": 1\n");
  (void)complaint_of_scene("alias", "a: &a [1]\nb: &b [*a, *a]\nboxes: *b\n");
}

TEST(BadScene, unknown_names) {
  for (const char* name : {"", "no_such_scene", "swimmer:", "swimmer:0", "swimmer:-3", "swimmer:2.5", "swimmer:nan", "none.yaml", "no/such/file"})
    (void)complaint(name, [&] { (void)open_scene(name); });
}

}  // namespace
}  // namespace delassus::bad_input_test
