// Robots from MJCF value by value: joints, limits, shapes, poses, bases, values of followers.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "algorithms/mechanism/loop_closing.h"
#include "models/contacts.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/mjcf_text.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::mjcf_values_test {
namespace {

using namespace mjcf_test;

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

Pose<double> place_of(const Read& r, const std::string& link) {
  Poses<double> at;
  poses(r.model, r.q, at);
  const Frame& f = r.robot.links.at(link);
  return world_pose(at, f.body) * f.placement;
}

void expect_pose(const Pose<double>& x, const Pose<double>& y, const std::string& what) {
  EXPECT_LT(unit::ratio((x.rotation - y.rotation).cwiseAbs().maxCoeff(), 4), 30) << what;
  EXPECT_LT(unit::ratio((x.translation - y.translation).norm(), 8), 30) << what;
}

Pose<double> posed(const Vector3<double>& at, const Vector3<double>& axis, double angle) { return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), at}; }

// The scene's pose before the file's, whatever the base; the file stands still, floats, or hangs on a joint.
TEST(Mjcf, the_pose_of_the_scene_comes_before_the_files) {
  using Base = RobotOptions::Base;
  const std::string inertial = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  for (const char* joint : {"<freejoint/>", "", "<joint axis=\"0 0 1\"/>"})
    for (const Base base : {Base::fixed, Base::free, Base::planar}) {
      RobotOptions o = options(mjcf("posed", "<compiler angle=\"radian\"/><worldbody><body name=\"a\" pos=\"1 2 3\" axisangle=\"0 1 0 0.4\">" + std::string(joint) + inertial +
                                                 "<body name=\"b\" pos=\"0 0 1\" axisangle=\"1 0 0 0.3\"><joint name=\"j\"/>" + inertial + "</body></body></worldbody>"));
      o.pose = posed({0.5, -0.4, 2}, {1, 2, 3}, 0.8);
      o.base = base, o.base_given = joint[0] == 0 || joint[1] == 'f';
      const Read r = read(o);
      const Pose<double> a = o.pose * posed({1, 2, 3}, {0, 1, 0}, 0.4);
      expect_pose(place_of(r, "a"), a, std::string("a") + joint);
      expect_pose(place_of(r, "b"), a * posed({0, 0, 1}, {1, 0, 0}, 0.3), std::string("b") + joint);
    }
}

TEST(Mjcf, one_armature_is_for_joints_without_their_own) {
  RobotOptions o = options(mjcf("armature", tree));
  o.armature_of_all = 0.5, o.armature = {{"reach", 0.125}};
  Read r = read(o);
  EXPECT_EQ(body(r.model, "arm.yaw").joint.armature, std::vector<double>{0.01});
  EXPECT_EQ(body(r.model, "arm.reach").joint.armature, std::vector<double>{0.125});
  EXPECT_EQ(body(r.model, "arm").joint.armature, std::vector<double>{0.5});
  EXPECT_EQ(body(r.model, "hand").joint.armature, std::vector<double>(3, 0.002));
  EXPECT_EQ(body(r.model, "base").joint.armature, std::vector<double>(6, 0));
  o.armature = {{"none", 1}};
  EXPECT_THROW(static_cast<void>(read(o)), ModelError);
}

// Six numbers of an inertia are taken as they are written, unless the compiler was told to change them.
TEST(Mjcf, an_inertia_that_the_compiler_changes_is_the_changed_one) {
  const RobotOptions o = options(mjcf("total", "<compiler angle=\"radian\" settotalmass=\"9\"/>" + std::string(tree).substr(std::string("\n<compiler angle=\"radian\"/>").size())));
  const Read r = read(o);
  double mass = 0;
  for (const Body& b : r.model.bodies) mass += b.mass;
  EXPECT_LT(std::fabs(mass - 9), 1e-14);
  expect_agreement("settotalmass", o, r);
}

TEST(Mjcf, friction_is_the_geom_s_where_it_has_any) {
  const auto friction = [](const std::string& geom) { return read(options(mjcf("friction", "<worldbody><body><freejoint/><geom type=\"sphere\" size=\"0.1\" " + geom + "/></body></worldbody>"))).model.bodies[0].shapes.at(0).friction; };
  EXPECT_EQ(friction("friction=\"0.25 0.5 0.75\""), 0.25);
  EXPECT_EQ(friction("friction=\"0.25\" condim=\"1\""), 0);
  EXPECT_EQ(friction(""), 1) << "MuJoCo's own";
}

// MuJoCo moves a mesh to its own middle and axes; its corners are where the file puts them, and its box is about the shape.
TEST(Mjcf, the_corners_of_a_mesh_are_where_the_file_puts_them) {
  const Vector3<double> corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  const Read r = read(options(mjcf("corners", "<compiler angle=\"radian\"/><asset><mesh name=\"m\" vertex=\"0 0 0  1 0 0  0 2 0  0 0 4\"/></asset>"
      "<worldbody><body name=\"a\"><freejoint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
      "<body name=\"b\" pos=\"0.5 0 0\" axisangle=\"0 0 1 0.3\"><geom type=\"mesh\" mesh=\"m\" mass=\"0\" pos=\"0.1 0.2 0.3\" axisangle=\"1 2 3 0.7\"/></body></body></worldbody>")));
  ASSERT_EQ(r.model.bodies[0].shapes.size(), 1u);
  const Shape& s = r.model.bodies[0].shapes[0];
  ASSERT_EQ(s.points->size(), 4u);
  const Pose<double> there = posed({0.5, 0, 0}, {0, 0, 1}, 0.3) * posed({0.1, 0.2, 0.3}, {1, 2, 3}, 0.7);
  Vector3<double> low = s.points->front(), high = low;
  for (const Vector3<double>& p : *s.points) {
    low = low.cwiseMin(p), high = high.cwiseMax(p);
    EXPECT_TRUE(std::any_of(std::begin(corners), std::end(corners), [&](const auto& c) { return (s.placement * p - there * c).norm() < 1e-5; })) << p.transpose();  // floats
  }
  EXPECT_LT((s.size - high).norm() + (s.size + low).norm(), 1e-14);
}

TEST(Mjcf, held_joints_and_couplings_count_from_their_references) {
  const std::string joints = "<compiler angle=\"radian\"/><worldbody><body name=\"a\"><joint name=\"j\" ref=\"0.3\"/><geom size=\"0.1\"/>"
                             "<body name=\"b\"><joint name=\"k\" ref=\"-0.2\"/><geom size=\"0.1\"/></body></body></worldbody>";
  const Read held = read(options(mjcf("held", joints + "<equality><joint joint1=\"k\" polycoef=\"0.7 0 0 0 0\"/></equality>")));
  EXPECT_EQ(held.model.constraints.at(0).kind, Constraint::Kind::joint_lock);
  EXPECT_EQ(held.model.constraints[0].a.body, 1);
  EXPECT_LT(std::fabs(held.q[1] - 0.5), 1e-15);
  RobotOptions o = options(mjcf("curve", joints + "<equality><joint joint1=\"k\" joint2=\"j\" polycoef=\"0.1 0.5 2 0.25 1\"/></equality><keyframe><key qpos=\"0.7 0\"/></keyframe>"));
  o.keyframe = "0";
  const Read curve = read(o);  // at j − 0.3 = 0.4
  const double value = 0.1 + 0.5 * 0.4 + 2 * 0.16 + 0.25 * 0.064 + 0.0256, slope = 0.5 + 4 * 0.4 + 0.75 * 0.16 + 4 * 0.064;
  ASSERT_EQ(curve.robot.mimics.size(), 1u);
  EXPECT_LT(std::fabs(curve.robot.mimics[0].multiplier - slope), 1e-14);
  EXPECT_LT(std::fabs(curve.robot.mimics[0].offset - (-0.2 + value - slope * 0.7)), 1e-14);
  EXPECT_LT(std::fabs(curve.model.constraints.at(0).terms[1].coefficient + slope), 1e-14);
}

TEST(Mjcf, a_tendon_that_does_not_fit_the_pose_is_told) {
  const auto warnings = [](const std::string& equality) {
    return read(options(mjcf("open", std::string(tree) + "<tendon><fixed name=\"t1\"><joint joint=\"knee\" coef=\"0.5\"/></fixed><fixed name=\"t2\"><joint joint=\"roll\" coef=\"1.5\"/></fixed></tendon>"
                                                         "<equality><tendon " + equality + "/></equality>"))).robot.warnings;
  };
  EXPECT_TRUE(warnings("tendon1=\"t1\"").empty());
  EXPECT_TRUE(warnings("tendon1=\"t1\" tendon2=\"t2\" polycoef=\"0 2 0 0 0\"").empty());
  for (const char* open : {"tendon1=\"t1\" polycoef=\"0.25 0 0 0 0\"", "tendon1=\"t1\" tendon2=\"t2\" polycoef=\"0.25 2 0 0 0\""}) {
    const auto said = warnings(open);
    ASSERT_EQ(said.size(), 1u) << open;
    EXPECT_EQ(said[0].kind, "open coupling");
    EXPECT_NE(said[0].text.find("-0.25"), std::string::npos) << said[0].text;
  }
}

TEST(Mjcf, a_weld_of_sites_holds_their_axes) {
  Read r = read(options(mjcf("sites", "<compiler angle=\"radian\"/><worldbody><body name=\"a\"><freejoint/><geom size=\"0.1\"/><site name=\"s\" pos=\"0.1 0.2 0.3\" axisangle=\"1 2 3 0.5\"/>"
      "<body name=\"b\"><joint/><geom size=\"0.1\"/><site name=\"t\" pos=\"0.4 0.5 0.6\" axisangle=\"3 2 1 0.7\"/></body></body></worldbody><equality><weld name=\"w\" site1=\"s\" site2=\"t\"/></equality>")));
  ASSERT_EQ(r.model.constraints.size(), 1u);
  const Constraint& w = r.model.constraints[0];
  EXPECT_EQ(w.kind, Constraint::Kind::weld);
  EXPECT_EQ(w.a.body, 0);
  EXPECT_EQ(w.b.body, 1);
  expect_pose(w.a.placement, posed({0.1, 0.2, 0.3}, {1, 2, 3}, 0.5), "s");
  expect_pose(w.b.placement, posed({0.4, 0.5, 0.6}, {3, 2, 1}, 0.7), "t");
}

}  // namespace
}  // namespace delassus::mjcf_values_test
