// Laws of description, beside M: where shapes stand, which number of a joint lands where, what mimics follow.
#include <gtest/gtest.h>

#include <sstream>

#include "algorithms/kit/test_scalars.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/described.h"

namespace delassus::description_fields_test {
namespace {

using namespace described;

TEST(Description, shapes_stand_where_their_links_are) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    const Read r = read(robot, values, Base::free);
    const Computed c = compute(robot, values, "floating");
    std::size_t left = 0;
    for (const Body& body : r.model.bodies) left += body.shapes.size();
    std::vector<std::size_t> used(r.model.bodies.size());
    const std::map<std::string, Shape::Kind> kinds{{"box", Shape::Kind::box}, {"sphere", Shape::Kind::sphere}, {"cylinder", Shape::Kind::cylinder}, {"capsule", Shape::Kind::capsule}};
    for (const test::Link& link : robot.links)
      for (const test::Collision& of : link.collisions) {
        const Index i = r.robot.links.at(link.name).body;
        const Pose<Quad> there = c.link.at(link.name) * test::pose_of(of.origin);
        const auto found = [&](const Shape& s) {
          const Vector3<double> size = of.kind == "box" ? Vector3<double>(of.size / 2) : of.kind == "sphere" ? Vector3<double>(of.size[0], 0, 0) : Vector3<double>(of.size[0], of.size[1] / 2, 0);
          if (s.kind != kinds.at(of.kind) || s.size != size || s.friction >= 0) return false;
          const Pose<double> X = world_pose(r.poses, i) * s.placement;
          Quads error(3, 4), bound = Quads::Constant(3, 4, Quad(1));
          error << X.rotation.cast<Quad>() - there.rotation, X.translation.cast<Quad>() - there.translation;
          bound.col(3).setConstant(c.way.at(link.name) + Quad(of.origin.xyz.norm()));
          return laws::judge(error, bound, eps, "the way to the shape").passed();
        };
        const auto& shapes = r.model.bodies[static_cast<std::size_t>(i)].shapes;
        EXPECT_EQ(std::count_if(shapes.begin(), shapes.end(), found), 1) << what << ' ' << link.name << ' ' << of.kind;
        --left;
      }
    EXPECT_EQ(left, 0u) << what;
  });
}

// Seven numbers of a joint, no two alike and none zero, each in its own field; their defaults.
TEST(Description, every_number_of_a_joint_lands_in_its_own_field) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    const Read r = read(robot, values, Base::fixed);
    for (const test::UrdfJoint& j : robot.joints) {
      if (j.type == "fixed") continue;
      const Joint& joint = r.model.bodies[static_cast<std::size_t>(r.robot.joints.at(j.name))].joint;
      const auto n = static_cast<std::size_t>(dof_count(joint.type));
      const auto holds = [n](const std::vector<double>& field, bool given, double value) {
        return given ? field == std::vector<double>(n, value) : field.empty() || field == std::vector<double>(n, 0);
      };
      const auto limit = j.limit.value_or(test::UrdfJoint::Limit{});
      const auto dynamics = j.dynamics.value_or(test::UrdfJoint::Dynamics{});
      EXPECT_TRUE(holds(joint.lower, j.limit.has_value(), limit.lower)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.upper, j.limit.has_value(), limit.upper)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.effort, j.limit.has_value(), limit.effort)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.velocity, j.limit.has_value(), limit.velocity)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.damping, j.dynamics.has_value(), dynamics.damping)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.friction, j.dynamics.has_value(), dynamics.friction)) << what << ' ' << j.name;
      EXPECT_TRUE(holds(joint.armature, j.dynamics.has_value(), dynamics.armature)) << what << ' ' << j.name;
    }
  });
}

/// The value a joint has when its masters have theirs, and the size of the sum it comes from.
std::pair<Quad, Quad> followed(const Urdf& robot, const Values& values, const std::string& name) {
  const auto j = std::find_if(robot.joints.begin(), robot.joints.end(), [&](const test::UrdfJoint& x) { return x.name == name; });
  if (j->master.empty()) return {Quad(values.at(name)[0]), abs(Quad(values.at(name)[0]))};
  const auto [value, size] = followed(robot, values, j->master);
  return {Quad(j->multiplier) * value + Quad(j->offset), abs(Quad(j->multiplier)) * size + abs(Quad(j->offset))};
}

TEST(Description, mimics_follow_the_product_of_their_chain) {
  int followers = 0;
  for_each_robot([&](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    std::string scene = "robots:\n  - name: r\n    base: free\n    urdf: " + file_of(robot) + "\n    joints:\n      {";
    std::ostringstream joints;
    joints.precision(17);
    for (const test::UrdfJoint& j : robot.joints)
      if (test::dofs_of(j.type) == 1 && j.master.empty()) joints << j.name << ": " << values.at(j.name)[0] << ", ";
    const auto file = test::temporary("mimic.yaml");
    std::ofstream(file) << scene << joints.str() << "}\n";
    if (joints.str().empty()) return;
    const Scene s = load_scene(file.string());
    std::size_t row = 0;
    for (const test::UrdfJoint& j : robot.joints) {
      if (test::dofs_of(j.type) != 1) continue;
      const Index i = s.model.find("r/" + j.child);
      const auto [value, size] = followed(robot, values, j.name);
      const Quad error = Quad(s.q[s.model.first_q[static_cast<std::size_t>(i)]]) - value;
      expect(laws::judge(Quads::Constant(1, 1, error), Quads::Constant(1, 1, size), eps, "terms of the chain"), what + " " + j.name);
      if (j.master.empty()) continue;
      ++followers;
      const auto master = std::find_if(robot.joints.begin(), robot.joints.end(), [&](const test::UrdfJoint& x) { return x.name == j.master; });
      ASSERT_LT(row, s.model.constraints.size());
      const Constraint& c = s.model.constraints[row++];
      ASSERT_EQ(c.kind, Constraint::Kind::coupling);
      ASSERT_EQ(c.terms.size(), 2u);
      EXPECT_EQ(c.terms[0].body, i);
      EXPECT_EQ(c.terms[0].coefficient, 1);
      EXPECT_EQ(c.terms[1].body, s.model.find("r/" + master->child));
      EXPECT_EQ(c.terms[1].coefficient, -j.multiplier);
    }
  });
  EXPECT_GT(followers, 20);
}

}  // namespace
}  // namespace delassus::description_fields_test
