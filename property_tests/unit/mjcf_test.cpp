// Robots from MJCF: against MuJoCo's own M and equality rows of the same file, against the same robot in URDF, and value
// by value; what is left out is said, what is wrong is refused.
#include "models/mjcf.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

#include "algorithms/loop_closing.h"
#include "models/scene.h"
#include "models/urdf.h"
#include "property_tests/unit/mjcf_compare.h"
#include "property_tests/unit/temporary.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;
using unit::compare_mjcf;
using unit::MjcfRatios;

std::string write(const std::string& name, const std::string& text) {
  const auto file = delassus::test::temporary(name);
  std::ofstream(file) << text;
  return file.string();
}

std::string mjcf(const std::string& name, const std::string& text) {
  return write(name + ".xml", "<mujoco model=\"" + name + "\">" + text + "</mujoco>");
}

RobotOptions options(const std::string& file) {
  RobotOptions o;
  o.file = file;
  o.robot = "r";
  return o;
}

struct Read {
  Model model;
  Robot robot;
  VectorX<double> q;  ///< the start pose
};

Read read(const RobotOptions& o) {
  Read out;
  out.robot = add_mjcf(out.model, o);
  out.q = neutral(out.model);
  for (const auto& [body, values] : out.robot.start)
    for (std::size_t k = 0; k < values.size(); ++k) out.q[out.model.first_q[static_cast<std::size_t>(body)] + static_cast<Index>(k)] = values[k];
  return out;
}

// Rotated inertials, several joints per body with anchors off the origin, ref, every joint type, armature, merged links.
const char* const tree = R"(
<compiler angle="radian"/>
<worldbody>
 <geom type="plane" size="1 1 1"/>
 <body name="base" pos="0.3 -0.2 0.9" quat="0.9 0.1 -0.3 0.2"><freejoint name="float"/>
  <inertial pos="0.01 0.02 -0.03" quat="0.8 0.3 0.1 -0.4" mass="3" diaginertia="0.03 0.04 0.05"/>
  <body name="arm" pos="0.1 0.2 0.3" euler="0.3 -0.4 0.5">
   <joint name="yaw" type="hinge" axis="0.1 0.2 0.9" pos="0.05 -0.03 0.02" ref="0.4" armature="0.01" range="-1 2" limited="true" damping="0.3" frictionloss="0.2"/>
   <joint name="reach" type="slide" axis="1 0.5 0" pos="0.4 0.1 0.2" ref="-0.1" armature="0.2"/>
   <joint name="roll" type="hinge" axis="1 -1 0.3" pos="-0.02 0.06 0.01"/>
   <inertial pos="0.1 0 0.02" mass="1.2" fullinertia="0.011 0.012 0.013 0.001 -0.002 0.003"/>
   <body name="plate" pos="0 0.1 0" euler="0 0.7 0"><inertial pos="0 0.01 0" quat="0.7 0.1 0.2 0.3" mass="0.3" diaginertia="0.001 0.002 0.0025"/>
    <geom name="pad" type="box" size="0.1 0.05 0.02" pos="0.01 0.02 0.03" euler="0.1 0.2 0.3" friction="0.7" mass="0"/>
   </body>
   <body name="hand" pos="0.3 0 0.1"><joint name="wrist" type="ball" pos="0.01 0.02 0.03" armature="0.002"/>
    <inertial pos="0.02 0 0.1" mass="0.5" diaginertia="0.002 0.003 0.004"/>
    <geom type="sphere" size="0.03" mass="0"/></body>
  </body>
  <body name="leg" pos="-0.1 0 -0.2"><joint name="knee" axis="0 1 0"/><geom type="capsule" size="0.03 0.2" pos="0 0 -0.1" density="900"/>
   <body name="shin" pos="0 0 -0.3"><joint name="ankle" axis="0 1 0" ref="0.3"/><geom type="cylinder" size="0.03 0.1" euler="0.2 0 0"/></body></body>
 </body>
 <body name="post" pos="1 0 0.5" euler="0 0 0.6"><joint name="swing" axis="0 0.6 0.8" pos="0 0 0.1"/><geom type="ellipsoid" size="0.05 0.06 0.07"/></body>
</worldbody>)";

const char* const closures = R"(
<tendon><fixed name="t1"><joint joint="knee" coef="0.5"/><joint joint="swing" coef="-2"/></fixed>
 <fixed name="t2"><joint joint="roll" coef="1.5"/><joint joint="knee" coef="3"/></fixed></tendon>
<equality>
 <connect name="pin" body1="hand" body2="shin" anchor="0.1 0.2 0.3"/>
 <connect body1="shin" anchor="0.01 0.02 0.03"/>
 <weld name="clamp" body1="plate" body2="post" relpose="0.1 0.2 0.3 0.9 0.1 0.3 -0.2" torquescale="0.5"/>
 <weld body1="hand" body2="leg"/>
 <joint name="gear" joint1="ankle" joint2="yaw" polycoef="0.2 -1.5 0 0 0"/>
 <joint name="cam" joint1="knee" joint2="yaw" polycoef="0.1 0.5 2 0 1"/>
 <joint name="held" joint1="swing" polycoef="0.3 0 0 0 0"/>
 <joint name="off" joint1="knee" joint2="ankle" active="false"/>
 <tendon name="rope" tendon1="t1" tendon2="t2" polycoef="0 0.7 0 0 0"/>
 <tendon name="cord" tendon1="t1"/>
</equality>)";

void expect_agreement(const std::string& what, const RobotOptions& o, const Read& r) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const MjcfRatios x = compare_mjcf(o, r.model, r.robot, seed);
    std::printf("  %-20s M %.2g  J %.2g (%d rows)\n", what.c_str(), x.M, x.J, static_cast<int>(x.rows));
    EXPECT_LT(x.M, 30) << what << " seed " << seed;
    EXPECT_LT(x.J, 30) << what << " seed " << seed;
  }
}

TEST(Mjcf, agrees_with_mujoco_on_M_and_on_the_rows_of_equalities) {
  RobotOptions o = options(mjcf("closures", std::string(tree) + closures));
  expect_agreement("closures", o, read(o));
  o.pose = {Eigen::AngleAxisd(0.8, Vector3<double>(1, 2, 3).normalized()).toRotationMatrix(), {0.5, -0.4, 2}};
  const Read r = read(o);
  expect_agreement("closures, moved", o, r);
  std::vector<Kind> kinds;
  for (const Constraint& c : r.model.constraints) kinds.push_back(c.kind);
  EXPECT_EQ(kinds, (std::vector<Kind>{Kind::point, Kind::point, Kind::weld, Kind::weld, Kind::coupling, Kind::coupling, Kind::joint_lock, Kind::coupling, Kind::coupling}));
}

// ---- seeded differences ----------------------------------------------------------------------------------------

Body& body(Model& m, const char* name) { return m.bodies[static_cast<std::size_t>(m.find(std::string("r/") + name))]; }
Constraint& constraint(Model& m, const char* name) {
  return *std::find_if(m.constraints.begin(), m.constraints.end(), [&](const Constraint& c) { return c.name == std::string("r/") + name; });
}

struct Difference {
  const char* name;
  bool in_M;
  std::function<void(Model&)> seed;
};

const std::vector<Difference> differences{
    {"anchor forgotten", true, [](Model& m) { body(m, "arm.yaw").joint.placement.translation -= Vector3<double>(0.05, -0.03, 0.02); }},
    {"ref forgotten", true, [](Model& m) { auto& j = body(m, "arm.yaw").joint; j.placement.rotation *= Eigen::AngleAxisd(0.4, j.axis).toRotationMatrix(); }},
    {"ref of a slide forgotten", true, [](Model& m) { auto& j = body(m, "arm.reach").joint; j.placement.translation += -0.1 * j.axis; }},
    {"axis reversed", true, [](Model& m) { body(m, "arm").joint.axis *= -1; }},
    {"merged link forgotten", true, [](Model& m) { body(m, "arm").mass -= 0.3; }},
    {"inertia 1e-9 off", true, [](Model& m) { body(m, "arm").inertia(0, 0) *= 1 + 1e-9; }},
    {"armature forgotten", true, [](Model& m) { body(m, "arm.reach").joint.armature = {0}; }},
    {"anchor of a pin 1 nm off", false, [](Model& m) { constraint(m, "pin").b.placement.translation[0] += 1e-9; }},
    {"ends of a pin exchanged", false, [](Model& m) { std::swap(constraint(m, "pin").a, constraint(m, "pin").b); }},
    {"orientation of a weld forgotten", false, [](Model& m) { constraint(m, "clamp").a.placement.rotation = Matrix3<double>::Identity(); }},
    {"ratio of a gear inverted", false, [](Model& m) { constraint(m, "gear").terms[1].coefficient = 1 / 1.5; }},
    {"slope of a curve forgotten", false, [](Model& m) { constraint(m, "cam").terms[1].coefficient = -2; }},
    {"coefficient of a tendon forgotten", false, [](Model& m) { constraint(m, "rope").terms[1].coefficient = 1; }}};

TEST(Mjcf, the_comparison_sees_every_seeded_difference) {
  const RobotOptions o = options(mjcf("seeded", std::string(tree) + closures));
  const Read right = read(o);
  for (const Difference& d : differences) {
    Read wrong = right;
    d.seed(wrong.model);
    const MjcfRatios r = compare_mjcf(o, wrong.model, wrong.robot, 1);
    EXPECT_GE(d.in_M ? r.M : r.J, 30) << d.name;
  }
}

// ---- the same robot in URDF ------------------------------------------------------------------------------------

const char* const same_urdf = R"(<robot name="r">
<link name="base"><inertial><origin xyz="0.01 0.02 -0.03" rpy="0 0 0"/><mass value="3"/><inertia ixx="0.03" iyy="0.04" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="a"><inertial><origin xyz="0.1 0 0.02" rpy="0.3 -0.2 0.5"/><mass value="1.2"/><inertia ixx="0.011" iyy="0.012" izz="0.013" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="b"><inertial><origin xyz="0 0.2 0.1"/><mass value="0.7"/><inertia ixx="0.004" iyy="0.005" izz="0.006" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="c"><inertial><origin xyz="0 0.02 0"/><mass value="0.2"/><inertia ixx="0.0004" iyy="0.0005" izz="0.0006" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 -0.6"/><axis xyz="0 0.6 0.8"/><limit lower="-1" upper="2" effort="1" velocity="1"/><dynamics armature="0.01"/></joint>
<joint name="j2" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.3 0 -0.1" rpy="0 0.2 0"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="b"/><child link="c"/><origin xyz="0 0 0.3" rpy="1 0 0"/></joint>
</robot>)";

// `fullinertia` is in the axes of the body, so the rotated inertia of `a` is spelt out by the test.
std::string same_mjcf() {
  Matrix3<double> I;
  I << 0.011, 0.001, -0.002, 0.001, 0.012, 0.003, -0.002, 0.003, 0.013;
  const Matrix3<double> R = rotation_rpy({0.3, -0.2, 0.5});
  I = (R * I * R.transpose()).eval();
  char full[300];
  std::snprintf(full, sizeof full, "%.17g %.17g %.17g %.17g %.17g %.17g", I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return std::string(R"(<compiler angle="radian" eulerseq="XYZ"/><worldbody><body name="base"><freejoint/>
<inertial pos="0.01 0.02 -0.03" mass="3" diaginertia="0.03 0.04 0.05"/>
<body name="a" pos="0.1 0.2 0.3" euler="0.4 0.5 -0.6"><joint name="j1" axis="0 0.6 0.8" range="-1 2" limited="true" armature="0.01"/>
 <inertial pos="0.1 0 0.02" mass="1.2" fullinertia=")") + full + R"("/>
 <body name="b" pos="0.3 0 -0.1" euler="0 0.2 0"><joint name="j2" type="slide" axis="1 0 0"/>
  <inertial pos="0 0.2 0.1" mass="0.7" diaginertia="0.004 0.005 0.006"/>
  <body name="c" pos="0 0 0.3" euler="1 0 0"><inertial pos="0 0.02 0" mass="0.2" diaginertia="0.0004 0.0005 0.0006"/></body>
 </body></body></body></worldbody>)";
}

TEST(Mjcf, the_same_robot_in_urdf_has_the_same_M) {
  RobotOptions o = options(write("same.urdf", same_urdf));
  Model urdf;
  const Robot u = add_urdf(urdf, o);
  const Read r = read(options(mjcf("same", same_mjcf())));
  ASSERT_EQ(urdf.bodies.size(), r.model.bodies.size());
  for (unsigned seed = 0; seed < 5; ++seed) {
    unit::Random random(seed);
    const VectorX<double> q = unit::random_configuration(urdf, random);
    const Problem<double> x = kinematics<double>(urdf, q), y = kinematics<double>(r.model, q);
    const auto bounds = reference::witness_bounds(urdf, q, x);
    EXPECT_LT(unit::worst_entry(reference::mass_matrix(x.cast<Quad>()), reference::mass_matrix(y), bounds.M), 30);
  }
  for (const char* link : {"base", "a", "b", "c"}) {
    const Frame f = u.links.at(link), g = r.robot.links.at(link);
    EXPECT_EQ(f.body, g.body) << link;
    EXPECT_LT((f.placement.translation - g.placement.translation).norm(), 30 * 0x1p-53) << link;
  }
}

// ---- values ----------------------------------------------------------------------------------------------------

TEST(Mjcf, joints_limits_rates_and_shapes_are_those_of_the_file) {
  Read r = read(options(mjcf("values", tree)));
  EXPECT_EQ(r.robot.root_joint, "r/float");
  ASSERT_EQ(r.robot.bodies.size(), 8u);
  const Joint& yaw = body(r.model, "arm.yaw").joint;
  EXPECT_EQ(yaw.name, "r/yaw");
  EXPECT_EQ(yaw.lower, std::vector<double>{-1});
  EXPECT_EQ(yaw.upper, std::vector<double>{2});
  EXPECT_EQ(yaw.armature, std::vector<double>{0.01});
  EXPECT_EQ(yaw.damping, std::vector<double>{0.3});
  EXPECT_EQ(yaw.friction, std::vector<double>{0.2});
  EXPECT_TRUE(body(r.model, "arm").joint.lower.empty());
  EXPECT_EQ(body(r.model, "hand").joint.type, JointType::spherical);
  EXPECT_EQ(body(r.model, "hand").joint.armature, std::vector<double>(3, 0.002));
  const auto& arm = body(r.model, "arm").shapes;
  ASSERT_EQ(arm.size(), 1u);
  EXPECT_EQ(arm[0].kind, Shape::Kind::box);
  EXPECT_EQ(arm[0].size, Vector3<double>(0.1, 0.05, 0.02));
  EXPECT_EQ(arm[0].friction, 0.7);
  const Pose<double> pad = r.robot.links.at("plate").placement;
  EXPECT_LT((arm[0].placement.translation - pad * Vector3<double>(0.01, 0.02, 0.03)).norm(), 1e-15);
  EXPECT_EQ(body(r.model, "leg").shapes[0].kind, Shape::Kind::capsule);
  EXPECT_EQ(body(r.model, "leg").shapes[0].size.head(2), Eigen::Vector2d(0.03, 0.2));
  EXPECT_EQ(body(r.model, "shin").shapes[0].kind, Shape::Kind::cylinder);
  EXPECT_EQ(body(r.model, "post").shapes[0].kind, Shape::Kind::hull);
  EXPECT_EQ(body(r.model, "post").shapes[0].size, Vector3<double>(0.05, 0.06, 0.07));
}

// At the drawn pose links are where the file puts them; refs of joints do not move anything.
TEST(Mjcf, the_start_pose_is_the_drawn_one) {
  const Read r = read(options(mjcf("drawn", tree)));
  Poses<double> at;
  poses(r.model, r.q, at);
  const auto place = [&](const char* link) {
    const Frame f = r.robot.links.at(link);
    const auto i = static_cast<std::size_t>(f.body), root = static_cast<std::size_t>(at.tree[i]);
    return Vector3<double>(at.reference[root] + at.position[i] + at.rotation[i] * f.placement.translation);
  };
  const Matrix3<double> R = Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized().toRotationMatrix();
  const Vector3<double> base(0.3, -0.2, 0.9);
  EXPECT_LT((place("arm") - base - R * Vector3<double>(0.1, 0.2, 0.3)).norm(), 1e-15);
  EXPECT_LT((place("shin") - base - R * Vector3<double>(-0.1, 0, -0.5)).norm(), 1e-15);
  EXPECT_LT((place("post") - Vector3<double>(1, 0, 0.5)).norm(), 1e-15);
  EXPECT_EQ(r.q[r.model.first_q[static_cast<std::size_t>(r.robot.joints.at("yaw"))]], 0.4);
}

const char* const fourbar = R"(<compiler angle="degree"/><worldbody>
 <body name="crank" pos="0 0 1" euler="10 20 30"><joint name="j1" axis="0 1 0" range="-90 180" limited="true"/><geom type="capsule" size="0.01" fromto="0 0 0 0 0 0.2"/>
  <body name="rod" pos="0 0 0.2"><joint name="j2" axis="0 1 0" ref="30"/><geom type="capsule" size="0.01" fromto="0 0 0 0.4 0 0.1"/>
   <body name="rocker" pos="0.4 0 0.1"><joint name="j3" axis="0 1 0"/><geom type="capsule" size="0.01" fromto="0 0 0 0.05 0 -0.3"/></body></body></body>
</worldbody><equality><connect body1="rocker" anchor="0.05 0 -0.3"/></equality>
<keyframe><key name="bent" qpos="0.1 0.2 0.3"/></keyframe>)";

TEST(Mjcf, loops_are_closed_at_the_drawn_pose_and_degrees_become_radians) {
  RobotOptions o = options(mjcf("fourbar", fourbar));
  Read r = read(o);
  ASSERT_EQ(r.model.constraints.size(), 1u);
  EXPECT_TRUE(r.model.constraints[0].loop);
  EXPECT_LT(assemble(r.model, r.q, o.file).residual_before, 1e-15);
  EXPECT_LT(std::fabs(body(r.model, "crank").joint.lower[0] + M_PI / 2), 1e-15);
  EXPECT_LT(std::fabs(r.q[1] - M_PI / 6), 1e-15);
  o.keyframe = "bent";
  EXPECT_EQ(read(o).q, (VectorX<double>(3) << 0.1, 0.2, 0.3).finished());
  o.keyframe = "straight";
  EXPECT_THROW(static_cast<void>(read(o)), ModelError);
}

TEST(Mjcf, the_base_is_the_files_unless_it_is_given) {
  const std::string inertial = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  const auto with = [&](const std::string& joint) {
    return mjcf("base", "<worldbody><body name=\"a\" pos=\"1 2 3\">" + joint + inertial + "<body name=\"b\"><joint name=\"j\"/>" + inertial + "</body></body></worldbody>");
  };
  const auto dofs = [&](const std::string& joint, bool given, RobotOptions::Base base) {
    RobotOptions o = options(with(joint));
    o.base_given = given, o.base = base;
    return read(o).model.dofs();
  };
  using Base = RobotOptions::Base;
  EXPECT_EQ(dofs("<freejoint/>", false, Base::fixed), 7);
  EXPECT_EQ(dofs("", false, Base::free), 1);
  EXPECT_EQ(dofs("<freejoint/>", true, Base::fixed), 1);
  EXPECT_EQ(dofs("<freejoint/>", true, Base::planar), 4);
  EXPECT_EQ(dofs("", true, Base::free), 7);
  EXPECT_THROW(dofs("<joint/>", true, Base::free), ModelError);
  EXPECT_EQ(dofs("<joint/>", true, Base::fixed), 2);
  RobotOptions o = options(with("<freejoint/>"));
  EXPECT_EQ(read(o).q.head<3>(), Vector3<double>(1, 2, 3));
}

TEST(Mjcf, mimics_give_the_value_of_the_follower) {
  const Read r = read(options(mjcf("mimic", std::string(tree) + closures)));
  const auto& gear = r.robot.mimics.at(0);
  EXPECT_EQ(gear.body, r.robot.joints.at("ankle"));
  EXPECT_EQ(gear.master, r.robot.joints.at("yaw"));
  EXPECT_EQ(gear.multiplier, -1.5);
  EXPECT_LT(std::fabs(gear.offset - (0.3 + 0.2 + 1.5 * 0.4)), 1e-15);  // ankle − 0.3 = 0.2 − 1.5 (yaw − 0.4)
}

// ---- what is said, what is refused -----------------------------------------------------------------------------

bool said(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(), [&](const std::string& n) { return n.find(words) != std::string::npos; });
}

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

std::string refusal(const std::string& file) {
  try {
    static_cast<void>(read(options(file)));
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
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

TEST(Mjcf, a_scene_takes_the_drawn_pose_or_a_keyframe_and_then_its_own_values) {
  const std::string file = mjcf("in_a_scene", "<worldbody><body name=\"a\" pos=\"0 0 1\"><freejoint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
      "<body name=\"b\"><joint name=\"j\" ref=\"45\"/><inertial pos=\"0 0 0.1\" mass=\"1\" diaginertia=\"1 1 1\"/>"
      "<body name=\"c\"><joint name=\"k\"/><inertial pos=\"0 0 0.1\" mass=\"1\" diaginertia=\"1 1 1\"/></body></body></body></worldbody>"
      "<equality><joint joint1=\"k\" joint2=\"j\" polycoef=\"0 2 0 0 0\"/></equality><keyframe><key name=\"up\" qpos=\"1 2 3 1 0 0 0 0.5 0\"/></keyframe>");
  const auto q = [&](const std::string& more) {
    return load_scene(write("mjcf_scene.yaml", "robots: [{name: r, file: " + file + more + "}]\n")).q;
  };
  const VectorX<double> drawn = q(""), key = q(", keyframe: up, pose: {xyz: [0, 0, 1]}"), given = q(", joints: {j: 1}");
  EXPECT_EQ(drawn.head<3>(), Vector3<double>(0, 0, 1));
  EXPECT_LT(std::fabs(drawn[7] - M_PI / 4), 1e-15);
  EXPECT_EQ(drawn[8], 0);
  EXPECT_EQ(key.head<3>(), Vector3<double>(1, 2, 4));
  EXPECT_EQ(key[7], 0.5);
  EXPECT_LT(std::fabs(key[8] - 2 * (0.5 - M_PI / 4)), 1e-15);
  EXPECT_LT(std::fabs(given[8] - 2 * (1 - M_PI / 4)), 1e-15);
  EXPECT_EQ(open_scene(file).q, drawn);
  const std::string urdf = write("keyed.urdf", "<robot name=\"r\"><link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>");
  EXPECT_THROW(load_scene(write("mjcf_scene.yaml", "robots: [{name: r, file: " + urdf + ", keyframe: up}]\n")), ModelError);
}

// What later versions write (options, sensors, ranges without `limited`) is read without what has no part in M and J.
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
}  // namespace delassus
