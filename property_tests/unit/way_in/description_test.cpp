// Laws of description: a robot read from its file is the robot of the value it was written from, and stays so when it is
// written in another way. M, the motion of every link's frame, and where everything stands.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/way_in/described.h"
#include "reference/urdf_witness.h"

namespace delassus::description_test {
namespace {

using namespace described;

TEST(Description, a_file_is_read_as_it_says) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    expect(agrees(read(robot, values, Base::fixed, somewhere), compute(robot, values, "fixed", somewhere)), what + " fixed");
    expect(agrees(read(robot, values, Base::free, somewhere), compute(robot, values, "floating")), what + " free");
    expect(agrees(read(robot, values, Base::planar, somewhere), compute(robot, values, "planar", somewhere)), what + " planar");
  });
}

// M, the rows of mimics and the motion of links that end a chain, against the second reading of the text itself.
TEST(Description, the_second_reading_agrees) {
  for_each_robot([](const Urdf& robot, const Values&, unsigned seed, const std::string& what) {
    const reference::UrdfWitness witness = reference::parse_urdf_witness(text(robot));
    for (const Base base : {Base::fixed, Base::free}) {
      Read r = read(robot, {}, base);
      std::vector<Index> welded;
      for (const Index i : witness.leaves()) {
        Constraint weld;
        weld.kind = Constraint::Kind::weld;
        weld.a = r.robot.links.at(witness.links[static_cast<std::size_t>(i)].name);
        if (weld.a.body == ground) continue;
        r.model.constraints.push_back(weld);
        welded.push_back(i);
      }
      unit::Random random(seed);
      const VectorX<double> q = unit::random_configuration(r.model, random);
      const reference::UrdfMatrices theirs = reference::urdf_matrices(witness, r.model, "r", q, welded);
      const Problem<Quad> p = kinematics<double>(r.model, q).cast<Quad>();
      expect(laws::judge(Quads(unit::mass_matrix(p) - theirs.M), theirs.M_bound, eps, "M of the witness"), what);
      const Quads J = unit::constraint_jacobian(p);
      ASSERT_EQ(J.rows(), theirs.J.rows()) << what;
      expect(laws::judge(Quads(J - theirs.J), theirs.J_bound, eps, "J of the witness"), what);
    }
  });
}

/// A fixed and a free base of a robot written differently against what the first writing comes to.
void expect_same(const Urdf& variant, const Urdf& robot, const Values& values, const std::string& what) {
  expect(agrees(read(variant, values, Base::fixed, somewhere), compute(robot, values, "fixed", somewhere)), what + " fixed");
  expect(agrees(read(variant, values, Base::free, somewhere), compute(robot, values, "floating")), what + " free");
}

TEST(Description, an_inertial_turned_is_its_six_numbers_turned) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    Urdf variant = robot;
    for (test::Link& link : variant.links)
      if (link.inertial) link.inertial = moved(*link.inertial, {}, true);
    expect_same(variant, robot, values, what);
  });
}

/// A link without inertia on a fixed joint.
void attach(Urdf& robot, const std::string& name, const std::string& parent, const test::Origin& origin) {
  robot.links.push_back({name, {}, {}});
  test::UrdfJoint joint;
  joint.name = name + "_joint", joint.type = "fixed", joint.parent = parent, joint.child = name, joint.origin = origin;
  robot.joints.push_back(joint);
}

// Two more links behind one another on every link: halves of the inertia, some shapes and the joints move to them.
TEST(Description, a_link_cut_into_pieces_is_whole) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned seed, const std::string& what) {
    Urdf variant = robot;
    const test::Origin steps[] = {{{0.3, -0.2, 0.5}, {1.1, 0.4, -2}}, {{-0.7, 0.1 * seed, 0.2}, {-0.6, -1, 0.3}}};
    for (std::size_t k = 0; k < robot.links.size(); ++k) {
      const std::string name = robot.links[k].name, piece = name + "_piece", end = name + "_end";
      const Pose<Quad> first = test::pose_of(steps[0]), second = first * test::pose_of(steps[1]);
      attach(variant, piece, name, steps[0]);
      attach(variant, end, piece, steps[1]);
      for (test::UrdfJoint& j : variant.joints)
        if (j.parent == name && j.child != piece) j.parent = end, j.origin = test::origin_of(second.inverse() * test::pose_of(j.origin));
      if (!robot.links[k].inertial) continue;
      test::Inertial half = *robot.links[k].inertial;
      for (double* x : {&half.mass, &half.ixx, &half.ixy, &half.ixz, &half.iyy, &half.iyz, &half.izz}) *x /= 2;
      variant.links[k].inertial = half;
      variant.links[variant.links.size() - 2 + seed % 2].inertial = moved(half, (seed % 2 ? second : first).inverse(), seed % 3 == 0);
    }
    // The arms of the pieces count: the bound is that of the variant, its links behind the robot's.
    const auto both = [&](const char* base) {
      Computed c = compute(robot, values, base, somewhere), v = compute(variant, values, base, somewhere);
      for (auto& [name, column] : c.column) EXPECT_EQ(column, v.column.at(name));
      c.M_size = v.M_size;
      for (auto& [name, size] : c.motion_size) size = v.motion_size.at(name), c.way.at(name) = v.way.at(name);
      return c;
    };
    expect(agrees(read(variant, values, Base::fixed, somewhere), both("fixed")), what + " fixed");
    expect(agrees(read(variant, values, Base::free, somewhere), both("floating")), what + " free");
  });
}

TEST(Description, the_origin_of_a_joint_may_be_a_fixed_joint) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned seed, const std::string& what) {
    Urdf variant = robot;
    for (std::size_t k = 0; k < robot.joints.size(); ++k) {
      if ((seed + k) % 3 == 0) continue;
      const std::string mount = robot.joints[k].name + "_mount";
      attach(variant, mount, robot.joints[k].parent, robot.joints[k].origin);
      variant.joints[k].parent = mount, variant.joints[k].origin = {};
    }
    expect_same(variant, robot, values, what);
  });
}

TEST(Description, the_pose_of_a_fixed_base_is_in_its_first_joints) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    Urdf variant = robot;
    for (test::UrdfJoint& j : variant.joints)
      if (j.parent == "l0") j.origin = test::origin_of(test::pose_of(somewhere) * test::pose_of(j.origin));
    Computed c = compute(robot, values, "fixed", somewhere);
    c.link.erase("l0");
    expect(agrees(read(variant, values, Base::fixed), c), what);
  });
}

// A base is a joint below a link of the file that stands still.
TEST(Description, a_moving_base_is_a_joint_of_the_file) {
  for_each_robot([](const Urdf& robot, const Values& values, unsigned, const std::string& what) {
    for (const char* type : {"planar", "floating"}) {
      Urdf variant = robot;
      variant.links.insert(variant.links.begin(), {"anchor", {}, {}});
      test::UrdfJoint base;
      base.name = "base", base.type = type, base.parent = "anchor", base.child = "l0", base.axis = {0, 0, 1};
      if (base.type == "planar") base.origin = somewhere;
      variant.joints.push_back(base);
      expect(agrees(read(variant, values, Base::fixed), compute(robot, values, type, somewhere)), what + " " + type);
    }
  });
}

}  // namespace
}  // namespace delassus::description_test
