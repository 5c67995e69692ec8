// Value by value what SDF files say: where shapes and meshes stand, whose friction, poses of models and bases, senses of
// joints, limits. Expected are products of the file's own numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "algorithms/mechanism/loop_closing.h"
#include "models/contacts.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/sdf_text.h"

namespace delassus::sdf_values_test {
namespace {

using unit::ratio;
using unit::read_robot;
using unit::sdf;
using unit::sdf_inertial;
using unit::start;
using unit::write_sdf;
using V3 = Vector3<double>;
using Kind = Shape::Kind;

Pose<double> pose(const V3& xyz, const V3& rpy) { return {rotation_rpy(rpy), xyz}; }

const Pose<double> somewhere = pose({1, -2, 0.5}, {0.3, 0.4, -0.7});

void expect_pose(const Pose<double>& x, const Pose<double>& y, const std::string& what) {
  EXPECT_LT(ratio((x.rotation - y.rotation).cwiseAbs().maxCoeff(), 4), 30) << what;
  EXPECT_LT(ratio((x.translation - y.translation).norm(), 8), 30) << what << ": " << x.translation.transpose() << ", not " << y.translation.transpose();
}

struct Placed {
  Model model;
  Robot robot;
  Poses<double> at;

  explicit Placed(const std::string& text, const RobotOptions& o = {}) : robot(read_robot(write_sdf("sdf/values.sdf", text), model, o)) { move(start(model, robot)); }
  void move(const VectorX<double>& q) { poses(model, q, at); }
  [[nodiscard]] Pose<double> link(const std::string& name) const {
    const Frame& f = robot.links.at(name);
    return world_pose(at, f.body) * f.placement;
  }
  [[nodiscard]] Joint& joint(const std::string& name) { return model.bodies[static_cast<std::size_t>(robot.joints.at(name))].joint; }
};

std::string collision(const std::string& name, const std::string& at, const std::string& geometry, const std::string& mu = "") {
  return "<collision name='" + name + "'><pose>" + at + "</pose><geometry>" + geometry + "</geometry>" +
         (mu.empty() ? "" : "<surface><friction><ode><mu>" + mu + "</mu><mu2>9</mu2></ode></friction></surface>") + "</collision>";
}

/// Two links, the second fixed to the first and holding what is given.
std::string pair_of_links(const std::string& inside, const std::string& model_pose = "0 0 0 0 0 0") {
  return "<sdf version='1.9'><model name='m'><pose>" + model_pose + "</pose><link name='a'><pose>0.5 0 1 0.1 0.2 0.3</pose>" + sdf_inertial(1) + "</link>"
         "<link name='b'><pose relative_to='a'>0.1 0.2 0.3 -0.4 0.5 0.6</pose>" + sdf_inertial(1) + inside + "</link>"
         "<joint name='f' type='fixed'><parent>a</parent><child>b</child></joint></model></sdf>";
}

TEST(SdfValues, shapes_and_meshes_stand_where_the_file_puts_them) {
  NEEDS_SDF;
  const std::string at = "0.05 -0.06 0.07 0.8 -0.2 1.4";
  const Placed p(pair_of_links(
      collision("c1", at, "<box><size>0.2 0.4 0.6</size></box>", "0.3") + collision("c2", at, "<sphere><radius>0.11</radius></sphere>", "0.4") +
      collision("c3", at, "<cylinder><radius>0.12</radius><length>0.5</length></cylinder>", "0") + collision("c4", at, "<capsule><radius>0.13</radius><length>0.7</length></capsule>") +
      collision("c5", at, "<capsule><radius>0.14</radius><length>0</length></capsule>") +
      collision("c6", at, "<mesh><uri>nowhere.stl</uri><scale>0.1 0.2 0.3</scale><submesh><name>part</name></submesh></mesh>", "0.6") +
      collision("c7", at, "<plane><normal>0 0 1</normal></plane>") + collision("c8", at, "<cylinder><radius>0.12</radius><length>0</length></cylinder>"), "2 1 0 0 0 0.4"));
  const Pose<double> there = pose({2, 1, 0}, {0, 0, 0.4}) * pose({0.5, 0, 1}, {0.1, 0.2, 0.3}) * pose({0.1, 0.2, 0.3}, {-0.4, 0.5, 0.6}) * pose({0.05, -0.06, 0.07}, {0.8, -0.2, 1.4});
  const Shape expected[] = {{Kind::box, {0.1, 0.2, 0.3}, {}, 0.3, {}}, {Kind::sphere, {0.11, 0, 0}, {}, 0.4, {}}, {Kind::cylinder, {0.12, 0.25, 0}, {}, 0, {}},
                            {Kind::capsule, {0.13, 0.35, 0}, {}, -1, {}}, {Kind::sphere, {0.14, 0, 0}, {}, -1, {}}};
  const auto& shapes = p.model.bodies[0].shapes;
  ASSERT_EQ(shapes.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(shapes[k].kind, expected[k].kind) << k;
    EXPECT_EQ(shapes[k].size, expected[k].size) << k;
    EXPECT_EQ(shapes[k].friction, expected[k].friction) << k;
    expect_pose(world_pose(p.at, 0) * shapes[k].placement, there, "shape " + std::to_string(k));
  }
  ASSERT_EQ(p.robot.meshes.size(), 1u);
  const Robot::Mesh& mesh = p.robot.meshes[0];
  EXPECT_EQ(mesh.body, 0);
  EXPECT_EQ(mesh.scale, V3(0.1, 0.2, 0.3));
  EXPECT_EQ(mesh.uri, "nowhere.stl");
  EXPECT_EQ(mesh.part, "part");
  EXPECT_EQ(mesh.friction, 0.6);
  expect_pose(world_pose(p.at, 0) * mesh.placement, there, "mesh");
  ASSERT_EQ(p.robot.warnings.size(), 1u);
  EXPECT_EQ(p.robot.warnings[0].kind, "flat collision shape");
  EXPECT_NE(p.robot.warnings[0].text.find("\"c8\""), std::string::npos) << p.robot.warnings[0].text;
  EXPECT_TRUE(std::any_of(p.robot.notes.begin(), p.robot.notes.end(), [](const std::string& n) { return n.find("\"c7\"") != std::string::npos && n.find("a plane") != std::string::npos; }));
  EXPECT_THROW((void)Placed(pair_of_links(collision("c", at, "<sphere><radius>-0.1</radius></sphere>"))), ModelError);
}

// The scene's pose, then the model's, then the link's: of a free, a fixed and a planar base, and of joints to the world.
TEST(SdfValues, poses_are_composed_from_the_scene_to_the_link) {
  NEEDS_SDF;
  const Pose<double> a = pose({2, 1, 0}, {0, 0, 0.4}) * pose({0.5, 0, 1}, {0.1, 0.2, 0.3}), b = a * pose({0.1, 0.2, 0.3}, {-0.4, 0.5, 0.6});
  for (const auto base : {RobotOptions::Base::fixed, RobotOptions::Base::free, RobotOptions::Base::planar}) {
    RobotOptions o;
    o.pose = somewhere, o.base = base, o.base_given = true;
    const Placed p(pair_of_links("", "2 1 0 0 0 0.4"), o);
    expect_pose(p.link("a"), somewhere * a, "a");
    expect_pose(p.link("b"), somewhere * b, "b");
  }
  RobotOptions o;
  o.pose = somewhere;
  // A joint to the world at the end of a link turned away from it; then the loop back to the world.
  const std::string links = "<link name='a'><pose>0.5 0 1 0.1 0.2 0.3</pose>" + sdf_inertial(1) + "</link><link name='b'><pose>0.7 0.1 1 0 0 0.3</pose>" + sdf_inertial(1) + "</link>";
  const std::string joints = "<joint name='w' type='prismatic'><pose>0.2 0 0 0.3 0 0</pose><parent>world</parent><child>a</child><axis><xyz>0 0.6 0.8</xyz></axis></joint>"
                             "<joint name='j' type='revolute'><pose>0.1 0 0 0 0 0</pose><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis></joint>";
  Placed p(sdf(links + joints + "<joint name='back' type='ball'><pose>0 0.3 0 0 0 0</pose><parent>world</parent><child>b</child></joint>"), o);
  ASSERT_EQ(p.model.dofs(), 2);
  expect_pose(p.link("a"), somewhere * pose({0.5, 0, 1}, {0.1, 0.2, 0.3}), "a on the world");
  expect_pose(p.link("b"), somewhere * pose({0.7, 0.1, 1}, {0, 0, 0.3}), "b");
  ASSERT_EQ(p.model.constraints.size(), 1u);
  const Constraint& c = p.model.constraints[0];
  EXPECT_EQ(c.a.body, p.robot.links.at("b").body);
  EXPECT_EQ(c.b.body, ground);
  EXPECT_LT(ratio(closure_error(p.model, c, p.at).norm(), 8), 30);
  // Travel along the axis of the joint's frame, from the world.
  p.move((VectorX<double>(2) << 0.25, 0).finished());
  const Pose<double> joint_frame = pose({0.5, 0, 1}, {0.1, 0.2, 0.3}) * pose({0.2, 0, 0}, {0.3, 0, 0});
  const V3 travel = somewhere.rotation * (joint_frame.rotation * V3(0, 0.6, 0.8)) * 0.25;
  expect_pose(p.link("a"), {(somewhere * pose({0.5, 0, 1}, {0.1, 0.2, 0.3})).rotation, (somewhere * pose({0.5, 0, 1}, {0.1, 0.2, 0.3})).translation + travel}, "a, moved");
}

TEST(SdfValues, nested_models_and_what_stands_still) {
  NEEDS_SDF;
  const std::string inner = "<model name='in'><pose>0 0 2 0 0.5 0</pose><link name='a'><pose>1 0 0 0 0 0.5</pose>" + sdf_inertial(1) + "</link></model>";
  const Placed moving(sdf(inner)), still(sdf("<static>true</static>" + inner));
  const Pose<double> there = pose({0, 0, 2}, {0, 0.5, 0}) * pose({1, 0, 0}, {0, 0, 0.5});
  EXPECT_EQ(moving.model.dofs(), 6);
  EXPECT_EQ(still.model.dofs(), 0);
  expect_pose(moving.link("in::a"), there, "moving");
  expect_pose(still.link("in::a"), there, "standing");
}

TEST(SdfValues, gears_turn_the_way_their_axes_do) {
  NEEDS_SDF;
  for (const double sense : {1.0, -1.0})
    for (const char* ratio_given : {"<gearbox_ratio>3</gearbox_ratio>", ""}) {
      const std::string z = sense > 0 ? "0 0 1" : "0 0 -1";
      Placed p(sdf("<link name='a'>" + sdf_inertial(1) + "</link><link name='b'>" + sdf_inertial(1) + "</link><link name='c'>" + sdf_inertial(1) + "</link>"
        "<joint name='jb' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
        "<joint name='jc' type='continuous'><parent>a</parent><child>c</child><axis><xyz>" + z + "</xyz></axis></joint>"
        "<joint name='g' type='gearbox'><parent>b</parent><child>c</child>" + ratio_given + "<gearbox_reference_body>a</gearbox_reference_body>"
        "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>"));
      const double ratio_expected = *ratio_given != 0 ? 3 : 1;
      ASSERT_EQ(p.robot.mimics.size(), 1u);
      const Robot::Mimic& m = p.robot.mimics[0];
      EXPECT_EQ(m.body, p.robot.joints.at("jc"));
      EXPECT_EQ(m.master, p.robot.joints.at("jb"));
      EXPECT_EQ(m.multiplier, -ratio_expected * sense);
      EXPECT_EQ(m.offset, 0);
      const MatrixX<double> J = unit::constraint_jacobian(kinematics(p.model, start(p.model, p.robot)));
      ASSERT_EQ(J.rows(), 1);
      const Index b = p.model.first_dof[static_cast<std::size_t>(m.master)], c = p.model.first_dof[static_cast<std::size_t>(m.body)];
      EXPECT_EQ(-J(0, b) / J(0, c), m.multiplier);
    }
}

TEST(SdfValues, armatures_and_limits_are_each_joint_s_own) {
  NEEDS_SDF;
  const std::string limits = "<limit><lower>-1</lower><upper>2</upper><effort>30</effort><velocity>4</velocity></limit><dynamics><damping>0.7</damping><friction>0.2</friction></dynamics>";
  RobotOptions o;
  o.armature_of_all = 0.25, o.armature = {{"ju", 0.5}};
  const std::string links = "<link name='a'>" + sdf_inertial(1) + "</link><link name='b'>" + sdf_inertial(1) + "</link><link name='c'>" + sdf_inertial(1) + "</link><link name='d'>" + sdf_inertial(1) + "</link><link name='e'>" + sdf_inertial(1) + "</link>";
  Placed p(sdf(links +
    "<joint name='jr' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 2</xyz>" + limits + "</axis></joint>"
    "<joint name='ju' type='universal'><parent>b</parent><child>c</child><axis><xyz>1 0 0</xyz>" + limits + "</axis><axis2><xyz>0 1 0</xyz><limit><lower>-3</lower></limit></axis2></joint>"
    "<joint name='js' type='screw'><parent>a</parent><child>d</child><thread_pitch>2</thread_pitch><axis><xyz>0 0 1</xyz>" + limits + "</axis></joint>"
    "<joint name='jb' type='ball'><parent>d</parent><child>e</child></joint>"), o);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  using List = std::vector<double>;
  const Joint &r = p.joint("jr"), &u = p.joint("ju"), &s = p.joint("js"), &b = p.joint("jb");
  EXPECT_EQ(r.axis, V3(0, 0, 1));
  EXPECT_EQ(r.lower, List{-1});
  EXPECT_EQ(r.upper, List{2});
  EXPECT_EQ(r.effort, List{30});
  EXPECT_EQ(r.velocity, List{4});
  EXPECT_EQ(r.damping, List{0.7});
  EXPECT_EQ(r.friction, List{0.2});
  EXPECT_EQ(r.armature, List{0.25});
  EXPECT_EQ(u.type, JointType::universal);
  EXPECT_EQ(u.axis, V3(1, 0, 0));
  EXPECT_EQ(u.axis2, V3(0, 1, 0));
  EXPECT_EQ(u.lower, (List{-1, -3}));
  EXPECT_EQ(u.upper, (List{2, infinity}));
  EXPECT_EQ(u.effort, (List{30, infinity}));
  EXPECT_EQ(u.velocity, (List{4, infinity}));
  EXPECT_EQ(u.damping, (List{0.7, 0}));
  EXPECT_EQ(u.friction, (List{0.2, 0}));
  EXPECT_EQ(u.armature, (List{0.5, 0.5}));
  EXPECT_EQ(s.type, JointType::cylindrical);
  EXPECT_TRUE(s.lower.empty());
  EXPECT_EQ(s.damping, (List{0.7, 0}));
  EXPECT_EQ(s.friction, (List{0.2, 0}));
  EXPECT_EQ(b.type, JointType::spherical);
  EXPECT_EQ(b.armature, List(3, 0.25));
  const Joint& base = p.model.bodies[0].joint;
  EXPECT_TRUE(base.armature.empty() || base.armature == List(6, 0));
  ASSERT_EQ(p.robot.warnings.size(), 1u);
  EXPECT_EQ(p.robot.warnings[0].kind, "screw joint");
  // Reversed limits are left out with a warning; an armature of a joint that does not move is refused.
  Placed reversed(sdf(links + "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz><limit><lower>2</lower><upper>-1</upper></limit></axis></joint>"));
  EXPECT_EQ(reversed.joint("j").lower, List{-infinity});
  EXPECT_EQ(reversed.joint("j").upper, List{infinity});
  ASSERT_EQ(reversed.robot.warnings.size(), 1u);
  EXPECT_EQ(reversed.robot.warnings[0].kind, "reversed limits");
  const std::string fixed = sdf(links + "<joint name='j' type='fixed'><parent>a</parent><child>b</child></joint>");
  for (const char* name : {"j", "none"}) {
    RobotOptions wrong;
    wrong.armature = {{name, 1}};
    EXPECT_THROW((void)Placed(fixed, wrong), ModelError) << name;
  }
  RobotOptions typed;
  typed.joint_types.emplace("j", RobotOptions::Type{});
  EXPECT_THROW((void)Placed(fixed, typed), ModelError);
}

// What later versions of SDF added is not known to libsdformat 12, which reads the rest and says so.
TEST(SdfValues, of_later_versions_nothing_is_made_up) {
  NEEDS_SDF;
  const auto versioned = [](const std::string& version, const std::string& inside) { return "<sdf version='" + version + "'>\n<model name='m'>\n" + inside + "</model></sdf>"; };
  const auto warned = [](const Placed& p) { return p.robot.warnings.size() == 1 ? p.robot.warnings[0].text : std::to_string(p.robot.warnings.size()) + " warnings"; };
  const std::string link = "<link name='a'>" + sdf_inertial(2) + "</link>";
  EXPECT_TRUE(Placed(versioned("1.6", link)).robot.warnings.empty());
  for (const char* version : {"1.10", "9.9"}) {
    const Placed p(versioned(version, link));
    EXPECT_EQ(p.model.bodies[0].mass, 2);
    for (const std::string& said : {std::string("<sdf version>"), "from SDF version " + std::string(version), std::string("read as 1.9"), std::string("what a later one added is not read")})
      EXPECT_NE(warned(p).find(said), std::string::npos) << warned(p);
  }
  EXPECT_THROW((void)Placed(versioned("1.10", "<link name='a::b'>" + sdf_inertial(2) + "</link>")), ModelError) << "1.10 is later than 1.8";
  // Mass and inertia of the shapes: refused where they enter M, by line; without <mass>, SDF's 1 kg is said.
  const std::string shape = "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>";
  const std::string automatic = "<link name='a'><inertial auto='true'><density>500</density></inertial>" + shape + "</link>";
  try {
    (void)Placed(sdf(automatic));
    ADD_FAILURE() << "1 kg made up";
  } catch (const ModelError& e) {
    for (const char* said : {"link \"a\" (line 4)", "auto=\"true\"", "<mass> [kg] and <inertia> [kg m^2]"}) EXPECT_NE(std::string(e.what()).find(said), std::string::npos) << e.what();
  }
  EXPECT_EQ(Placed(sdf("<static>true</static>" + automatic)).model.dofs(), 0);
  EXPECT_NE(warned(Placed(sdf("<link name='a'><inertial><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>"))).find("has no <mass>: SDF then takes 1 kg"), std::string::npos);
}

// libsdformat 12 has no such joint, whatever the version of the file; nothing here turns it round.
TEST(SdfValues, the_world_is_no_child) {
  NEEDS_SDF;
  try {
    (void)Placed(sdf("<link name='a'>" + sdf_inertial(1) + "</link><joint name='j' type='revolute'><parent>a</parent><child>world</child><axis><xyz>0 0 1</xyz></axis></joint>"));
    ADD_FAILURE();
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find("invalid child link [world]"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace delassus::sdf_values_test
