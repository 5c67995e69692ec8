// The second reading of URDF files: closed forms, the library's own robots, and differences that it must see.
#include "algorithms/kit/test_scalars.h"
#include "reference/urdf_witness.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <functional>

#include "models/robot.h"
#include "property_tests/unit/operators/path_sums.h"
#include "reference/definition.h"

namespace delassus::urdf_witness_test {
namespace {

using reference::parse_urdf_witness;
using reference::UrdfMatrices;
using reference::UrdfWitness;

const std::string pendulum = R"(<?xml version="1.0"?>
<robot name="p">
  <link name="stand"/>
  <link name="rod"><inertial><origin xyz="0 0 -0.5" rpy="0.3 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="slide"><inertial><mass value="3"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="stand"/><child link="rod"/><axis xyz="0 2 0"/><dynamics armature="0.25"/></joint>
  <joint name="push" type="prismatic"><parent link="rod"/><child link="slide"/><origin xyz="0 0 -1"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="turn" multiplier="2"/></joint>
</robot>)";

struct Loaded {
  Model model;
  Robot robot;
};

Loaded load(const std::string& file, RobotOptions::Base base) {
  Loaded out;
  RobotOptions options;
  options.file = file, options.robot = "r", options.base = base, options.base_given = true;
  out.robot = add_robot(out.model, options);
  return out;
}

std::string saved(const std::string& text) {
  const std::string file = testing::TempDir() + "witness_" + std::to_string(std::hash<std::string>{}(text)) + ".urdf";
  std::ofstream(file) << text;
  return file;
}

double worst(const MatrixX<Quad>& x, const MatrixX<Quad>& y, const MatrixX<Quad>& bound) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i)
      largest = std::max(largest, unit::ratio(static_cast<double>(x(i, j) - y(i, j)), static_cast<double>(bound(i, j))));
  return largest;
}

/// Largest ratio of M, J and J M⁻¹ Jᵀ of the model against the witness.
double compare(const UrdfWitness& witness, Loaded loaded, const VectorX<double>& q) {
  const std::vector<Index> leaves = witness.leaves();
  for (const Index i : leaves) {
    Constraint c;
    c.kind = Constraint::Kind::weld;
    c.a = loaded.robot.links.at(witness.links[static_cast<std::size_t>(i)].name);
    loaded.model.constraints.push_back(c);
  }
  const UrdfMatrices theirs = reference::urdf_matrices(witness, loaded.model, "r", q, leaves);
  EXPECT_TRUE(theirs.regular);
  const Problem<double> problem = kinematics<double>(loaded.model, q);
  const auto ours = reference::dense(problem.cast<Quad>(), Damping<double>::uniform(problem.structure->rows, 0).cast<Quad>());
  const double ratios[] = {worst(ours.M, theirs.M, theirs.M_bound), worst(ours.J, theirs.J, theirs.J_bound), worst(ours.A0, theirs.A0, theirs.A_bound)};
  std::printf("  M %.2g  J %.2g  A %.2g\n", ratios[0], ratios[1], ratios[2]);
  return std::max({ratios[0], ratios[1], ratios[2]});
}

TEST(UrdfWitness, gives_the_closed_form_of_a_pendulum_with_a_slide) {
  const Loaded p = load(saved(pendulum), RobotOptions::Base::fixed);
  const UrdfWitness w = parse_urdf_witness(pendulum);
  EXPECT_EQ(w.total_mass(), 5);
  EXPECT_EQ(w.moving(), 2);
  VectorX<double> q(2);
  q << 0.7, 0.5;
  const UrdfMatrices m = reference::urdf_matrices(w, p.model, "r", q, w.leaves());
  // turn: armature, I + m l² of the rod, I + M (1 + q)² of the slide; push: its mass; they do not couple
  EXPECT_NEAR(static_cast<double>(m.M(0, 0)), 0.25 + 0.1 + 2 * 0.25 + 0.01 + 3 * 1.5 * 1.5, 1e-14);
  EXPECT_NEAR(static_cast<double>(m.M(1, 1)), 3, 1e-15);
  EXPECT_NEAR(static_cast<double>(m.M(0, 1)), 0, 1e-30);
  ASSERT_EQ(m.J.rows(), 7);
  EXPECT_EQ(static_cast<double>(m.J(0, 0)), -2);
  EXPECT_EQ(static_cast<double>(m.J(0, 1)), 1);
  EXPECT_NEAR(static_cast<double>(m.J(2, 0)), 1, 1e-30);     // ω about y
  EXPECT_NEAR(static_cast<double>(m.J(4, 0)), -1.5, 1e-30);  // a point below moves to −x
  EXPECT_NEAR(static_cast<double>(m.J(6, 1)), -1, 1e-30);
}

TEST(UrdfWitness, agrees_on_the_robots_of_the_library) {
  for (const char* name : {"go2", "g1", "cassie"})
    for (const auto base : {RobotOptions::Base::free, RobotOptions::Base::fixed}) {
      const std::string file = "models/robots/" + std::string(name) + ".urdf";
      Loaded loaded = load(file, base);
      const UrdfWitness w = reference::read_urdf_witness(file);
      EXPECT_EQ(w.moving() + (base == RobotOptions::Base::free), static_cast<Index>(loaded.model.bodies.size()));
      unit::Random random(7);
      EXPECT_LT(compare(w, loaded, unit::random_configuration(loaded.model, random)), 30) << name;
    }
}

TEST(UrdfWitness, sees_what_is_different) {
  using Change = std::function<void(Model&)>;
  const std::vector<std::pair<const char*, Change>> changes{
      {"mass", [](Model& m) { m.bodies[1].mass *= 1 + 1e-9; }},
      {"centre of mass", [](Model& m) { m.bodies[1].com[1] += 1e-9; }},
      {"inertia", [](Model& m) { m.bodies[1].inertia(0, 1) *= -1, m.bodies[1].inertia(1, 0) *= -1; }},
      {"axis", [](Model& m) { m.bodies[1].joint.axis *= -1; }},
      {"armature", [](Model& m) { m.bodies[1].joint.armature = {1e-9}; }},
      {"placement", [](Model& m) { m.bodies[1].joint.placement.translation[2] += 1e-9; }}};
  const std::string file = "models/robots/go2.urdf";
  for (const auto& [name, change] : changes) {
    Loaded loaded = load(file, RobotOptions::Base::free);
    loaded.model.bodies[1].inertia(0, 1) = loaded.model.bodies[1].inertia(0, 1) == 0 ? 1e-3 : loaded.model.bodies[1].inertia(0, 1);
    change(loaded.model);
    unit::Random random(7);
    EXPECT_GE(compare(reference::read_urdf_witness(file), loaded, unit::random_configuration(loaded.model, random)), 30) << name;
  }
}

TEST(UrdfWitness, says_whether_M_is_regular) {
  EXPECT_TRUE(reference::urdf_regular(parse_urdf_witness(pendulum), false));
  EXPECT_TRUE(reference::urdf_regular(parse_urdf_witness(pendulum), true));  // the armature tells the stand from the rod
  std::string text = pendulum;
  text.replace(text.find(R"(armature="0.25")"), 15, "");
  EXPECT_TRUE(reference::urdf_regular(parse_urdf_witness(text), false));
  EXPECT_FALSE(reference::urdf_regular(parse_urdf_witness(text), true));  // the stand has no mass
}

TEST(UrdfWitness, refuses_what_is_no_urdf) {
  const auto with = [](std::string from, const std::string& to) {
    std::string text = pendulum;
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string& text : {std::string(), std::string("<?xml version=\"1.0\"?>"), std::string("<!-- -->"), pendulum + "<robot/>",
                                  pendulum + std::string(1, '\0'), with("value=\"2\"", "value=\"0x2\""), with("value=\"2\"", "value=\"2\" value=\"3\""),
                                  with("value=\"2\"", "value=\"1e999\""), with("value=\"2\"", "value=\"nan\""), with("value=\"2\"", "value=\"2,5\""),
                                  with("0 2 0", "0 0 0"), with("0 2 0", "0 2"), with("child link=\"slide\"", "child link=\"rod\"")})
    EXPECT_THROW(static_cast<void>(parse_urdf_witness(text)), std::runtime_error) << text;
  EXPECT_EQ(parse_urdf_witness(with("<mass value=\"2\"/>", "<mass value=\"2\"/><mass value=\"7\"/>")).doubtful.size(), 1u);
  EXPECT_EQ(parse_urdf_witness(with("<inertial>", "<inertal/><inertial>")).doubtful.size(), 1u);
}

}  // namespace
}  // namespace delassus::urdf_witness_test
