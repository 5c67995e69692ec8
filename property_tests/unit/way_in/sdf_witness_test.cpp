// The second reading of SDF files: a text with every joint type, loops, frames and a nested model; differences that it
// must see; what it does not serve.
#include "algorithms/kit/test_scalars.h"
#include "reference/sdf_witness.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "algorithms/mechanism/kinematics.h"
#include "models/robot.h"
#include "property_tests/campaigns/fuzz_judge.h"
#include "property_tests/second_reading/second_reading.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/temporary.h"
#include "reference/definition.h"

namespace delassus::sdf_witness_test {
namespace {

using reference::parse_sdf_witness;
using reference::WitnessMatrices;
using Change = std::function<void(Model&)>;

std::string full_text() { return fuzz_texts().back().text; }

/// Largest ratio of M, J and J M⁻¹ Jᵀ; infinite where the reading finds no counterpart; -1: built without libsdformat.
double compare(const Change& change) {
  RobotOptions o;
  o.file = test::temporary("witness.sdf").string(), o.robot = "r";
  std::ofstream(o.file) << full_text();
  Model model;
  Robot robot;
  try {
    robot = add_robot(model, o);
  } catch (const ModelError& e) {
    if (std::string(e.what()).find("built without") == std::string::npos) throw;
    return -1;
  }
  try {
    const std::unique_ptr<SecondReading> second = second_reading(o);
    second->add_welds(model, robot);
    unit::Random random(7);
    VectorX<double> q = unit::random_configuration(model, random);
    change(model);
    const WitnessMatrices theirs = second->matrices(model, robot, q);
    const Problem<Quad> problem = kinematics<double>(model, q).cast<Quad>();
    const auto ours = reference::dense(problem, Damping<Quad>::uniform(problem.structure->rows, Quad(0)));
    return std::max({worst_ratio(ours.M, theirs.M, theirs.M_bound), worst_ratio(ours.J, theirs.J, theirs.J_bound), worst_ratio(ours.A0, theirs.A0, theirs.A_bound)});
  } catch (const std::runtime_error&) {
    return std::numeric_limits<double>::infinity();
  }
}

TEST(SdfWitness, agrees_on_every_joint_type_with_loops_frames_and_a_nested_model) {
  const double ratio = compare([](Model&) {});
  if (ratio < 0) GTEST_SKIP() << "built without libsdformat";
  EXPECT_LT(ratio, 30);
  const auto w = parse_sdf_witness(full_text());
  EXPECT_EQ(w.moving(), 6);
  EXPECT_EQ(w.joints.size() - 3, 6u);  // a gearbox and two loops
  EXPECT_TRUE(w.doubtful.empty());
}

TEST(SdfWitness, sees_what_is_different) {
  const auto body = [](Model& m, const char* name) -> Body& { return m.bodies[static_cast<std::size_t>(m.find(std::string("r/") + name))]; };
  const auto constraint = [](Model& m, const char* name) -> Constraint& {
    return *std::find_if(m.constraints.begin(), m.constraints.end(), [&](const Constraint& c) { return c.name == std::string("r/") + name; });
  };
  const std::vector<std::pair<const char*, Change>> changes{
      {"a mass 1e-9 off", [&](Model& m) { body(m, "a").mass *= 1 + 1e-9; }},
      {"a centre of mass 1 nm off", [&](Model& m) { body(m, "c").com[1] += 1e-9; }},
      {"a product of inertia of the other sign", [&](Model& m) { body(m, "base").inertia(0, 1) *= -1, body(m, "base").inertia(1, 0) *= -1; }},
      {"an axis reversed", [&](Model& m) { body(m, "a").joint.axis *= -1; }},
      {"the second axis of a universal joint reversed", [&](Model& m) { body(m, "c").joint.axis2 *= -1; }},
      {"a joint 1 nm off", [&](Model& m) { body(m, "b").joint.placement.translation[2] += 1e-9; }},
      {"the frame of a ball joint turned", [&](Model& m) { body(m, "n::a").joint.placement.rotation *= Eigen::AngleAxisd(1e-9, Vector3<double>::UnitX()).toRotationMatrix(); }},
      {"a pin 1 nm off", [&](Model& m) { constraint(m, "pin").b.placement.translation[0] += 1e-9; }},
      {"the ends of a pin exchanged", [&](Model& m) { std::swap(constraint(m, "pin").a, constraint(m, "pin").b); }},
      {"the axis of a hinge turned", [&](Model& m) { constraint(m, "hinge").a.placement.rotation *= Eigen::AngleAxisd(1e-9, Vector3<double>::UnitX()).toRotationMatrix(); }},
      {"a hinge taken for a weld", [&](Model& m) { constraint(m, "hinge").kind = Constraint::Kind::weld; }},
      {"a loop forgotten", [&](Model& m) { std::erase_if(m.constraints, [](const Constraint& c) { return c.name == "r/hinge"; }); }},
      {"a gear of the other sense", [&](Model& m) { constraint(m, "gear gearbox").terms[1].coefficient *= -1; }}};
  for (const auto& [name, change] : changes) {
    const double ratio = compare(change);
    if (ratio < 0) GTEST_SKIP() << "built without libsdformat";
    EXPECT_GE(ratio, 30) << name;
  }
}

TEST(SdfWitness, says_what_is_wrong_and_what_it_does_not_serve) {
  const auto says = [](const std::string& inside, bool served) {
    const std::string text = "<sdf version='1.9'>" + inside + "</sdf>";
    if (served) {
      EXPECT_THROW(static_cast<void>(parse_sdf_witness(text)), std::runtime_error) << text;
    } else {
      EXPECT_THROW(static_cast<void>(parse_sdf_witness(text)), reference::NotServed) << text;
    }
  };
  says("<world name='w'><include><uri>model://m</uri></include></world>", false);
  says("<world name='w'><joint name='j' type='fixed'/></world>", false);
  says("<model name='m'/>", true);
  says("<model name='m'><link name='a'><inertial><mass>1 2</mass></inertial></link></model>", true);
  says("<model name='m'><link name='a'><pose>1 2 3</pose></link></model>", true);
  says("<model name='m'><link name='a'><pose relative_to='a'>1 2 3 0 0 0</pose></link></model>", true);
  says("<model name='m'><link name='a'/><joint name='j' type='revolute'><parent>a</parent><child>b</child></joint></model>", true);
  EXPECT_EQ(parse_sdf_witness("<sdf version='1.9'><model name='m'><link name='a'><inertial><mass>1</mass><mass>2</mass></inertial></link></model></sdf>").doubtful.size(), 1u);
}

}  // namespace
}  // namespace delassus::sdf_witness_test
