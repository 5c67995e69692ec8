// Laws of description: a robot read from its file is the robot of the value it was written from (random_urdf.h), and
// stays so when it is written in another way. M, the motion of every link's frame, and where everything stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>

#include "algorithms/kinematics.h"
#include "models/contacts.h"
#include "models/scene.h"
#include "models/urdf.h"
#include "property_tests/random_urdf.h"
#include "property_tests/unit/path_sums.h"
#include "property_tests/unit/temporary.h"
#include "property_tests/verdict.h"
#include "reference/urdf_witness.h"

namespace delassus {
namespace {

using laws::Verdict;
using test::Computed;
using test::Urdf;
using test::Values;
using Quads = MatrixX<Quad>;
using Base = RobotOptions::Base;

constexpr double eps = 0x1p-53;
constexpr unsigned robots = 30;

struct Read {
  Model model;
  Robot robot;
  VectorX<double> q;
  Poses<double> poses;
};

std::string file_of(const Urdf& robot) {
  const auto file = test::temporary("random.urdf");
  std::ofstream(file) << text(robot);
  return file.string();
}

Pose<double> in_double(const test::Origin& origin) {
  const Pose<Quad> p = test::pose_of(origin);
  const auto narrow = [](const Quad& x) { return static_cast<double>(x); };
  return {p.rotation.unaryExpr(narrow), p.translation.unaryExpr(narrow)};
}

Read read(const Urdf& robot, const Values& values, Base base, const test::Origin& pose = {}) {
  Read r;
  RobotOptions o;
  o.file = file_of(robot);
  o.robot = "r";
  o.base = base;
  o.pose = in_double(pose);
  r.robot = add_urdf(r.model, o);
  r.q = neutral(r.model);
  for (const auto& [name, value] : values) {
    const auto joint = r.robot.joints.find(name);
    const bool moves = name == "base" ? !r.robot.root_joint.empty() : joint != r.robot.joints.end();
    if (!moves && joint == r.robot.joints.end()) continue;
    const auto i = static_cast<std::size_t>(joint != r.robot.joints.end() ? joint->second : 0);
    for (Index k = 0; k < q_size(r.model.bodies[i].joint.type); ++k) r.q[r.model.first_q[i] + k] = value[static_cast<std::size_t>(k)];
  }
  poses(r.model, r.q, r.poses);
  return r;
}

/// Columns of the computation in the order of the model.
std::vector<Index> order_of(const Model& model, const Computed& c) {
  std::vector<Index> order;
  for (const Body& body : model.bodies)
    for (Index k = 0; k < dof_count(body.joint.type); ++k) order.push_back(c.column.at(body.joint.name.substr(2)) + k);
  return order;
}

Verdict compare(const Quads& read, const Quads& computed, const Quads& size, const std::vector<Index>& rows, const std::vector<Index>& columns, const char* name) {
  if (read.rows() != static_cast<Index>(rows.size()) || read.cols() != static_cast<Index>(columns.size())) return laws::failure("shapes differ", name);
  Quads error(read), bound(read);
  for (Index j = 0; j < read.cols(); ++j)
    for (Index i = 0; i < read.rows(); ++i) {
      const Index k = rows[static_cast<std::size_t>(i)], l = columns[static_cast<std::size_t>(j)];
      error(i, j) = read(i, j) - computed(k, l), bound(i, j) = size(k, l);
    }
  return laws::judge(error, bound, eps, name);
}

/// M, and for every link of the computation its place and its motion.
Verdict agrees(const Read& r, const Computed& c) {
  Model model = r.model;
  model.constraints.clear();
  std::vector<std::string> links;
  Verdict worst;
  for (const auto& [name, pose] : c.link) {
    const Frame& frame = r.robot.links.at(name);
    const Pose<double> X = world_pose(r.poses, frame.body) * frame.placement;
    worst = laws::worst(worst, laws::judge(Quads(X.rotation.cast<Quad>() - pose.rotation), Quads::Constant(3, 3, Quad(1)), eps, "rotations: 1"));
    worst = laws::worst(worst, laws::judge(Quads(X.translation.cast<Quad>() - pose.translation), Quads::Constant(3, 1, c.way.at(name)), eps, "places: joints × the way to them"));
    if (frame.body == ground) continue;
    Constraint weld;
    weld.kind = Constraint::Kind::weld;
    weld.a = frame;
    model.constraints.push_back(weld);
    links.push_back(name);
  }
  const Problem<double> p = kinematics<double>(model, r.q);
  const std::vector<Index> order = order_of(r.model, c);
  worst = laws::worst(worst, compare(unit::mass_matrix(p.cast<Quad>()), c.M, c.M_size, order, order, "M: joints × sums of sizes"));
  const Quads J = unit::constraint_jacobian(p.cast<Quad>());
  for (std::size_t k = 0; k < links.size(); ++k)
    worst = laws::worst(worst, compare(J.middleRows(6 * static_cast<Index>(k), 6), c.motion.at(links[k]), c.motion_size.at(links[k]), {0, 1, 2, 3, 4, 5}, order, "motion: joints × length of the way"));
  return worst;
}

void expect(const Verdict& v, const std::string& what) { EXPECT_TRUE(v.passed()) << what << ": " << v.ratio << " eps · " << v.bound << ' ' << v.note; }

const test::Origin somewhere{{0.4, -1.1, 0.7}, {0.5, -0.8, 2.1}};

void for_each_robot(const std::function<void(const Urdf&, const Values&, unsigned, const std::string&)>& law) {
  for (unsigned seed = 1; seed <= robots; ++seed) {
    const Urdf robot = test::random_urdf(seed);
    law(robot, test::random_values(robot, seed), seed, "random_urdf(" + std::to_string(seed) + ")");
    if (testing::Test::HasFailure()) return;
  }
}

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
}  // namespace delassus
