// Every refusal says five things: which file, where in it, what stands there, what is accepted, and what to do. One bad input
// per refusal; the messages of the program's options are in usage_test.py.
#include <gtest/gtest.h>

#include <fstream>

#include "algorithms/errors/message.h"
#include "algorithms/mechanism/loop_closing.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::refusals_test {
namespace {

struct Refusal {
  std::string text;
  const char *where, *value, *accepted, *advice;
};

/// `… (accepted: WHAT; WHAT TO DO)…`, the brackets matched.
std::pair<std::string, std::string> accepted_and_advice(const std::string& message) {
  const std::string_view opening = "(accepted: ";
  const std::size_t begin = message.rfind(opening);
  if (begin == std::string::npos) return {};
  std::size_t end = begin;
  for (int depth = 0; end < message.size(); ++end) {
    depth += message[end] == '(' ? 1 : message[end] == ')' ? -1 : 0;
    if (depth == 0) break;
  }
  const std::string inside = message.substr(begin + opening.size(), end - begin - opening.size());
  const std::size_t semicolon = inside.find("; ");
  if (semicolon == std::string::npos) return {inside, ""};
  return {inside.substr(0, semicolon), inside.substr(semicolon + 2)};
}

void expect_parts(const std::string& message, const std::string& file, const Refusal& r) {
  EXPECT_NE(message.find(file), std::string::npos) << "file: " << message;
  EXPECT_NE(message.find(r.where), std::string::npos) << "where: " << r.where << "\n" << message;
  EXPECT_NE(message.find(r.value), std::string::npos) << "value: " << r.value << "\n" << message;
  const auto [accepted, advice] = accepted_and_advice(message);
  EXPECT_NE(accepted.find(r.accepted), std::string::npos) << "accepted: " << r.accepted << "\n" << message;
  EXPECT_NE(advice.find(r.advice), std::string::npos) << "what to do: " << r.advice << "\n" << message;
  EXPECT_FALSE(accepted.empty()) << message;
  EXPECT_FALSE(advice.empty()) << message;
}

template <class F> std::string complaint(const std::string& about, const F& f) {
  try {
    f();
  } catch (const ModelError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted: " << about;
  return "";
}

std::string write(const std::string& name, const std::string& text) {
  const auto file = test::temporary(name);
  std::ofstream(file, std::ios::binary) << text;
  return file.string();
}

const std::string moments = R"(<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>)";
std::string link(const std::string& name, const std::string& inside = "<inertial><mass value=\"1\"/>" + moments + "</inertial>") {
  return "<link name=\"" + name + "\">" + inside + "</link>\n";
}
std::string joint(const std::string& more = "", const std::string& type = "continuous", const std::string& name = "arm_joint",
                  const std::string& parent = "base", const std::string& child = "arm") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}
std::string inertial(const std::string& mass, const std::string& inertia = moments) {
  return "<inertial><mass value=\"" + mass + "\"/>" + inertia + "</inertial>";
}

// Line 1 is <robot>; the links stand in lines 2 and 3, the joint in line 4.
TEST(Refusals, of_urdf) {
  const std::string base = link("base"), two = base + link("arm");
  const auto shape = [&](const std::string& s) { return base + link("arm", inertial("1") + "<collision><geometry>" + s + "</geometry></collision>") + joint(); };
  const std::vector<Refusal> table{
      {link("base", inertial("1e999")), "link \"base\" <mass> (line 2)", "value = \"1e999\" is beyond the range of double", "1 finite number [kg]", "exponent and the unit"},
      {link("base", inertial("nan")), "link \"base\" <mass> (line 2)", "\"nan\" is not finite", "1 finite number [kg]", "exports that failed"},
      {link("base", inertial("1,5")), "link \"base\" <mass> (line 2)", "\"1,5\" is no number", "1 finite number [kg]", "decimal point"},
      {link("base", inertial("1 kg")), "link \"base\" <mass> (line 2)", "\"1 kg\": \"kg\" is no number", "1 finite number [kg]", "write digits"},
      {link("base", inertial("1kg")), "link \"base\" <mass> (line 2)", "\"1kg\" is no number", "1 finite number [kg]", "the number alone"},
      {link("base", inertial("${m}")), "link \"base\" <mass> (line 2)", "\"${m}\" is not expanded", "1 finite number [kg]", "run xacro first"},
      {link("base", inertial("")), "link \"base\" <mass> (line 2)", "value = \"\"", "1 finite number [kg]", "write 1"},
      {link("base", inertial("-0.1")), "link \"base\" <mass> (line 2)", "mass = -0.1 kg", "mass >= 0 [kg]", "the sign"},
      {link("base", "<inertial>" + moments + "</inertial>"), "link \"base\" <inertial> (line 2)", "<mass> is missing", "[kg]", "take <inertial> out"},
      {link("base", "<inertial><mass value=\"1\"/></inertial>"), "link \"base\" <inertial> (line 2)", "<inertia> is missing", "[kg m^2]", "all six 0"},
      {link("base", inertial("1", "<inertia ixx=\"1\"/>")), "link \"base\" <inertia> (line 2)", "ixy is missing", "[kg m^2]", "add ixy"},
      {base + link("base"), "link \"base\" (line 3)", "the name is taken", "unique link names", "rename"},
      {"<link/>", "<link> (line 2)", "attribute name is missing", "a name", "name=\"...\""},
      {"", "<robot> (line 1)", "has no link", "at least one link", "xacro"},
      {two, "link \"base\" (line 2)", "second root besides link \"arm\"", "one link without a parent", "fixed joint"},
      {two + joint("", "continuous", "j", "base", "amr"), "joint \"j\" (line 4)", "link \"amr\" does not exist", "did you mean arm?", "correct the name"},
      {two + joint("", "continuous", "j", "arm", "arm"), "joint \"j\" (line 4)", "joins link \"arm\" to itself", "two different links", "take the joint out"},
      {two + joint() + joint("", "continuous", "again"), "joint \"again\" (line 5)", "already has the parent joint \"arm_joint\"", "one joint per child", "constraint of the scene"},
      {two + joint() + joint("", "continuous", "back", "arm", "base"), "joint \"arm_joint\" (line 4)", "form a cycle", "a tree", "constraint of the scene"},
      {two + link("c") + joint("", "continuous", "j", "arm", "c") + joint("", "continuous", "k", "c", "arm"), "joint \"j\" (line 5)", "cycle apart from the root", "a tree", "constraint of the scene"},
      {two + joint() + joint("", "fixed"), "joint \"arm_joint\" (line 5)", "the name is taken", "unique joint names", "rename"},
      {two + joint("", "revolut"), "joint \"arm_joint\" (line 4)", "type \"revolut\"", "did you mean revolute?", "joint_types of the scene"},
      {two + "<joint name=\"j\" type=\"fixed\"><parent link=\"base\"/></joint>", "joint \"j\" (line 4)", "<child> is missing", "<child link", "two links"},
      {two + joint("<origin xyz=\"0 0\"/>"), "joint \"arm_joint\" <origin> (line 4)", "xyz = \"0 0\" has the wrong length", "3 finite numbers [m]", "write 3"},
      {two + joint("<origin rpy=\"0 inf 0\"/>"), "joint \"arm_joint\" <origin> (line 4)", "\"inf\" is not finite", "3 finite numbers [rad]", "write the number"},
      {two + joint("<origin quat_xyzw=\"0 0 0 1\"/>"), "joint \"arm_joint\" <origin> (line 4)", "\"0 0 0 1\"", "rpy", "convert"},
      {two + joint("<axis xyz=\"0 0 0\"/>"), "joint \"arm_joint\" <axis> (line 4)", "\"0 0 0\" has no direction", "not all 0", "fixed"},
      {two + joint("<dynamics damping=\"-0.25\"/>"), "joint \"arm_joint\" <dynamics> (line 4)", "damping = -0.25 is negative", "N m s/rad", "leave it out"},
      {two + joint("<limit lower=\"low\"/>"), "joint \"arm_joint\" <limit> (line 4)", "lower = \"low\"", "[rad or m]", "digits"},
      {shape("<sphere radius=\"-0.1\"/>"), "link \"arm\" <sphere> (line 3)", "radius = -0.1 m", "a length >= 0 [m]", "sign"},
      {shape("<box size=\"1 -1 1\"/>"), "link \"arm\" <box> (line 3)", "\"1 -1 1\"", "lengths >= 0 [m]", "sign"}};
  const std::string scene = write("refusals_of_urdf.yaml", "robots:\n  - {name: r, urdf: refusals.urdf}\n");
  for (const Refusal& r : table) {
    const std::string file = write("refusals.urdf", "<robot name=\"r\">\n" + r.text + "</robot>\n");
    expect_parts(complaint(r.text, [&] { (void)load_scene(scene); }), file, r);
  }
  for (const auto& [text, where, value] : std::vector<std::array<std::string, 3>>{{"<robot name=\"r\"><link>", "line 1", "broken XML"},
                                                                                 {"<!-- no -->", "root element", "no element"},
                                                                                 {"<robot/><robot/>", "<robot> (line 1)", "second root"},
                                                                                 {std::string("<robot/>\0", 9), "byte 8", "NUL"}}) {
    const std::string file = write("refusals.urdf", text), message = complaint(text, [&] { (void)load_robot(file); });
    expect_parts(message, file, {text, where.c_str(), value.c_str(), "", ""});
  }
}

// Line 1 begins the boxes a and b in lines 2 and 3; what is refused comes in line 4 or later.
TEST(Refusals, of_scenes) {
  const std::string boxes = "boxes:\n  - {name: box_a, mass: 1, size: [1, 1, 1]}\n  - {name: box_b, mass: 1, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n";
  const std::string con = boxes + "constraints:\n  - ";
  write("scene.urdf", "<robot name=\"r\">\n" + link("base") + link("arm") + link("hand") + joint("<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>", "revolute") +
                          joint("<mimic joint=\"arm_joint\"/>", "continuous", "hand_joint", "arm", "hand") + "</robot>\n");
  const std::string entry = "robots:\n  - name: r\n    urdf: scene.urdf\n    base: fixed\n    ", arm = "robots:\n  - {name: r, urdf: scene.urdf, base: fixed}\n";
  const std::string on_arm = arm + "constraints:\n  - ";
  const std::vector<Refusal> table{
      {"boxes: [", "yaml:1: YAML", "broken", "well-formed YAML", "indentation"},
      {"- 1\n", "yaml:1", "no mapping", "robots, boxes", "docs/scenes.md"},
      {boxes + "---\na: 1\n", "yaml:5", "a second document", "one document", "file of its own"},
      {"," + boxes, "yaml:1", "nothing can begin with a comma", "well-formed YAML", "check brackets"},
      {"---\n, 0.7]}}" + boxes, "yaml:2", "nothing can begin with a comma", "well-formed YAML", "check brackets"},
      {boxes + "grond: {z: 0}\n", "yaml:4: grond", "unknown key", "did you mean ground?", "docs/scenes.md"},
      {boxes + "ground: {z: 0}\nground: {z: 1}\n", "yaml:5: ground", "twice", "once", "take one"},
      {"ground: {z: 0}\n", "yaml:1", "nothing in the scene can move", "robots or boxes", "base: free"},
      {boxes + "gravity: [0, 0]\n", "yaml:4: gravity", "2 entries", "3 numbers [m/s^2]", "x, y and z"},
      {boxes + "gravity: [0, 0, 1e999]\n", "yaml:4: gravity[2]", "\"1e999\" is beyond the range of double", "a finite number [m/s^2]", "exponent"},
      {boxes + "gravity: [0, 0, .nan]\n", "yaml:4: gravity[2]", "\".nan\" is not finite", "a finite number [m/s^2]", "write the number"},
      {boxes + "gravity: down\n", "yaml:4: gravity", "is no list", "a list of numbers [m/s^2]", "docs/scenes.md"},
      {boxes + "ground: {friction: -0.5}\n", "yaml:4: ground.friction", "\"-0.5\" is negative", ">= 0", "0 for none"},
      {boxes + "strict: maybe\n", "yaml:4: strict", "\"maybe\" is neither", "true, false", "quotes"},
      {boxes + "pose: provisory\n", "yaml:4: pose", "\"provisory\"", "provisional", "leave the key out"},
      {"boxes:\n  - {name: a, mass: 0, size: [1, 1, 1]}\n", "yaml:2: boxes[0].mass", "\"0\" is not positive", "> 0 [kg]", "unit"},
      {"boxes:\n  - {name: a, mass: 1}\n", "yaml:2: boxes[0]", "key size is missing", "size: ...", "value"},
      {"boxes:\n  - {name: a, mass: 1, size: [1, -0.25, 1]}\n", "yaml:2: boxes[0].size", "(1 -0.25 1)", "> 0 [m]", "thickness"},
      {"boxes:\n  - {name: a, mass: 1e300, size: [1, 1e300, 1]}\n", "yaml:2: boxes[0].size", "beyond the range", "below 1e308 kg m^2", "units"},
      {"boxes:\n  - {name: a/b, mass: 1, size: [1, 1, 1]}\n", "yaml:2: boxes[0].name", "\"a/b\"", "without '/'", "another"},
      {boxes + "  - {name: box_a, mass: 1, size: [1, 1, 1]}\n", "yaml:4: boxes[2].name", "\"box_a\" is taken", "unique names", "another"},
      {"robots:\n  - {name: r, urdf: none.urdf}\n", "yaml:2: robots[0].urdf", "none.urdf\" cannot be read", "path", "folder of the scene"},
      {"robots:\n  - {name: r, urdf: a.urdf, file: a.urdf}\n", "yaml:2: robots[0]", "file and urdf", "one of them", "the same"},
      {entry + "pose: {xyz: [0, 0, x]}\n", "yaml:5: robots[0].pose.xyz[2]", "\"x\" is no number", "[m]", "digits"},
      {"robots:\n  - {name: r, urdf: scene.urdf, base: fixd}\n", "yaml:2: robots[0].base", "\"fixd\"", "did you mean fixed?", "free"},
      {entry + "joints: {arm_joind: 1}\n", "yaml:5: robots[0].joints.arm_joind", "no moving joint", "did you mean arm_joint?", "describe"},
      {entry + "joints: {hand_joint: 1}\n", "yaml:5: robots[0].joints.hand_joint", "follows another", "no value", "that is followed"},
      {entry + "joints: {arm_joint: [1, 2]}\n", "yaml:5: robots[0].joints.arm_joint", "2 entries", "1 numbers", "quaternions"},
      {entry + "joints: {arm_joint: 1e999}\n", "yaml:5: robots[0].joints.arm_joint", "\"1e999\" is beyond", "[rad or m]", "exponent"},
      {entry + "joint_types: {arm_joint: spherica}\n", "yaml:5: robots[0].joint_types.arm_joint", "\"spherica\"", "did you mean spherical?", "ball"},
      {entry + "armature: {arm_joint: -0.1}\n", "yaml:5: robots[0].armature.arm_joint", "\"-0.1\" is negative", "[kg m^2 or kg]", "0 for none"},
      {entry + "mesh_path: there\n", "yaml:5: robots[0].mesh_path", "no list", "a list of folders", "docs/scenes.md"},
      {con + "{kind: hing, of: box_a, to: box_b}\n", "yaml:5: constraints[0].kind", "\"hing\"", "did you mean hinge?", "docs/scenes.md"},
      {con + "{kind: contact, of: box_a, to: box_b}\n", "yaml:5: constraints[0]", "a contact", "contacts", "without kind"},
      {con + "{kind: hinge, of: box_c, to: box_b}\n", "yaml:5: constraints[0].of", "\"box_c\" does not exist", "did you mean box_a?", "describe"},
      {con + "{kind: hinge, of: box_a, to: box_a}\n", "yaml:5: constraints[0]", "\"box_a\" and \"box_a\" are one body", "two different bodies", "fixed joints"},
      {con + "{kind: hinge, of: box_a, to: box_b, rpy: [0, 0, 0], axes: {z: [0, 0, 1]}}\n", "yaml:5: constraints[0]", "rpy and axes", "one of them", "orientation"},
      {con + "{kind: hinge, of: box_a, to: box_b, axes: {}}\n", "yaml:5: constraints[0].axes", "no axis", "{z: [...]}", "leave it out"},
      {con + "{kind: hinge, of: box_a, to: box_b, axes: {z: [0, 0, 0]}}\n", "yaml:5: constraints[0].axes.z", "(0 0 0)", "not all 0", "any length"},
      {con + "{kind: hinge, of: box_a, to: box_b, axes: {z: [0, 0, 1], x: [0, 0, 2]}}\n", "yaml:5: constraints[0].axes", "parallel", "two different", "leave one"},
      {con + "{kind: distance, of: box_a, to: box_b}\n", "yaml:5: constraints[0]", "to_at is missing", "[m]", "both points"},
      {con + "{kind: distance, of: box_a, to: world, to_at: [0, 0, 0]}\n", "yaml:5: constraints[0]", "coincide", "points apart", "kind: point"},
      {con + "{kind: point, of: box_a, to: world, tolerance: 1}\n", "yaml:5: constraints[0].tolerance", "no loop", "loop: true", "leave it out"},
      {con + "{kind: distance, of: box_a, to: box_b, to_at: [0, 0, 0], length: 1}\n  - {kind: distance, of: box_a, to: box_b, to_at: [0, 0, 0], length: 2}\n",
       "yaml:", "cannot be closed from this pose: open by ", "at most ", "loop: false here"},
      {con + "{kind: joint_lock}\n", "yaml:5: constraints[0]", "needs one of robot and joint", "robot: NAME", "joint: robot/joint"},
      {on_arm + "{kind: joint_lock, robot: s}\n", "yaml:4: constraints[0].robot", "\"s\" does not exist", "r", "entry of robots"},
      {on_arm + "{kind: joint_lock, joint: r/arm_joind}\n", "yaml:4: constraints[0].joint", "\"r/arm_joind\"", "did you mean r/arm_joint?", "describe"},
      {on_arm + "{kind: joint_limit, joint: r/arm_joint, side: uper}\n", "yaml:4: constraints[0].side", "\"uper\"", "did you mean upper?", "both"},
      {on_arm + "{kind: joint_limit, joint: r/arm_joint, dof: 1}\n", "yaml:4: constraints[0].dof", "1: the joint has 1", "0 to 0", "count from 0"},
      {on_arm + "{kind: joint_limit, robot: r, dof: 0}\n", "yaml:4: constraints[0].dof", "whole robot", "dof only with joint", "leave dof out"},
      {on_arm + "{kind: joint_limit, joint: r/hand_joint}\n", "yaml:4: constraints[0].joint", "no such limit", "a finite limit", "describe"},
      {on_arm + "{kind: coupling, terms: []}\n", "yaml:4: constraints[0].terms", "is empty", "at least one", "leave the constraint out"},
      {on_arm + "{kind: coupling, terms: [{joint: r/arm_joint, coefficient: 1}, {joint: r/arm_joint, coefficient: 2}]}\n", "yaml:4: constraints[0].terms[1]", "twice", "once", "add the coefficients"},
      {on_arm + "{kind: coupling, terms: [{joint: r/arm_joint, dof: -1, coefficient: 1}]}\n", "yaml:4: constraints[0].terms[0].dof", "\"-1\" is no index", ">= 0", "count from 0"},
      {con + "{kind: general, terms: []}\n", "yaml:5: constraints[0].terms", "is empty", "at least one", "leave the constraint out"},
      {con + "{kind: general, terms: [{of: box_a, K: [[1, 2]]}]}\n", "yaml:5: constraints[0].terms[0].K[0]", "2 entries", "6 numbers", "docs/scenes.md"},
      {con + "{kind: general, terms: [{of: world, K: [[1, 0, 0, 0, 0, 0]]}]}\n", "yaml:5: constraints[0].terms[0].of", "\"world\" is fixed", "a link that moves", "leave this term out"},
      {con + "{kind: general, terms: [{of: box_a, K: [[1, 0, 0, 0, 0, 0]]}, {of: box_a, K: [[1, 0, 0, 0, 0, 0]]}]}\n", "yaml:5: constraints[0].terms[1].of", "already has a block", "each body once", "add the blocks"},
      {con + "{kind: point, of: box_a, to: box_b, damping: -1e-3}\n", "yaml:5: constraints[0].damping", "\"-1e-3\" is negative", "[1/kg]", "0 for none"},
      {con + "{kind: point, of: box_a, to: box_b, damping: [1, 2]}\n", "yaml:5: constraints[0].damping", "2 entries", "3 numbers >= 0 [1/kg]", "stands for all"},
      {con + "{kind: point, of: box_a, to: box_b, damping: [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}\n", "yaml:5: constraints[0].damping", "not symmetric", "[1/kg]", "same digits"},
      {con + "{kind: point, of: box_a, to: box_b, damping: [[1, 2, 0], [2, 1, 0], [0, 0, 1]]}\n", "yaml:5: constraints[0].damping", "has the eigenvalue -", "[1/kg]", "diagonal"},
      {con + "{kind: point, of: box_a, to: box_b}\ndamping: [[1, 0, 0]]\n", "yaml:6: damping", "over all rows", "a number or a list", "single constraints"},
      {boxes + "hold: [box_c]\n", "yaml:4: hold[0]", "\"box_c\"", "did you mean box_a?", "describe"},
      {boxes + "assembly: {tolerance: -1}\n", "yaml:4: assembly.tolerance", "\"-1\" is negative", "[m or rad]", "0 for none"},
      {boxes + "contacts: detekt\n", "yaml:4: contacts", "\"detekt\"", "did you mean detect?", "leave it out"},
      {boxes + "contacts: {detect: true, hull_vertices: 4}\n", "yaml:4: contacts.hull_vertices", "4 vertices", ">= 10", "64"},
      {boxes + "contacts:\n  - {of: box_a}\n", "yaml:5: contacts[0]", "no ground", "ground: {z: ...}", "one of them"},
      {boxes + "contacts:\n  - {of: box_a, to: box_b}\n", "yaml:5: contacts[0]", "normal is missing", "world axes", "from `to` to `of`"},
      {boxes + "contacts:\n  - {of: box_a, to: box_a, normal: [0, 0, 1]}\n", "yaml:5: contacts[0]", "are one body", "two different bodies", "fixed joints"}};
  for (const Refusal& r : table) {
    const std::string file = write("refusals_scene.yaml", r.text);
    expect_parts(complaint(r.text, [&] { (void)load_scene(file); }), test::temporary("").parent_path().string(), r);
  }
}

TEST(Refusals, of_names_of_scenes) {
  for (const auto& [name, accepted, advice] : std::vector<std::array<std::string, 3>>{
           {"casie", "did you mean cassie?", "path"}, {"swimmer:0", "N >= 1", "ten links"}, {"swimmer:1e999", "N >= 1", "ten links"}, {"none.yaml", "a scene file", "path"}})
    expect_parts(complaint(name, [&, &scene = name] { (void)open_scene(scene); }), name, {"", "", "", accepted.c_str(), advice.c_str()});
}

// Models built by hand have no file; element, value, what is accepted and what to do are named.
TEST(Refusals, of_models) {
  Body good;
  good.name = "arm";
  good.joint.name = "j";
  good.mass = 1;
  good.inertia.setIdentity();
  const auto changed = [&](const auto& change) {
    Body b = good;
    change(b);
    return b;
  };
  struct Bad {
    Body body;
    const char *where, *value, *accepted, *advice;
  };
  for (const Bad& bad : std::vector<Bad>{
           {changed([](Body& b) { b.joint.axis = {0, 0, 1.25}; }), "arm joint j axis", "(0 0 1.25)", "length 1", "divide"},
           {changed([](Body& b) { b.joint.armature = {1, 2}; }), "arm joint j armature", "2 values", "1, one per degree", "leave"},
           {changed([](Body& b) { b.joint.damping = {-0.1}; }), "arm joint j damping", "-0.1 N m s/rad", "0 or more", "leave it out for 0"},
           {changed([](Body& b) { b.joint.lower = {0.5}, b.joint.upper = {0.1}; }), "arm joint j limits", "lower 0.5 above upper 0.1", "[rad or m]", "exchange"},
           {changed([](Body& b) { b.joint.lower = {std::nan("")}; }), "arm joint j limits", "nan", "[rad or m]", "infinity"},
           {changed([](Body& b) { b.joint.type = JointType::universal, b.joint.axis2 = b.joint.axis; }), "arm joint j axis2", "parallel", "independent", "revolute"},
           {changed([](Body& b) { b.joint.placement.rotation *= 2; }), "arm joint j placement", "orthogonal", "determinant +1", "quaternion"},
           {changed([](Body& b) { b.joint.placement.translation[0] = 1 / 0.0; }), "arm joint j placement", "not finite", "[m]", "again"},
           {changed([](Body& b) { b.mass = -0.1; }), "arm mass", "-0.1 kg", "0 kg or more", "massless"},
           {changed([](Body& b) { b.com[1] = std::nan(""); }), "arm", "not finite", "[kg, m, kg m^2]", "units"},
           {changed([](Body& b) { b.inertia(0, 1) = 0.1; }), "arm inertia", "by 0.1 kg m^2", "symmetric", "transpose"},
           {changed([](Body& b) { b.parent = 3; }), "arm", "parent 3", "-1 (ground) to -1", "before their children"},
           {changed([](Body& b) { b.shapes.push_back({Shape::Kind::box, {1, 0, 1}, {}, -1, {}}); }), "arm shape 0 size", "0 m", "above 0 m", "leave the shape out"}}) {
    Model m;
    expect_parts(complaint(bad.where, [&] { m.add(bad.body); }), "arm", {"", bad.where, bad.value, bad.accepted, bad.advice});
  }
  Model m;
  m.add(good);
  expect_parts(complaint("find", [&] { (void)m.find("amr"); }), "amr", {"", "amr", "no body", "arm", "did you mean arm?"});
  const auto with = [&](Constraint c) {
    m.constraints = {std::move(c)};
    return complaint("constraint", [&] { validate(m, "x"); });
  };
  Constraint c;
  c.name = "c";
  c.a.body = 0;
  c.kind = Constraint::Kind::distance;
  c.length = -0.1;
  expect_parts(with(c), "x", {"", "distance constraint c length", "-0.1 m", "above 0 m", "point constraint"});
  c.length = 1, c.friction = 1 / 0.0;
  expect_parts(with(c), "x", {"", "distance constraint c friction", "inf", "finite", "negative"});
  c.friction = -1, c.b.body = 0;
  expect_parts(with(c), "x", {"", "distance constraint c", "both frames are on arm", "two different bodies", "another body"});
  c.b.body = 7;
  expect_parts(with(c), "x", {"", "distance constraint c", "body 7 does not exist", "-1 (the world) to 0", "add the bodies"});
  c.kind = Constraint::Kind::coupling;
  expect_parts(with(c), "x", {"", "coupling constraint c", "no terms", "1 or more", "add a term"});
  c.terms = {{0, 0, std::nan(""), {}}};
  expect_parts(with(c), "x", {"", "coupling constraint c", "coefficient is not finite, nan", "finite", "leave the term out"});
  c.terms = {{0, 2, 1, {}}};
  expect_parts(with(c), "x", {"", "coupling constraint c", "degree of freedom 2 of arm", "0 to 0", "count from 0"});
  c.kind = Constraint::Kind::joint_limit, c.dof = 0, c.side = 3;
  expect_parts(with(c), "x", {"", "joint_limit constraint c", "side 3", "1 (lower) or -1 (upper)", "two constraints"});
}

TEST(Refusals, of_numbers_by_what_is_wrong_with_them) {
  const std::vector<std::array<std::string, 3>> table{{"1e999", "beyond the range of double", "exponent"}, {"-1e999", "beyond", "unit"}, {std::string(400, '9'), "beyond", "unit"},
                                                      {"nan", "not finite", "write the number"}, {"-.inf", "not finite", "write the number"}, {"", "no number", "write the number"},
                                                      {"1,5", "no number", "decimal point"}, {"${m}", "not expanded", "xacro"}, {"12mm", "no number", "alone"}, {"x", "no number", "digits"}};
  for (const auto& [text, problem, advice] : table) {
    EXPECT_FALSE(finite_number(text)) << text;
    EXPECT_NE(not_a_number(text).problem.find(problem), std::string::npos) << text << ": " << not_a_number(text).problem;
    EXPECT_NE(not_a_number(text).advice.find(advice), std::string::npos) << text << ": " << not_a_number(text).advice;
  }
}

}  // namespace
}  // namespace delassus::refusals_test
