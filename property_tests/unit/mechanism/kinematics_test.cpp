// Kinematics against closed forms by hand, against itself in Quad, and far from the origin.
#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/mechanism.h"

#include <gtest/gtest.h>

#include "property_tests/unit/operators/path_sums.h"

namespace delassus::kinematics_test {
namespace {

using namespace unit;
using Kind = Constraint::Kind;

/// A link that turns about y, hangs along −z, with its centre of mass at distance c.
Body pendulum_link(const std::string& name, Index parent, double mass, double c, double I, double hung_at) {
  Body b;
  b.name = name;
  b.parent = parent;
  b.joint.axis = {0, 1, 0};
  b.joint.placement.translation = {0, 0, -hung_at};
  b.mass = mass;
  b.com = {0, 0, -c};
  b.inertia = Vector3<double>(I, I, I).asDiagonal();
  return b;
}

/// The tip of `body` at distance l held at a point of the world, rows in world axes.
Constraint held_tip(Index body, double l) {
  Constraint c;
  c.b.body = body;
  c.b.placement.translation = {0, 0, -l};
  return c;
}

TEST(kinematics, pendulum_by_hand) {
  Model m;
  m.add(pendulum_link("p/1", ground, 2, 0.75, 0.5, 3));
  m.constraints.push_back(held_tip(0, 1.25));
  m.bodies[0].joint.armature = {0.25};
  const double t = 0.7;
  const Problem<double> p = kinematics<double>(m, VectorX<double>::Constant(1, t));
  EXPECT_LT(ratio(mass_matrix(p)(0, 0) - (0.25 + 0.5 + 2 * 0.75 * 0.75), 2), 30);
  // tip (−l sin t, 0, −l cos t); world minus body: minus its rate
  const MatrixX<double> J = constraint_jacobian(p);
  EXPECT_LT(ratio(J(0, 0) - 1.25 * std::cos(t), 1.25), 30);
  EXPECT_EQ(J(1, 0), 0);
  EXPECT_LT(ratio(J(2, 0) + 1.25 * std::sin(t), 1.25), 30);
}

TEST(kinematics, double_pendulum_by_hand) {
  const double m1 = 2, m2 = 3, c1 = 0.5, c2 = 0.75, l1 = 1.5, l2 = 1.25, I1 = 0.5, I2 = 0.25;
  Model m;
  m.add(pendulum_link("p/1", ground, m1, c1, I1, 0));
  m.add(pendulum_link("p/2", 0, m2, c2, I2, l1));
  m.constraints.push_back(held_tip(1, l2));
  const double t1 = 0.4, t2 = -1.1;
  const Problem<double> p = kinematics<double>(m, VectorX<double>{{t1, t2}});
  MatrixX<double> M(2, 2), J(3, 2);
  const double m12 = I2 + m2 * (c2 * c2 + l1 * c2 * std::cos(t2)), m22 = I2 + m2 * c2 * c2;
  const double m11 = I1 + I2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * std::cos(t2));
  M << m11, m12, m12, m22;
  const double x2 = l2 * std::cos(t1 + t2), z2 = l2 * std::sin(t1 + t2);
  J << l1 * std::cos(t1) + x2, x2, 0, 0, -l1 * std::sin(t1) - z2, -z2;
  EXPECT_LT(ratio<double>(mass_matrix(p), M), 30);
  EXPECT_LT(ratio<double>(constraint_jacobian(p), J), 30);
}

TEST(kinematics, free_body_has_the_constant_matrix_of_its_body_axes) {
  Random random(1);
  Model m;
  m.add(random_body(random, "b", ground, JointType::floating));
  const Body& b = m.bodies[0];
  const MatrixX<double> expected = spatial_inertia<double>(b.mass, b.com, b.inertia);
  for (int k = 0; k < 5; ++k) {
    VectorX<double> q = random_configuration(m, random);
    q.tail<4>() *= 3;  // quaternions of any length stand for their direction
    const Problem<double> p = kinematics<double>(m, q);
    EXPECT_LT(ratio<double>(mass_matrix(p), expected), 30);
    EXPECT_TRUE(p.H[0].topRightCorner(3, 3).isZero(0)) << "about its own centre of mass";
  }
}

TEST(kinematics, every_degree_of_freedom_has_its_own_armature_and_limit) {
  Random random(2);
  Model m;
  m.add(random_body(random, "a", ground, JointType::revolute));
  m.add(random_body(random, "b", 0, JointType::planar));
  m.add(random_body(random, "c", 1, JointType::universal));
  m.bodies[0].joint.armature = {};
  m.bodies[1].joint.armature = {1, 2, 3};
  m.bodies[2].joint.armature = {4, 5};
  for (const auto& [body, dof, side] : {std::tuple<Index, Index, int>{1, 2, 1}, {1, 0, -1}, {2, 1, -1}, {0, 0, 1}}) {
    Constraint c;
    c.kind = Kind::joint_limit;
    c.a.body = body, c.dof = dof, c.side = side;
    m.constraints.push_back(c);
  }
  const Problem<double> p = kinematics<double>(m, random_configuration(m, random));
  EXPECT_EQ(p.armature, (std::vector<double>{0, 1, 2, 3, 4, 5}));
  MatrixX<double> J = MatrixX<double>::Zero(4, 6);
  J(0, 3) = 1, J(1, 1) = -1, J(2, 5) = -1, J(3, 0) = 1;
  EXPECT_EQ(constraint_jacobian(p), J);
}

/// Every kind whose rows no world position enters, on two_robots: within one tree, between trees, to the world.
void add_constraints(Model& m, Random& random, bool far) {
  for (const Kind k : {Kind::point, Kind::weld, Kind::hinge, Kind::universal, Kind::cylindrical, Kind::prismatic,
                       Kind::planar, Kind::distance, Kind::contact}) {
    const bool offset_enters = k == Kind::cylindrical || k == Kind::prismatic || k == Kind::planar || k == Kind::distance;
    Constraint c;
    c.kind = k;
    c.length = 1;
    c.a = {3, random.pose()};
    c.b = {7, random.pose()};
    m.constraints.push_back(c);
    if (offset_enters && far) continue;
    c.b = {12, random.pose()};
    m.constraints.push_back(c);
    c.b = {ground, random.pose()};
    m.constraints.push_back(c);
    std::swap(c.a, c.b);
    m.constraints.push_back(c);
  }
  Constraint c;
  c.kind = Kind::coupling;
  c.terms = {{4, 1, 2.0, {}}, {5, 0, -3.0, {}}, {3, 0, 0.5, {}}, {0, 4, 1.5, {}}};
  m.constraints.push_back(c);
  c = {};
  c.kind = Kind::joint_lock;
  c.a.body = 4;
  m.constraints.push_back(c);
  c = {};
  c.kind = Kind::general;
  for (const Index body : {2, 9, 2, -1}) c.terms.push_back({body, 0, 1, MatrixX<double>::NullaryExpr(2, 6, [&](Index, Index) { return random.number(); })});
  m.constraints.push_back(c);
}

TEST(kinematics, far_from_the_origin_no_bit_changes) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    Random random(seed);
    Model m = two_robots(seed);
    add_constraints(m, random, true);
    VectorX<double> q = random_configuration(m, random);
    const Problem<double> near = kinematics<double>(m, q);
    q.head<3>() += Vector3<double>(1e6, -3e6, 2e6);                    // the floating robot
    m.bodies[8].joint.placement.translation += Vector3<double>(4e6, 1e6, 1e6);  // the fixed one
    const Problem<double> far = kinematics<double>(m, q);
    EXPECT_EQ(near.S, far.S);
    EXPECT_EQ(near.H, far.H);
    EXPECT_EQ(near.K, far.K);
    EXPECT_EQ(near.joint_K, far.joint_K);
  }
}

template <class T, int R, int C>
double worst_ratio(const std::vector<Eigen::Matrix<T, R, C>>& x, const std::vector<Eigen::Matrix<Quad, R, C>>& y) {
  double error = 0, bound = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (Index k = 0; k < x[i].size(); ++k) {
      error = std::max(error, std::fabs(static_cast<double>(scalar_cast<Quad>(T(x[i](k))) - y[i](k))));
      bound = std::max(bound, std::fabs(static_cast<double>(y[i](k))));
    }
  return ratio(error, bound, unit_roundoff<T>);
}

template <class T> void expect_rounding_only(unsigned seed) {
  Random random(seed);
  Model m = two_robots(seed);
  add_constraints(m, random, false);
  const VectorX<T> q = random_configuration(m, random).cast<T>();
  const Problem<T> p = kinematics<T>(m, q);
  VectorX<Quad> wide(q.size());
  for (Index k = 0; k < q.size(); ++k) wide[k] = scalar_cast<Quad>(q[k]);
  const Problem<Quad> exact = kinematics<Quad>(m, wide);
  EXPECT_LT(worst_ratio(p.S, exact.S), 30);
  EXPECT_LT(worst_ratio(p.H, exact.H), 30);
  EXPECT_LT(worst_ratio(p.K, exact.K), 30);
  for (const auto& H : p.H) EXPECT_EQ(H, H.transpose()) << "symmetric to the bit";
}

TEST(kinematics, differs_from_quad_by_rounding) {
  for (unsigned seed = 10; seed < 15; ++seed) {
    expect_rounding_only<double>(seed);
    expect_rounding_only<float>(seed);
  }
}

TEST(kinematics, counted_computes_what_double_computes) {
  const Model m = two_robots(3);
  Random random(3);
  const VectorX<double> q = random_configuration(m, random);
  operation_count = {};
  const Problem<Counted> p = kinematics<Counted>(m, q.cast<Counted>());
  EXPECT_GT(operation_count.total(), 0);
  EXPECT_LT(worst_ratio(p.S, kinematics<Quad>(m, q.cast<Quad>()).S), 30);
}

TEST(kinematics, storage_is_kept_and_checked) {
  Model m = two_robots(4);
  Random random(4);
  add_constraints(m, random, false);
  const VectorX<double> q = random_configuration(m, random);
  Problem<double> p(structure_of(m));
  Poses<double> at;
  kinematics(m, q, at, p);
  const void* storage[] = {p.S.data(), p.H.data(), p.K.data(), p.joint_K.data(), at.rotation.data(), at.reference.data()};
  const Problem<double> first = p;
  kinematics(m, q, at, p);
  const void* after[] = {p.S.data(), p.H.data(), p.K.data(), p.joint_K.data(), at.rotation.data(), at.reference.data()};
  EXPECT_TRUE(std::equal(std::begin(storage), std::end(storage), std::begin(after)));
  EXPECT_EQ(first.K, p.K) << "a second call overwrites, it does not add";

  EXPECT_THROW((void)kinematics<double>(m, VectorX<double>::Zero(3)), std::logic_error);
  Problem<double> other(structure_of(two_robots(4)));
  EXPECT_THROW(kinematics(m, q, at, other), std::logic_error);
  EXPECT_THROW((void)integrate<double>(m, q, VectorX<double>::Zero(2)), std::logic_error);
}

TEST(mechanism, used_again_says_what_a_new_one_says) {
  Model m = two_robots(6);
  Random random(6);
  add_constraints(m, random, true);
  Mechanism<double> kept(m);
  Problem<double> p(kept.structure());
  Poses<double> at, fresh;
  for (int turn = 0; turn < 5; ++turn) {
    const VectorX<double> q = random_configuration(m, random);
    kept.update(q);
    kept.fill(p);
    kept.poses(at);
    poses(m, q, fresh);
    const Problem<double> expected = kinematics<double>(m, q);
    EXPECT_TRUE(p.S == expected.S && p.H == expected.H && p.K == expected.K) << turn;
    EXPECT_TRUE(p.armature == expected.armature && p.joint_K == expected.joint_K) << turn;
    EXPECT_TRUE(at.rotation == fresh.rotation && at.position == fresh.position && at.reference == fresh.reference) << turn;
    EXPECT_EQ(at.tree, fresh.tree);
  }
  Problem<double> other(structure_of(two_robots(6)));
  EXPECT_THROW(kept.fill(other), std::logic_error);
  EXPECT_THROW(kept.update(VectorX<double>::Zero(1)), std::logic_error);
}

TEST(integrate, is_a_one_parameter_group) {
  const Model m = two_robots(5);
  Random random(5);
  for (const double size : {1e-30, 1e-3, 1.0, 5.0}) {
    const VectorX<Quad> q = random_configuration(m, random).cast<Quad>();
    VectorX<Quad> v(m.dofs());
    for (Index k = 0; k < v.size(); ++k) v[k] = Quad(size * random.number());
    const VectorX<Quad> once = integrate<Quad>(m, q, v);
    EXPECT_LT(ratio<Quad>(integrate<Quad>(m, once, v), integrate<Quad>(m, q, VectorX<Quad>(v + v))), 30);
    EXPECT_LT(ratio<Quad>(integrate<Quad>(m, once, VectorX<Quad>(-v)), q), 30);
  }
}

TEST(integrate, free_body_turns_and_moves_on_a_circle) {
  Model m;
  Random random(6);
  m.add(random_body(random, "b", ground, JointType::floating));
  const double angle = 1.2, radius = 2.5;  // about z with v along x: centre at (0, radius, 0)
  const VectorX<double> q = integrate<double>(m, neutral(m), VectorX<double>{{0, 0, angle, angle * radius, 0, 0}});
  const VectorX<double> expected{{radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, std::cos(angle / 2), 0, 0, std::sin(angle / 2)}};
  EXPECT_LT(ratio<double>(q, expected), 30);
}

}  // namespace
}  // namespace delassus::kinematics_test
