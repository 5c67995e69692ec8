// Robots from SDF: the same robot as URDF, loops closed by the file's own joints, frames, what is said and refused.
#include <gtest/gtest.h>

#include "models/robot.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/sdf_text.h"
#include "reference/definition.h"

namespace delassus::sdf_test {
namespace {

using test::temporary;
using unit::read_robot;
using unit::sdf;
using unit::sdf_inertial;
using unit::start;
using unit::write_sdf;

constexpr double eps = 0x1p-53;

MatrixX<double> M_of(const Model& model, const VectorX<double>& q) { return reference::mass_matrix(kinematics(model, q)); }

// An arm of three joints, each link turned in its inertial, once as URDF and once as SDF with poses in the model's frame.
const char* const arm_urdf = R"(<robot name="arm">
<link name="base"><inertial><mass value="2"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.1 0.02 -0.03" rpy="0.3 -0.2 0.5"/><mass value="1.5"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="rail"><inertial><origin xyz="0 0.2 0" rpy="0 0 1"/><mass value="0.5"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="tip"><inertial><origin xyz="0.05 0 0.1"/><mass value="0.25"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="cap"><inertial><mass value="0.125"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0.1 0.2" rpy="0.1 0.2 0.3"/><axis xyz="0 0.6 0.8"/>
<limit lower="-1" upper="2" effort="30" velocity="4"/><dynamics damping="0.7" friction="0.2"/></joint>
<joint name="slide" type="prismatic"><parent link="upper"/><child link="rail"/><origin xyz="0.3 0 0" rpy="0 0 0.7"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="wrist" type="continuous"><parent link="rail"/><child link="tip"/><origin xyz="0 0.4 0" rpy="-0.5 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="weld" type="fixed"><parent link="tip"/><child link="cap"/><origin xyz="0 0 0.3" rpy="0 0.4 0"/></joint>
</robot>)";

std::string arm_sdf(bool nested = false) {
  const std::string links =
      "<link name='base'>" + sdf_inertial(2) + "</link>"
      "<link name='upper'><pose relative_to='shoulder'/>" + sdf_inertial(1.5, "0.1 0.02 -0.03 0.3 -0.2 0.5") + "</link>"
      "<link name='rail'><pose relative_to='slide'/>" + sdf_inertial(0.5, "0 0.2 0 0 0 1") + "</link>"
      "<link name='tip'><pose relative_to='wrist'/>" + sdf_inertial(0.25, "0.05 0 0.1 0 0 0") + "</link>"
      "<link name='cap'><pose relative_to='tip'>0 0 0.3 0 0.4 0</pose>" + sdf_inertial(0.125) + "</link>";
  const std::string joints =
      "<frame name='turned' attached_to='base'><pose>0 0.1 0.2 0.1 0.2 0.3</pose></frame>"
      "<joint name='shoulder' type='revolute'><pose relative_to='turned'/><parent>base</parent><child>upper</child>"
      "<axis><xyz expressed_in='turned'>0 0.6 0.8</xyz><limit><lower>-1</lower><upper>2</upper><effort>30</effort><velocity>4</velocity></limit>"
      "<dynamics><damping>0.7</damping><friction>0.2</friction></dynamics></axis></joint>"
      "<joint name='slide' type='prismatic'><pose relative_to='upper'>0.3 0 0 0 0 0.7</pose><parent>upper</parent><child>rail</child>"
      "<axis><xyz>1 0 0</xyz><limit><lower>-1</lower><upper>1</upper><effort>1</effort><velocity>1</velocity></limit></axis></joint>"
      "<joint name='wrist' type='continuous'><pose relative_to='rail'>0 0.4 0 -0.5 0 0</pose><parent>rail</parent><child>tip</child><axis><xyz>0 0 1</xyz></axis></joint>"
      "<joint name='weld' type='fixed'><parent>tip</parent><child>cap</child></joint>";
  return sdf(nested ? "<model name='inner'>" + links + joints + "</model>" : links + joints);
}

TEST(Sdf, the_same_robot_as_in_urdf) {
  NEEDS_SDF;
  for (const bool nested : {false, true})
    for (const auto base : {RobotOptions::Base::fixed, RobotOptions::Base::free, RobotOptions::Base::planar}) {
      RobotOptions o;
      o.base = base, o.base_given = true;
      o.pose = {rotation_rpy({0.2, -0.4, 1.1}), Vector3<double>(1, 2, 3)};
      Model a, b;
      const Robot u = read_robot(write_sdf("sdf/arm.urdf", arm_urdf), a, o), s = read_robot(write_sdf("sdf/arm.sdf", arm_sdf(nested)), b, o);
      ASSERT_EQ(a.dofs(), b.dofs());
      VectorX<double> q = start(b, s);
      for (Index k = 0; k < 3; ++k) q[q.size() - 1 - k] = 0.3 + 0.4 * static_cast<double>(k);
      const MatrixX<double> Ma = M_of(a, q), Mb = M_of(b, q);
      EXPECT_LT((Ma - Mb).norm() / (eps * 5 * Ma.norm()), 30);
      for (const char* joint : {"shoulder", "slide", "wrist"}) {
        const Joint &x = a.bodies[static_cast<std::size_t>(u.joints.at(joint))].joint;
        const Joint &y = b.bodies[static_cast<std::size_t>(s.joints.at((nested ? "inner::" : "") + std::string(joint)))].joint;
        EXPECT_EQ(x.lower, y.lower) << joint;
        EXPECT_EQ(x.upper, y.upper) << joint;
        EXPECT_EQ(x.effort, y.effort) << joint;
        EXPECT_EQ(x.velocity, y.velocity) << joint;
        EXPECT_EQ(x.damping, y.damping) << joint;
        EXPECT_EQ(x.friction, y.friction) << joint;
      }
      Poses<double> pa, pb;
      poses(a, q, pa), poses(b, q, pb);
      for (const char* link : {"base", "upper", "tip", "cap"}) {
        const Frame &x = u.links.at(link), &y = s.links.at((nested ? "inner::" : "") + std::string(link));
        const auto at = [](const Poses<double>& p, const Frame& f) {
          if (f.body == ground) return f.placement;
          const auto i = static_cast<std::size_t>(f.body);
          return Pose<double>{p.rotation[i], p.position[i] + p.reference[static_cast<std::size_t>(p.tree[i])]} * f.placement;
        };
        const Pose<double> X = at(pa, x), Y = at(pb, y);
        EXPECT_LT((X.translation - Y.translation).norm() / (eps * 5 * X.translation.norm()), 30) << link;
        EXPECT_LT((X.rotation - Y.rotation).norm() / (eps * 5), 30) << link;
      }
    }
}

/// Four bars of a parallelogram in the plane normal to (1, 1, 1), four joints; the last one closes the loop.
std::string four_bar(const std::string& last) {
  const std::string turn = "0 0 0 0.3 0.6154797 0.7853982";
  std::string out = "<frame name='plane'><pose>" + turn + "</pose></frame>";
  auto link = [&](const char* name, const char* at) { out += "<link name='" + std::string(name) + "'><pose relative_to='plane'>" + at + "</pose>" + sdf_inertial(1) + "</link>"; };
  link("ground", "0 0 0 0 0 0"), link("left", "0 0.5 0 0 0 0"), link("top", "0.5 1 0 0 0 0"), link("right", "1 0.5 0 0 0 0");
  auto joint = [&](const std::string& name, const std::string& type, const char* parent, const char* child, const char* at) {
    out += "<joint name='" + name + "' type='" + type + "'><pose relative_to='plane'>" + at + "</pose><parent>" + parent + "</parent><child>" + child +
           "</child>" + (type == "ball" || type == "fixed" ? "" : "<axis><xyz expressed_in='plane'>" + std::string(type == "prismatic" ? "1 0 0" : "0 0 1") + "</xyz></axis>") +
           (type == "universal" ? "<axis2><xyz expressed_in='plane'>1 0 0</xyz></axis2>" : "") + "</joint>";
  };
  joint("stand", "fixed", "world", "ground", "0 0 0 0 0 0");
  joint("a", "revolute", "ground", "left", "0 0 0 0 0 0");
  joint("b", "revolute", "left", "top", "0 1 0 0 0 0");
  joint("c", "revolute", "ground", "right", "1 0 0 0 0 0");
  joint("d", last, "right", "top", "1 1 0 0 0 0");
  return sdf(out);
}

TEST(Sdf, a_loop_of_the_file_has_the_right_mobility) {
  NEEDS_SDF;
  struct Case {
    const char* type;
    Constraint::Kind kind;
    Index rows, rank;
  };
  // Three tree joints in the plane; a hinge, a point or a universal joint takes 2 of their 3 freedoms, a weld all of them.
  for (const Case& c : {Case{"revolute", Constraint::Kind::hinge, 5, 2}, Case{"ball", Constraint::Kind::point, 3, 2},
                        Case{"universal", Constraint::Kind::universal, 4, 2}, Case{"fixed", Constraint::Kind::weld, 6, 3},
                        Case{"prismatic", Constraint::Kind::prismatic, 5, 2}}) {
    Model model;
    const Robot robot = read_robot(write_sdf("sdf/four_bar.sdf", four_bar(c.type)), model);
    ASSERT_EQ(model.dofs(), 3) << c.type;
    ASSERT_EQ(model.constraints.size(), 1u) << c.type;
    const Constraint& loop = model.constraints[0];
    EXPECT_TRUE(loop.loop);
    EXPECT_EQ(loop.kind, c.kind) << c.type;
    EXPECT_EQ(row_count(model, loop), c.rows) << c.type;
    Poses<double> p;
    poses(model, neutral(model), p);
    EXPECT_LT(closure_error(model, loop, p).norm() / (eps * 4), 30) << c.type;
    const MatrixX<double> J = reference::constraint_jacobian(kinematics(model, neutral(model)));
    Eigen::JacobiSVD<MatrixX<double>> svd(J);
    const auto sigma = svd.singularValues();
    Index rank = 0;
    for (Index k = 0; k < sigma.size(); ++k) rank += sigma[k] > 1e-6;
    EXPECT_EQ(rank, c.rank) << c.type;
  }
}

TEST(Sdf, the_world_the_base_and_static_models) {
  NEEDS_SDF;
  const std::string links = "<link name='a'><pose>0 0 1 0 0 0</pose>" + sdf_inertial(1) + "</link><link name='b'>" + sdf_inertial(1) + "</link>"
                            "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis></joint>";
  const std::string hung = "<joint name='w' type='fixed'><parent>world</parent><child>a</child></joint>";
  auto dofs = [&](const std::string& inside, RobotOptions o = {}) {
    Model model;
    const Robot robot = read_robot(write_sdf("sdf/base.sdf", sdf(inside)), model, o);
    return model.dofs();
  };
  RobotOptions free, fixed;
  free.base_given = fixed.base_given = true;
  fixed.base = RobotOptions::Base::fixed;
  EXPECT_EQ(dofs(links), 7);
  EXPECT_EQ(dofs(links + hung), 1);
  EXPECT_EQ(dofs(links + hung, free), 7);
  EXPECT_EQ(dofs(links, fixed), 1);
  EXPECT_EQ(dofs("<joint name='w' type='revolute'><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz></axis></joint>" + links), 2);
  Model model;
  const std::string world = "<sdf version='1.9'><world name='w'><model name='one'><pose>0 0 5 0 0 0</pose>" + links + "</model><model name='two'>" + links +
                            "</model><model name='floor'><static>true</static><link name='f'/></model></world></sdf>";
  const Robot robot = read_robot(write_sdf("sdf/world.sdf", world), model);
  EXPECT_EQ(model.dofs(), 14);
  EXPECT_EQ(robot.links.count("two::b"), 1u);
  EXPECT_EQ(robot.links.at("floor::f").body, ground);
  ASSERT_EQ(robot.start.size(), 2u);
  EXPECT_EQ(robot.start[0].second[2], 6);
}

TEST(Sdf, screws_and_gears_are_coupled) {
  NEEDS_SDF;
  Model screw;
  (void)read_robot(write_sdf("sdf/screw.sdf", sdf("<link name='a'>" + sdf_inertial(1) + "</link><link name='b'>" + sdf_inertial(1) + "</link>"
    "<joint name='w' type='fixed'><parent>world</parent><child>a</child></joint>"
    "<joint name='s' type='screw'><parent>a</parent><child>b</child><thread_pitch>-4</thread_pitch><axis><xyz>0 0 1</xyz></axis></joint>")), screw);
  ASSERT_EQ(screw.dofs(), 2);
  MatrixX<double> J = reference::constraint_jacobian(kinematics(screw, neutral(screw)));
  ASSERT_EQ(J.rows(), 1);
  EXPECT_EQ(J(0, 0) / J(0, 1), -0.25);  // travel − angle / 4 = 0
  Model gear;
  const Robot r = read_robot(write_sdf("sdf/gear.sdf", sdf("<link name='a'>" + sdf_inertial(1) + "</link><link name='b'>" + sdf_inertial(1) + "</link><link name='c'>" + sdf_inertial(1) + "</link>"
    "<joint name='w' type='fixed'><parent>world</parent><child>a</child></joint>"
    "<joint name='jb' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
    "<joint name='jc' type='revolute'><parent>a</parent><child>c</child><axis><xyz>0 0 -1</xyz></axis></joint>"
    "<joint name='g' type='gearbox'><parent>b</parent><child>c</child><gearbox_ratio>3</gearbox_ratio><gearbox_reference_body>a</gearbox_reference_body>"
    "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>")), gear);
  ASSERT_EQ(gear.dofs(), 2);
  J = reference::constraint_jacobian(kinematics(gear, neutral(gear)));
  ASSERT_EQ(J.rows(), 1);
  EXPECT_EQ(J(0, gear.first_dof[static_cast<std::size_t>(r.joints.at("jc"))]) / J(0, gear.first_dof[static_cast<std::size_t>(r.joints.at("jb"))]), -1.0 / 3);  // −q_c = −3 q_b
}

TEST(Sdf, says_what_it_cannot_read) {
  NEEDS_SDF;
  auto refused = [&](const std::string& text, const std::string& part) {
    Model model;
    try {
      (void)read_robot(write_sdf("sdf/bad.sdf", text), model);
      ADD_FAILURE() << "accepted: " << part;
    } catch (const ModelError& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  const std::string a = "<link name='a'>" + sdf_inertial(1) + "</link>";
  refused(sdf("<link name='a'><inertial><mass>2kg</mass></inertial></link>"), "\"2kg\" is not finite");
  refused(sdf("<link name='a'><inertial><mass>1e999</mass></inertial></link>"), "1e999");
  refused(sdf("<link name='a'><inertial><mass>1 2</mass></inertial></link>"), "holds 2 numbers: \"1 2\" (accepted: 1 number)");
  refused(sdf("<link name='a'><pose>1 2 3</pose>" + sdf_inertial(1) + "</link>"), "holds 3 numbers");
  refused(sdf(a + "<joint name='j' type='revolute'><parent>a</parent><child>nobody</child><axis><xyz>0 0 1</xyz></axis></joint>"), "nobody");
  refused(sdf(a + a), "a");
  refused(sdf(""), "libsdformat");
  refused("<sdf version='1.9'/>", "no link");
  refused(sdf(a + "<link name='b'>" + sdf_inertial(1) + "</link><joint name='j' type='universal'><parent>a</parent><child>b</child>"
    "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>"), "parallel");
  Model plain;  // what has no part in M, J and contacts is not judged
  const std::string odd = "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry><material><script><name>x</name></script></material></visual><sensor name='s' type='crystal_ball'/>"
                          "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry><surface><friction><ode><mu>-1</mu></ode></friction></surface></collision>";
  const Robot kept = read_robot(write_sdf("sdf/odd.sdf", sdf("<link name='a'>" + sdf_inertial(1) + odd + "</link>")), plain);
  EXPECT_TRUE(kept.warnings.empty());
  ASSERT_EQ(plain.bodies[0].shapes.size(), 1u);
  EXPECT_LT(plain.bodies[0].shapes[0].friction, 0);
  Model model;
  const Robot r = read_robot(write_sdf("sdf/include.sdf", "<sdf version='1.9'><world name='w'><include><uri>model://no_such_model</uri></include><model name='m'>" + a + "</model></world></sdf>"), model);
  ASSERT_FALSE(r.warnings.empty());
  EXPECT_EQ(r.warnings[0].kind, "include not found");
  Model twice;  // libsdformat takes the first in silence
  const Robot first = read_robot(write_sdf("sdf/twice.sdf", sdf("<link name='a'><inertial><mass>2</mass><mass>3</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>")), twice);
  ASSERT_EQ(first.warnings.size(), 1u);
  EXPECT_EQ(first.warnings[0].kind, "given twice");
  EXPECT_EQ(twice.bodies[0].mass, 2);
  RobotOptions strict;
  strict.strict = true;
  EXPECT_THROW((void)read_robot(temporary("sdf/include.sdf").string(), model, strict), ModelError);
}

}  // namespace
}  // namespace delassus::sdf_test
