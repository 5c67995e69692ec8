// Laws of scene files: the same scene written in two ways, and numbers that must land where they belong.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/constraints.h"
#include "models/contacts.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/random_urdf.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::scene_laws_test {
namespace {

using V3 = Vector3<double>;
using Matrix = MatrixX<double>;
using unit::Random;

constexpr double eps = 0x1p-53;

bool small(double error, double bound) { return unit::ratio(error, bound) < 30; }

Scene scene_of(const std::string& text) {
  const auto file = test::temporary("scene_laws.yaml");
  std::ofstream(file) << text;
  return load_scene(file.string());
}

std::string list(const V3& v) {
  std::ostringstream s;
  s.precision(17);
  s << '[' << v[0] << ", " << v[1] << ", " << v[2] << ']';
  return s.str();
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(scene_of(text));
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

/// An arm on a free base whose last link is three fixed joints away from the body it belongs to, and a mimic.
test::Urdf arm(Random& r, test::Origin (&steps)[3]) {
  test::Urdf robot;
  const auto add = [&](const std::string& name, const std::string& parent, const std::string& type, const test::Origin& origin) {
    robot.links.push_back({name, test::Inertial{{r.vector(), r.vector()}, r.number(1, 2), 0.1, 0, 0, 0.1, 0, 0.1}, {}});
    if (parent.empty()) return;
    test::UrdfJoint j;
    j.name = name + "_joint", j.type = type, j.parent = parent, j.child = name, j.origin = origin, j.axis = r.unit();
    robot.joints.push_back(j);
  };
  add("base", "", "", {});
  add("upper", "base", "continuous", {r.vector(), r.vector()});
  add("lower", "upper", "continuous", {r.vector(), r.vector()});
  robot.joints.back().master = "upper_joint", robot.joints.back().multiplier = -0.5;
  const char* names[] = {"lower", "wrist", "hand", "tool"};
  for (int k = 0; k < 3; ++k) {
    steps[k] = {r.vector(), r.vector()};
    add(names[k + 1], names[k], "fixed", steps[k]);
  }
  return robot;
}

std::string robot_in(const test::Urdf& robot, const std::string& more = "") {
  const auto file = test::temporary("arm.urdf");
  std::ofstream(file) << text(robot);
  return "robots:\n  - {name: r, urdf: " + file.string() + ", pose: {xyz: [0.3, -0.2, 0.9], rpy: [0.4, -0.3, 1.1]}, joints: {upper_joint: 0.7}}\n" + more;
}

Matrix rows_of(const Scene& s) { return unit::constraint_jacobian(problem_of(s)); }

// An end on a merged link is an end on its body, further on: lever arms, axes and user blocks.
TEST(SceneLaws, an_end_on_a_merged_link_is_an_end_on_its_body) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Random r(seed);
    test::Origin steps[3];
    const test::Urdf robot = arm(r, steps);
    const V3 at = r.vector(), to = 3 * r.vector();
    const V3 rpy = r.vector();
    const Pose<Quad> tool = test::pose_of(steps[0]) * test::pose_of(steps[1]) * test::pose_of(steps[2]);
    const test::Origin there = test::origin_of(tool * test::pose_of({at, rpy}));
    for (const char* kind : {"point", "weld", "hinge", "universal", "cylindrical", "prismatic", "planar", "distance"}) {
      const bool turned = std::string(kind) != "distance";
      const auto line = [&](const char* link, const V3& x, const V3& angles) {
        return "constraints:\n  - {kind: " + std::string(kind) + ", of: r/" + link + ", at: " + list(x) + (turned ? ", rpy: " + list(angles) : "") + ", to: world, to_at: " + list(to) + "}\n";
      };
      const Matrix J = rows_of(scene_of(robot_in(robot, line("tool", at, rpy)))), K = rows_of(scene_of(robot_in(robot, line("lower", there.xyz, there.rpy))));
      ASSERT_EQ(J.rows(), K.rows());
      ASSERT_GT(J.rows(), 1) << "the mimic's row comes first";
      // Lengths: every translation on the way, and those of the two ends.
      EXPECT_TRUE(small((J - K).cwiseAbs().maxCoeff(), 40)) << kind << ' ' << seed << ' ' << (J - K).cwiseAbs().maxCoeff();
      EXPECT_GT(J.bottomRows(J.rows() - 1).norm(), 0.1);
    }
    // A block about the tool's frame and in its axes: the linear identity is the velocity of its origin, as `point` has it.
    const std::string block = "constraints:\n  - {kind: general, terms: [{of: r/tool, K: [[0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0]]}]}\n";
    const Matrix J = rows_of(scene_of(robot_in(robot, block)));
    const Matrix W = rows_of(scene_of(robot_in(robot, "constraints:\n  - {kind: weld, of: r/tool, to: world}\n")));
    EXPECT_TRUE(small((J.middleRows(1, 3) - W.bottomRows(3)).cwiseAbs().maxCoeff(), 40)) << seed;
    EXPECT_TRUE(small((J.bottomRows(3) - W.middleRows(1, 3)).cwiseAbs().maxCoeff(), 40)) << seed;
    // A contact named on the tool is one on the body.
    const V3 normal = r.unit();
    const auto contact = [&](const char* link, const V3& x) { return "contacts:\n  - {of: r/" + std::string(link) + ", at: " + list(x) + ", to: world, normal: " + list(normal) + "}\n"; };
    const Matrix C = rows_of(scene_of(robot_in(robot, contact("tool", at)))), D = rows_of(scene_of(robot_in(robot, contact("lower", there.xyz))));
    EXPECT_TRUE(small((C - D).cwiseAbs().maxCoeff(), 40)) << seed;
    EXPECT_EQ(C.rows(), 4);
  }
}

// Mass m/8 in each octant, half the edges: m (a² + b²)/12 about every axis.
TEST(SceneLaws, a_box_is_its_eight_octants) {
  const Scene whole = scene_of("boxes: [{name: a, mass: 3, size: [0.7, 1.1, 1.9]}]"), part = scene_of("boxes: [{name: a, mass: 0.375, size: [0.35, 0.55, 0.95]}]");
  const V3 quarter = V3(0.7, 1.1, 1.9) / 4;
  Matrix3<double> sum = 8 * part.model.bodies[0].inertia;
  for (Index k = 0; k < 3; ++k) sum(k, k) += 3 * (quarter.squaredNorm() - quarter[k] * quarter[k]);
  EXPECT_TRUE(small((whole.model.bodies[0].inertia - sum).cwiseAbs().maxCoeff(), sum.maxCoeff()));
  EXPECT_EQ(whole.model.bodies[0].mass, 3);
  EXPECT_EQ(whole.model.bodies[0].com, V3(0, 0, 0));
  EXPECT_EQ(whole.model.bodies[0].shapes[0].size, V3(0.7, 1.1, 1.9) / 2);
}

const std::string stack =  // turned about z, the upper one a little into the lower one
    "boxes:\n  - {name: low, mass: 2, size: [1, 1.2, 0.4], pose: {xyz: [5, -3, 0.6995], rpy: [0, 0, 0.3]}, friction: 0.6}\n"
    "  - {name: high, mass: 1, size: [0.5, 0.4, 0.3], pose: {xyz: [5.1, -2.9, 1.049], rpy: [0, 0, 1]}, friction: 0.4}\n"
    "ground: {z: 0.5, friction: 0.9}\n";

// Both frames of a contact are one frame of the world, its z the normal; a rigid motion of everything moves no contact point
// against another.
TEST(SceneLaws, the_two_frames_of_a_contact_are_one) {
  const auto file = test::temporary("ball.urdf");
  std::ofstream(file) << "<robot name=\"b\"><link name=\"l\"><inertial><origin xyz=\"0.01 0.02 0.03\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"
                         "<collision><origin xyz=\"0.1 0 0\"/><geometry><sphere radius=\"0.2\"/></geometry></collision></link></robot>";
  const std::string ball = "robots:\n  - {name: r, urdf: " + file.string() + ", pose: {xyz: [4.68, -3.2, 1.0995], rpy: [0.5, 0.2, 0]}}\n";
  const Scene s = scene_of(ball + stack + "contacts: detect\n");
  Poses<double> at;
  poses(s.model, s.q, at);
  const Problem<double> p = kinematics<double>(s.model, s.q);
  int between = 0;
  for (std::size_t k = 0; k < s.model.constraints.size(); ++k) {
    const Constraint& c = s.model.constraints[k];
    const Pose<double> a = world_pose(at, c.a.body) * c.a.placement, b = world_pose(at, c.b.body) * c.b.placement;
    EXPECT_TRUE(small((a.rotation - b.rotation).cwiseAbs().maxCoeff(), 3)) << c.name;
    EXPECT_TRUE(small((a.translation - b.translation).norm(), 30)) << c.name << ' ' << (a.translation - b.translation).norm();
    EXPECT_TRUE(small((a.rotation.transpose() * a.rotation - Matrix3<double>::Identity()).norm(), 3));
    EXPECT_GT(a.rotation.determinant(), 0);
    if (c.b.body == ground) {
      EXPECT_EQ(c.friction, 0.9) << c.name;
      EXPECT_TRUE(small(b.translation[2] - 0.5, 10)) << c.name;
    } else ++between;
    EXPECT_EQ(c.kind, Constraint::Kind::contact);
    if (c.b.body == ground) continue;
    // Motions (ω; v of the world's origin) of both sides: K_a X_a + K_b X_b = 0.
    const Structure::LinkConstraint& e = p.structure->link_constraints[k];
    for (Index row = 0; row < 3; ++row) {
      Vector6<double> sum = Vector6<double>::Zero();
      for (const auto& l : e.links) {
        const V3 reference = at.reference[static_cast<std::size_t>(at.tree[static_cast<std::size_t>(l.body)])];
        const Vector6<double> K = p.K[static_cast<std::size_t>(l.first + row)];
        sum.head<3>() += K.head<3>() + reference.cross(V3(K.tail<3>()));
        sum.tail<3>() += K.tail<3>();
      }
      EXPECT_TRUE(small(sum.cwiseAbs().maxCoeff(), 30)) << c.name << ' ' << sum.transpose();
    }
    const V3 rate = p.K[static_cast<std::size_t>(e.links[0].first)].tail<3>(), normal = a.rotation.col(2);
    EXPECT_TRUE(small((rate - normal).norm(), 3)) << "the first row is the normal";
  }
  EXPECT_GE(between, 5);
  EXPECT_GE(s.model.constraints.size(), 9u);
}

TEST(SceneLaws, the_two_frames_of_a_contact_given_by_hand_are_one) {
  const Scene s = scene_of(stack + "contacts: [{of: low, at: [0.1, 0.2, 0.2], to: high, normal: [0.3, -0.4, 0.5]}, {of: low, at: [0.1, 0.2, -0.2]}]\n");
  Poses<double> at;
  poses(s.model, s.q, at);
  for (const Constraint& c : s.model.constraints) {
    const Pose<double> a = world_pose(at, c.a.body) * c.a.placement, b = world_pose(at, c.b.body) * c.b.placement;
    EXPECT_TRUE(small((a.rotation - b.rotation).cwiseAbs().maxCoeff(), 3)) << c.name;
    EXPECT_TRUE(small((a.translation - b.translation).norm(), 30)) << c.name;
  }
}

// Whose coefficient: the smaller of two shapes, the ground's on the ground, the entry's before all.
TEST(SceneLaws, friction_is_whose_it_is) {
  const auto of = [](const std::string& text, bool on_ground) {
    std::vector<double> out;
    for (const Constraint& c : scene_of(text).model.constraints)
      if ((c.b.body == ground) == on_ground) out.push_back(c.friction);
    return out;
  };
  EXPECT_EQ(of(stack + "contacts: detect\n", true), std::vector<double>(4, 0.9));
  EXPECT_EQ(of(stack + "contacts: detect\n", false), std::vector<double>(4, 0.4));
  EXPECT_EQ(of(stack + "contacts: {detect: true, friction: 0.1}\n", false), std::vector<double>(4, 0.1));
  EXPECT_EQ(of(stack + "contacts: {detect: true, friction: 0.1}\n", true), std::vector<double>(4, 0.1));
  const std::string own = "contacts: [{of: low, at: [0, 0, -0.2]}, {of: low, friction: 0.2}, {of: low, to: high, normal: [0, 0, 1]}, {of: low, to: world}]\n";
  EXPECT_EQ(of(stack + own, true), (std::vector<double>{0.9, 0.2, 0.9}));
  EXPECT_EQ(of(stack + own, false), std::vector<double>{-1});
  std::string bare = stack;
  bare.replace(bare.find(", friction: 0.9"), 15, "");
  EXPECT_EQ(of(bare + "contacts: detect\n", true), std::vector<double>(4, 0.6));
}

TEST(SceneLaws, the_margin_and_the_height_of_the_ground_are_the_scene_s) {
  const auto points = [](double z, double margin) {
    std::ostringstream s;
    s.precision(17);
    s << "boxes: [{name: a, mass: 1, size: [1, 1, 1], pose: {xyz: [0, 0, 2.5]}}]\nground: {z: " << z << "}\ncontacts: {detect: true, margin: " << margin << "}\n";
    return scene_of(s.str()).model.constraints.size();
  };
  EXPECT_EQ(points(2 - 0.005, 0.01), 4u);
  EXPECT_EQ(points(2 - 0.02, 0.01), 0u);
  EXPECT_EQ(points(2 - 0.0005, 0.001), 4u);
  EXPECT_EQ(points(2 - 0.002, 0.001), 0u);
}

// Row by row: mimic rows come first, and damping of later constraints is not shifted by them.
TEST(SceneLaws, damping_stands_at_its_rows_behind_mimics) {
  Random r(1);
  test::Origin steps[3];
  const Scene s = scene_of(robot_in(arm(r, steps),
      "boxes: [{name: b, mass: 1, size: [1, 1, 1], pose: {xyz: [9, 0, 0.5]}}]\nground: {}\n"
      "constraints:\n  - {kind: point, of: r/tool, to: world, damping: [1, 2, 3]}\n  - {kind: joint_lock, joint: r/upper_joint, damping: 4}\n"
      "  - {kind: weld, of: b, to: r/base, loop: false}\n  - {kind: distance, of: b, to: world, to_at: [0, 0, 0], damping: [[5]]}\n"
      "contacts:\n  - {of: b, at: [0.5, 0.5, -0.5], damping: [[6, 1, 0], [1, 7, 0], [0, 0, 8]]}\n  - {of: b, at: [0.5, -0.5, -0.5]}\n"
      "damping: 0.25\n"));
  const double d = 0.25;
  EXPECT_EQ(s.damping.diagonal, (std::vector<double>{d, 1, 2, 3, 4, d, d, d, d, d, d, 0, 0, 0, 0, d, d, d}));
  ASSERT_EQ(s.damping.blocks.size(), 2u);
  EXPECT_EQ(s.damping.blocks[0].row, 11);
  EXPECT_EQ(s.damping.blocks[1].row, 12);
  EXPECT_EQ(s.damping.blocks[1].R_inverse(1, 1), 7);
  EXPECT_EQ(s.model.constraints[0].kind, Constraint::Kind::coupling);
}

TEST(SceneLaws, detected_contacts_take_their_damping) {
  const Scene s = scene_of(stack + "contacts: {detect: true, damping: [1, 2, 3]}\ndamping: 9\n");
  ASSERT_EQ(s.damping.diagonal.size(), 24u);
  for (std::size_t k = 0; k < 24; ++k) EXPECT_EQ(s.damping.diagonal[k], static_cast<double>(1 + k % 3));
}

// Numbers beyond what is expected, and one too few, are refused by name; nothing is dropped.
TEST(SceneLaws, one_number_more_or_less_is_refused) {
  const std::string box = "boxes: [{name: a, mass: 1, size: [1, 1, 1]}]\n";
  const std::pair<std::string, std::string> faults[] = {
      {"boxes: [{name: a, mass: 1, size: [1, 1, 1, 1]}]\n", "size"},
      {"boxes: [{name: a, mass: 1, size: [1, 1]}]\n", "size"},
      {"boxes: [{name: a, mass: [1, 2], size: [1, 1, 1]}]\n", "mass"},
      {"boxes: [{name: a, mass: 1, size: [1, 1, 1], pose: {xyz: [0, 0, 0, 0]}}]\n", "xyz"},
      {"boxes: [{name: a, mass: 1, size: [1, 1, 1], pose: {rpy: [0, 0]}}]\n", "rpy"},
      {"boxes: [{name: a, mass: 1 2, size: [1, 1, 1]}]\n", "mass"},
      {box + "gravity: [0, 0, -9.81, 0]\n", "gravity"},
      {box + "ground: {z: [0, 0]}\n", "z"},
      {box + "constraints: [{kind: point, of: a, at: [0, 0, 0, 0], to: world}]\n", "at"},
      {box + "constraints: [{kind: point, of: a, to: world, damping: [1, 2]}]\n", "damping"},
      {box + "constraints: [{kind: point, of: a, to: world, damping: [1, 2, 3, 4]}]\n", "damping"},
      {box + "constraints: [{kind: point, of: a, to: world, damping: [[1, 0], [0, 1]]}]\n", "damping"},
      {box + "constraints: [{kind: point, of: a, to: world}]\ndamping: [1, 1, 1, 1]\n", "damping"},
      {box + "constraints: [{kind: point, of: a, to: world}]\ndamping: [1, 1]\n", "damping"},
      {box + "constraints: [{kind: general, terms: [{of: a, K: [[1, 0, 0, 0, 0, 0, 0]]}]}]\n", "K"},
      {box + "constraints: [{kind: general, terms: [{of: a, K: [[1, 0, 0, 0, 0]]}]}]\n", "K"},
      {box + "constraints: [{kind: weld, of: a, to: world, axes: {z: [0, 0, 1, 0]}}]\n", "z"},
      {box + "contacts: [{of: a, to: world, normal: [0, 0, 1, 0]}]\n", "normal"},
      {box + "ground: {}\ncontacts: {detect: true, margin: [1, 2]}\n", "margin"}};
  for (const auto& [text, key] : faults) {
    const std::string said = refusal(text);
    EXPECT_NE(said.find(key), std::string::npos) << text << said;
    EXPECT_NE(said.find("scene_laws.yaml:"), std::string::npos) << text << said;
  }
  EXPECT_EQ(refusal(box), "");
}

}  // namespace
}  // namespace delassus::scene_laws_test
