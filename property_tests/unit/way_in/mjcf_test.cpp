// Robots from MJCF: against MuJoCo's own M and equality rows of the same file, and against the same robot in URDF.
#include <gtest/gtest.h>

#include <functional>

#include "algorithms/kit/test_scalars.h"
#include "models/formats/urdf.h"
#include "property_tests/unit/way_in/mjcf_text.h"

namespace delassus::mjcf_test {
namespace {

using namespace mjcf_test;

using Kind = Constraint::Kind;
using unit::compare_mjcf;
using unit::MjcfRatios;

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

}  // namespace
}  // namespace delassus::mjcf_test
