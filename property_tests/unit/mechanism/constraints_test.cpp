// Constraint rows against the rate of the closure error, by central differences in Quad, and against each other.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/loop_closing.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::constraints_test {
namespace {

using namespace unit;
using Kind = Constraint::Kind;

constexpr Kind closed_kinds[] = {Kind::point,       Kind::weld,      Kind::hinge,  Kind::universal, Kind::cylindrical,
                                 Kind::prismatic,   Kind::planar,    Kind::distance, Kind::contact};

Matrix3<double> turn(const Vector3<double>& axis, double angle) {
  const Matrix3<double> a = cross_matrix(axis);
  return Matrix3<double>::Identity() + std::sin(angle) * a + (1 - std::cos(angle)) * (a * a);
}

/// A pose of b in a that a closed constraint of this kind allows.
Pose<double> allowed_motion(Kind kind, Random& random) {
  const Vector3<double> x(1, 0, 0), z(0, 0, 1);
  const double angle = 3 * random.number(), slide = random.number();
  switch (kind) {
    case Kind::point:
    case Kind::contact: return {random.rotation(), {0, 0, 0}};
    case Kind::hinge: return {turn(z, angle), {0, 0, 0}};
    case Kind::universal: return {turn(z, angle) * turn(x, 3 * random.number()), {0, 0, 0}};
    case Kind::cylindrical: return {turn(z, angle), {0, 0, slide}};
    case Kind::prismatic: return {Matrix3<double>::Identity(), {0, 0, slide}};
    case Kind::planar: return {turn(z, angle), {random.number(), random.number(), 0}};
    case Kind::distance: return random.pose();
    default: return {};
  }
}

/// World pose of a frame in Quad, the distance of its origin from the world's origin included.
Pose<Quad> world_pose(const Poses<Quad>& at, const Frame& f) {
  const Pose<Quad> own{f.placement.rotation.cast<Quad>(), f.placement.translation.cast<Quad>()};
  if (f.body == ground) return own;
  return Pose<Quad>{at.rotation[f.body], at.position[f.body] + at.reference[at.tree[f.body]]} * own;
}

/// A constraint of this kind between two bodies, closed at the poses up to the rounding of its placements.
Constraint closed(Kind kind, Index a, Index b, const Poses<Quad>& at, Random& random) {
  Constraint c;
  c.kind = kind;
  c.a = {a, random.pose()};
  const Pose<double> step = allowed_motion(kind, random);
  c.length = step.translation.norm();
  const Pose<Quad> target = world_pose(at, c.a) * Pose<Quad>{step.rotation.cast<Quad>(), step.translation.cast<Quad>()};
  const Pose<Quad> in_b = world_pose(at, {b, {}}).inverse() * target;
  c.b = {b, {in_b.rotation.cast<double>(), in_b.translation.cast<double>()}};
  return c;
}

/// (φ(q ⊕ hν) − φ(q ⊕ −hν)) / 2h. At h = 2⁻³⁴ both errors, h² and ε_Quad / h, are below 2⁻⁶⁵ of the motion.
VectorX<Quad> closure_rate(const Model& m, const Constraint& c, const VectorX<Quad>& q, const VectorX<Quad>& v) {
  const Quad h(0x1p-34);
  VectorX<Quad> e[2];
  for (int side = 0; side < 2; ++side) {
    Poses<Quad> at;
    poses<Quad>(m, integrate<Quad>(m, q, VectorX<Quad>(v * (side ? h : -h))), at);
    e[side] = closure_error(m, c, at);
  }
  return (e[1] - e[0]) / (Quad(2) * h);
}

double largest(const MatrixX<Quad>& x) { return x.cast<double>().cwiseAbs().maxCoeff(); }

/// A seeded defect of the problem that kinematics makes; nullptr: none.
using Defect = void (*)(Problem<Quad>&);

/// How far J ν is from the rate of the closure error.
double rate_ratio(Model m, Kind kind, Index a, Index b, const VectorX<Quad>& q, Random& random, Defect defect = nullptr) {
  Poses<Quad> at;
  poses(m, q, at);
  const Constraint c = closed(kind, a, b, at, random);
  m.constraints = {c};
  Problem<Quad> p = kinematics<Quad>(m, q);
  if (defect) defect(p);
  const MatrixX<Quad> J = constraint_jacobian(p);
  VectorX<Quad> v(m.dofs());
  for (Index k = 0; k < v.size(); ++k) v[k] = Quad(random.number());
  const VectorX<Quad> rate = closure_rate(m, c, q, v);
  VectorX<Quad> predicted = J * v;
  if (kind == Kind::contact) predicted.tail<2>().setZero();  // tangents have no position level
  const double bound = (J.cast<double>().cwiseAbs() * v.cast<double>().cwiseAbs()).maxCoeff();
  double lengths = 1;
  for (const Frame& f : {c.a, c.b}) lengths += largest(world_pose(at, f).translation) + f.placement.translation.norm();
  EXPECT_LT(ratio(largest(closure_error(m, c, at)), lengths), 30) << name(kind) << " is closed";
  // The placements in double leave a closure error of their own rounding; it changes the rate by as much.
  return ratio(largest(rate - predicted), bound);
}

TEST(closure, rate_is_the_rows_times_the_velocity) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    Random random(seed);
    const Model m = two_robots(seed);
    const VectorX<Quad> q = random_configuration(m, random).cast<Quad>();
    for (const Kind kind : closed_kinds) {
      for (Index i = 0; i < 16; ++i) {  // every joint type moves one end at least
        EXPECT_LT(rate_ratio(m, kind, i, ground, q, random), 30) << name(kind) << " between " << i << " and the ground";
        EXPECT_LT(rate_ratio(m, kind, ground, i, q, random), 30) << name(kind) << " between the ground and " << i;
        EXPECT_LT(rate_ratio(m, kind, i, (i + 3) % 16, q, random), 30) << name(kind) << " between " << i << " and " << (i + 3) % 16;
      }
    }
  }
}

TEST(closure, seeded_defects_of_the_rows_are_noticed) {
  Random random(0);
  const Model m = two_robots(0);
  const VectorX<Quad> q = random_configuration(m, random).cast<Quad>();
  const Defect other_side = [](Problem<Quad>& p) { p.K.back() = -p.K.back(); };
  const Defect lever = [](Problem<Quad>& p) { p.K.front()[0] += Quad(0x1p-30); };  // 1 nm
  const Defect joint_axis = [](Problem<Quad>& p) { p.S.back() = -p.S.back(); };
  EXPECT_LT(rate_ratio(m, Kind::weld, 4, 15, q, random), 30);
  for (const Defect defect : {other_side, lever, joint_axis}) EXPECT_GT(rate_ratio(m, Kind::weld, 4, 15, q, random, defect), 30);
}

TEST(closure, error_is_that_of_the_displacement) {
  Random random(1);
  Model m;
  m.add(random_body(random, "b", ground, JointType::floating));
  m.bodies[0].joint.placement = {};
  Constraint c;
  c.kind = Kind::weld;
  c.a.body = 0;
  for (const double angle : {0.0, 1e-9, 0.5, 2.0, 3.1, 3.141592653589793}) {
    const Vector3<double> axis = random.unit();
    VectorX<double> q(7);
    q << 0.25, -0.5, 1, std::cos(angle / 2), std::sin(angle / 2) * axis;
    Poses<double> at;
    poses(m, q, at);
    const VectorX<double> e = closure_error(m, c, at);
    const Vector3<double> expected = 2 * std::sin(angle / 2) * axis;
    EXPECT_LT(ratio<double>(MatrixX<double>(e.head<3>()), MatrixX<double>(expected)) * (angle < 1 ? std::sin(angle) : 1), 30) << angle;
    EXPECT_LT(ratio<double>(MatrixX<double>(at.rotation[0] * e.tail<3>()), MatrixX<double>(q.head<3>())), 30);
  }
  c.kind = Kind::hinge;  // z axes apart by 2, then by π
  for (const double angle : {2.0, 3.141592653589793}) {
    VectorX<double> q(7);
    q << 0, 0, 0, std::cos(angle / 2), std::sin(angle / 2), 0, 0;
    Poses<double> at;
    poses(m, q, at);
    EXPECT_LT(ratio(closure_error(m, c, at).head<2>().norm() - 2 * std::sin(angle / 2), 2), 30);
  }
}

TEST(rows, same_tree_sides_are_opposite_at_closure) {
  Random random(2);
  Model m = two_robots(2);
  const VectorX<Quad> q = random_configuration(m, random).cast<Quad>();
  Poses<Quad> at;
  poses(m, q, at);
  for (const Kind kind : closed_kinds) {
    m.constraints = {closed(kind, 4, 6, at, random)};
    const Problem<double> p = kinematics<double>(m, q.cast<double>());
    const auto& c = p.structure->link_constraints[0];
    for (Index k = 0; k < c.rows; ++k) {
      const Vector6<double> sum = p.K[c.links[0].first + k] + p.K[c.links[1].first + k];
      EXPECT_LT(ratio(sum.norm(), 1 + at.position[4].cast<double>().norm() + at.position[6].cast<double>().norm()), 30) << name(kind);
    }
  }
}

TEST(rows, coupling_is_the_sum_of_its_velocities) {
  Random random(3);
  Model m = two_robots(3);
  // a joint with its parent's joint (bodies 3, 4), one twice (4), a root's, and one of the other tree
  Constraint c;
  c.kind = Kind::coupling;
  c.terms = {{4, 1, 2.0, {}}, {3, 0, -3.0, {}}, {4, 2, 0.5, {}}, {0, 3, 1.25, {}}, {13, 0, 4, {}}};
  m.constraints = {c};
  const Problem<Quad> p = kinematics<Quad>(m, random_configuration(m, random).cast<Quad>());
  EXPECT_EQ(p.structure->link_constraints[0].links.size(), 6u) << "bodies 4, 3, 2, 0, 13, 12";
  MatrixX<Quad> expected = MatrixX<Quad>::Constant(1, m.dofs(), Quad(0));
  for (const auto& t : c.terms) expected(0, m.first_dof[t.body] + t.dof) += Quad(t.coefficient);
  double lever = 1;
  for (const auto& K : p.K) lever += K.cast<double>().cwiseAbs().sum() * 8;
  const MatrixX<Quad> error = constraint_jacobian(p) - expected;
  EXPECT_LT(ratio(largest(error), lever, unit_roundoff<Quad>), 30);
}

TEST(rows, general_identity_is_the_weld_of_the_body_frame) {
  Random random(4);
  Model m = two_robots(4);
  Constraint weld, general;
  weld.kind = Kind::weld;
  weld.a.body = 6;
  general.kind = Kind::general;
  general.terms = {{6, 0, 1, MatrixX<double>::Identity(6, 6) * 3}, {6, 0, 1, MatrixX<double>::Identity(6, 6) * -2}};
  m.constraints = {weld, general};
  const MatrixX<double> J = constraint_jacobian(kinematics<double>(m, random_configuration(m, random)));
  EXPECT_LT(ratio<double>(MatrixX<double>(J.bottomRows(6)), MatrixX<double>(J.topRows(6))), 30);
}

TEST(rows, joint_kinds_are_the_identity_on_their_joint) {
  Random random(5);
  Model m = two_robots(5);
  Constraint friction, lock;
  friction.kind = Kind::joint_friction;
  friction.a.body = 4;
  lock.kind = Kind::joint_lock;
  lock.a.body = 0;
  m.constraints = {friction, lock};
  const MatrixX<double> J = constraint_jacobian(kinematics<double>(m, random_configuration(m, random)));
  MatrixX<double> expected = MatrixX<double>::Zero(9, m.dofs());
  expected.block(0, m.first_dof[4], 3, 3).setIdentity();
  expected.block(3, 0, 6, 6).setIdentity();
  EXPECT_EQ(J, expected);
}

TEST(rows, contact_is_normal_first) {
  Model m;
  Random random(6);
  m.add(random_body(random, "b", ground, JointType::floating));
  Constraint c;
  c.kind = Kind::contact;
  c.b.body = 0;  // a is the world: rows in world axes, minus the body's velocity
  m.constraints = {c};
  const Problem<double> p = kinematics<double>(m, neutral(m));
  EXPECT_EQ(p.K[0].tail<3>(), Vector3<double>(0, 0, -1));
  EXPECT_EQ(p.K[1].tail<3>(), Vector3<double>(-1, 0, 0));
  EXPECT_EQ(p.K[2].tail<3>(), Vector3<double>(0, -1, 0));
}

}  // namespace
}  // namespace delassus::constraints_test
