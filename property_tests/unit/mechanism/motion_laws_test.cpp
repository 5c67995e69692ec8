// Laws of c(q, ν), J̇ν and inverse dynamics, and what notices when they are broken.
#include <gtest/gtest.h>

#include "property_tests/unit/mechanism/newton_euler.h"
#include "property_tests/unit/mechanism/motion_cases.h"

namespace delassus::motion_laws_test {
namespace {

using namespace unit;

/// A mechanism with axes in any direction, of every joint and every kind of row.
struct Case {
  Model model;
  VectorX<double> q, nu, acceleration;
  Vector3<double> g;

  explicit Case(unsigned seed, bool distances = true) : model(two_robots(seed)) {
    Random random(seed);
    add_rows(model, random, distances);
    q = random_configuration(model, random);
    nu = VectorX<double>::NullaryExpr(model.dofs(), [&](Index) { return random.number(-2, 2); });
    acceleration = VectorX<double>::NullaryExpr(model.dofs(), [&](Index) { return random.number(-2, 2); });
    g = 10 * random.vector();
    for (Body& b : model.bodies) b.joint.armature.assign(static_cast<std::size_t>(dof_count(b.joint.type)), random.number(0, 1));
  }
};

/// c(q, ν) with gravity, and J̇ν.
template <class T> struct Bias {
  VectorX<T> c, rows;
};
template <class T> Bias<T> bias(const Model& model, const VectorX<T>& q, const VectorX<T>& nu, const Vector3<T>& g) {
  Mechanism<T> mechanism(model);
  Motion<T> motion(mechanism);
  mechanism.update(q);
  motion.update(nu);
  Bias<T> b;
  motion.bias_forces(g, b.c);
  motion.bias_rows(b.rows);
  return b;
}
template <class T> Bias<T> bias(const Case& k) {
  return bias<T>(k.model, converted<T>(k.q), converted<T>(k.nu), Vector3<T>(converted<T>(k.g)));
}

TEST(motion_laws, rows_are_the_rates_of_J_at_any_axes) {
  for (unsigned seed = 40; seed < 43; ++seed) {
    const Case k(seed);
    const Differentiated<Quad> truth(k.model, converted<Quad>(k.q), converted<Quad>(k.nu));
    EXPECT_LT(ratio<Quad>(bias<Quad>(k).rows, truth.rows()), 30) << seed;
  }
}

TEST(motion_laws, double_and_float_differ_from_quad_by_rounding) {
  for (unsigned seed = 40; seed < 46; ++seed) {
    const Case k(seed);
    const Bias<Quad> exact = bias<Quad>(k);
    const auto of = [&](auto scalar) {
      using T = decltype(scalar);
      // What kinematics makes of the numbers as T holds them.
      const VectorX<T> q = converted<T>(k.q), nu = converted<T>(k.nu), g = converted<T>(k.g);
      const Bias<Quad> truth = bias<Quad>(k.model, converted<Quad>(q), converted<Quad>(nu), Vector3<Quad>(converted<Quad>(g)));
      const Bias<T> said = bias<T>(k.model, q, nu, Vector3<T>(g));
      const auto against = [](const VectorX<T>& x, const VectorX<Quad>& y) {
        double error = 0, size = 0;
        for (Index i = 0; i < y.size(); ++i) {
          error = std::max(error, std::fabs(static_cast<double>(scalar_cast<Quad>(x[i]) - y[i])));
          size = std::max(size, std::fabs(static_cast<double>(y[i])));
        }
        return ratio(error, size, unit_roundoff<T>);
      };
      EXPECT_LT(against(said.c, truth.c), 30) << seed;
      EXPECT_LT(against(said.rows, truth.rows), 30) << seed;
    };
    of(double{});
    of(float{});
  }
}

TEST(motion_laws, c_is_a_quadratic_form_bit_for_bit) {
  for (unsigned seed = 50; seed < 54; ++seed) {
    const Case k(seed);
    const Vector3<double> none = Vector3<double>::Zero();
    const auto at = [&](double s) { return bias<double>(k.model, k.q, VectorX<double>(s * k.nu), none); };
    const Bias<double> one = at(1), back = at(-1), two = at(2), half = at(0.5), rest = at(0);
    EXPECT_EQ(back.c, one.c);
    EXPECT_EQ(back.rows, one.rows);
    EXPECT_EQ(two.c, 4 * one.c);
    EXPECT_EQ(two.rows, 4 * one.rows);
    EXPECT_EQ(half.c, 0.25 * one.c);
    EXPECT_TRUE(rest.c.isZero(0) && rest.rows.isZero(0));
  }
}

// ---- in rational numbers -----------------------------------------------------------------------------------------

using R = Rational;

template <class X> VectorX<Jet<R>> still(const X& x) {
  VectorX<Jet<R>> y(x.size());
  for (Index k = 0; k < x.size(); ++k) y[k] = Jet<R>(x[k], R(0));
  return y;
}
Bias<R> exact(const Model& model, const VectorX<R>& q, const VectorX<R>& nu, const Vector3<R>& g) {
  const Bias<Jet<R>> b = bias<Jet<R>>(model, still(q), still(nu), Vector3<Jet<R>>(still(g)));
  return {value_of<R>(b.c), value_of<R>(b.rows)};
}

struct RationalCase {
  Eighths dice;
  Model model;
  VectorX<R> q, nu, other;
  Vector3<R> g, no_g = Vector3<R>::Constant(R(0));

  explicit RationalCase(unsigned seed) : dice(seed), model(rational_robots(dice)) {
    add_rows(model, dice, false);
    q = dice.fractions<R>(model.q_size());
    nu = dice.fractions<R>(model.dofs());
    other = dice.fractions<R>(model.dofs());
    g = dice.fractions<R>(3);
  }
};

TEST(motion_laws, parallelogram_of_velocities_exactly) {
  const RationalCase k(61);
  const auto at = [&](const VectorX<R>& v) { return exact(k.model, k.q, v, k.no_g); };
  const Bias<R> sum = at(k.nu + k.other), difference = at(k.nu - k.other), x = at(k.nu), y = at(k.other);
  EXPECT_TRUE(VectorX<R>(sum.c + difference.c) == VectorX<R>(R(2) * (x.c + y.c)));
  EXPECT_TRUE(VectorX<R>(sum.rows + difference.rows) == VectorX<R>(R(2) * (x.rows + y.rows)));
}

/// Bias forces change the kinetic energy only as M does: 2 ν·c = νᵀṀν.
TEST(motion_laws, power_balances_exactly) {
  for (unsigned seed = 62; seed < 65; ++seed) {
    const RationalCase k(seed);
    const Differentiated<R> truth(k.model, k.q, k.nu);
    EXPECT_TRUE(R(2) * k.nu.dot(exact(k.model, k.q, k.nu, k.no_g).c) == truth.twice_power()) << seed;
  }
}

/// The same scene in axes turned by one of the cube's rotations.
TEST(motion_laws, a_turned_world_changes_nothing_exactly) {
  RationalCase k(66);
  const Bias<R> before = exact(k.model, k.q, k.nu, k.g);
  const Pose<double> turn = k.dice.pose();
  for (Body& b : k.model.bodies)
    if (b.parent == ground) b.joint.placement = turn * b.joint.placement;
  for (Constraint& c : k.model.constraints)
    for (Frame* f : {&c.a, &c.b})
      if (f->body == ground) f->placement = turn * f->placement;
  const Bias<R> after = exact(k.model, k.q, k.nu, Vector3<R>(turn.rotation.cast<R>() * k.g));
  EXPECT_TRUE(after.c == before.c);
  EXPECT_TRUE(after.rows == before.rows);
}

/// A floating robot seen from a frame that travels with V: ν̇ changes by −ω × RᵀV in its own axes, forces do not.
TEST(motion_laws, a_travelling_observer_sees_the_same_forces_exactly) {
  Eighths dice(67);
  Model m;
  m.add(rational_body(dice, "base", ground, JointType::floating));
  m.add(rational_body(dice, "arm", 0, JointType::universal));
  m.add(rational_body(dice, "hand", 1, JointType::cylindrical));
  m.bodies[0].joint.armature.clear();  // a rotor on a free body's axes would not move with it
  const VectorX<R> q = dice.fractions<R>(m.q_size()), nu = dice.fractions<R>(m.dofs());
  const Vector3<R> none = Vector3<R>::Constant(R(0)), V = dice.fractions<R>(3);  // in body axes
  VectorX<R> seen = nu, change = VectorX<R>::Constant(m.dofs(), R(0));
  seen.segment<3>(3) += V;
  change.segment<3>(3) = Vector3<R>(nu.head<3>()).cross(V);
  const MatrixX<R> M = value_of<R>(mass_matrix(Differentiated<R>(m, q, nu).problem));
  EXPECT_TRUE(exact(m, q, seen, none).c == VectorX<R>(exact(m, q, nu, none).c + M * change));
}

TEST(motion_laws, distances_exactly) {
  Eighths dice(68);
  Model m;
  m.add(rational_body(dice, "a", ground, JointType::floating));
  m.add(rational_body(dice, "b", ground, JointType::floating));
  for (Body& b : m.bodies) b.joint.placement = {};
  const Vector3<double> legs[] = {{3, 4, 12}, {2, -3, 6}, {-1, 4, 8}};
  for (const Vector3<double>& leg : legs)
    for (const Index other : {Index{1}, ground}) {
      Constraint c;
      c.kind = Constraint::Kind::distance;
      c.length = 1;
      c.a = {0, {Matrix3<double>::Identity(), dice.vector()}};
      c.b = {other, {Matrix3<double>::Identity(), c.a.placement.translation - leg}};
      m.constraints.push_back(c);
      std::swap(c.a, c.b);
      m.constraints.push_back(c);
    }
  VectorX<R> q = VectorX<R>::Constant(m.q_size(), R(0));  // both at the origin, not turned
  q[3] = q[10] = R(1);
  const VectorX<R> nu = dice.fractions<R>(m.dofs());
  EXPECT_TRUE(exact(m, q, nu, Vector3<R>::Constant(R(0))).rows == VectorX<R>(Differentiated<R>(m, q, nu).rows()));
}

// ---- judges ------------------------------------------------------------------------------------------------------

/// c in Quad by the second way.
VectorX<Quad> second_way(const Case& k, NewtonEulerDefect defect = NewtonEulerDefect::none) {
  const VectorX<Quad> q = converted<Quad>(k.q);
  Problem<Quad> p(structure_of(k.model));
  Poses<Quad> poses;
  kinematics(k.model, q, poses, p);
  return newton_euler<Quad>(k.model, p, poses, converted<Quad>(k.nu), Vector3<Quad>(converted<Quad>(k.g)), defect);
}

TEST(motion_laws, newton_euler_written_differently_agrees_and_defects_do_not) {
  using D = NewtonEulerDefect;
  for (unsigned seed = 70; seed < 73; ++seed) {
    const Case k(seed);
    const VectorX<Quad> said = bias<Quad>(k).c;
    EXPECT_LT(ratio<Quad>(said, second_way(k)), 30) << seed;
    for (const D defect : {D::axes_stand_still, D::axis_carried_by_child, D::second_axis_not_carried, D::origin_stands_still,
                           D::momentum_not_turned, D::cross_the_other_way, D::no_children, D::weight_at_the_frame})
      EXPECT_GT(ratio<Quad>(said, second_way(k, defect)), 1e20) << static_cast<int>(defect) << " seed " << seed;
  }
}

/// What J̇ν would be with a term forgotten: each must be far from the rate of J, where it is not zero by itself.
TEST(motion_laws, forgotten_terms_of_rows_are_noticed) {
  Case k(74);
  const Constraint whole = k.model.constraints[5];  // weld between bodies 3 and 7
  ASSERT_EQ(whole.kind, Constraint::Kind::weld);
  k.model.constraints = {whole};
  const VectorX<Quad> q = converted<Quad>(k.q), nu = converted<Quad>(k.nu);
  const Differentiated<Quad> truth(k.model, q, nu);
  const MatrixX<Quad> expected = truth.rows();
  const auto spoilt = [&](auto change) {
    VectorX<Quad> rows = bias<Quad>(k).rows;
    change(rows);
    return ratio<Quad>(MatrixX<Quad>(rows), expected);
  };
  const auto row_part = [&](Index body, auto motion) {  // K of one body times a motion
    const auto& e = truth.problem.structure->link_constraints[0];
    VectorX<Quad> y = VectorX<Quad>::Constant(6, Quad(0));
    for (const auto& l : e.links)
      if (l.body == body)
        for (Index r = 0; r < 6; ++r) y[r] = value_of<Quad>(truth.problem.K[l.first + r]).col(0).dot(motion);
    return y;
  };
  const Vector6<Quad> of_a = truth.velocity_product(3), of_b = truth.velocity_product(7), va = truth.twist(3), vb = truth.twist(7);
  EXPECT_LT(spoilt([](VectorX<Quad>&) {}), 30);
  EXPECT_GT(spoilt([&](VectorX<Quad>& y) { y -= row_part(7, of_b); }), 1e20) << "bias of the second body forgotten";
  EXPECT_GT(spoilt([&](VectorX<Quad>& y) { y -= row_part(3, of_a); }), 1e20) << "bias of the first body forgotten";
  EXPECT_GT(spoilt([&](VectorX<Quad>& y) { y -= row_part(3, motion_cross<Quad>(va, vb)); }), 1e20) << "cross term of the two bodies";
  EXPECT_GT(spoilt([&](VectorX<Quad>& y) { y = row_part(3, of_a) + row_part(7, of_b); }), 1e20) << "rows that stand still";
}

/// (J(q ⊕ hν) − J(q ⊖ hν)) ν / 2h with the coordinates moved by integrate, not by their rates: off by h² times a sixth of a third
/// derivative of J along the motion, which is below (Σ|ν|)³ times the lengths that J is made of.
TEST(motion_laws, rows_are_differences_of_J_along_the_motion) {
  constexpr double h = 0x1p-34;
  for (unsigned seed = 75; seed < 78; ++seed) {
    const Case k(seed);
    const VectorX<Quad> q = converted<Quad>(k.q), nu = converted<Quad>(k.nu);
    const auto J_nu = [&](double s) {
      return MatrixX<Quad>(constraint_jacobian(kinematics<Quad>(k.model, integrate<Quad>(k.model, q, VectorX<Quad>(nu * Quad(s))))) * nu);
    };
    const MatrixX<Quad> difference = (J_nu(h) - J_nu(-h)) / Quad(2 * h), rows = bias<Quad>(k).rows;
    double rate = 1 + k.nu.cwiseAbs().sum(), length = 1 + k.q.cwiseAbs().sum();
    for (const Body& b : k.model.bodies) length += b.joint.placement.translation.norm() + b.com.norm();
    double error = 0;
    for (Index i = 0; i < rows.rows(); ++i) error = std::max(error, std::fabs(static_cast<double>(Quad(rows(i, 0) - difference(i, 0)))));
    EXPECT_LT(ratio(error, rate * rate * rate * rate * length, h * h), 30) << seed;
  }
}

TEST(motion_laws, rnea_is_M_times_acceleration_and_c) {
  for (unsigned seed = 80; seed < 83; ++seed) {
    const Case k(seed);
    Mechanism<Quad> mechanism(k.model);
    Motion<Quad> motion(mechanism);
    mechanism.update(converted<Quad>(k.q));
    motion.update(converted<Quad>(k.nu));
    VectorX<Quad> tau;
    motion.rnea(converted<Quad>(k.acceleration), Vector3<Quad>(converted<Quad>(k.g)), tau);
    Problem<Quad> p(mechanism.structure());
    mechanism.fill(p);
    EXPECT_LT(ratio<Quad>(tau, VectorX<Quad>(mass_matrix(p) * converted<Quad>(k.acceleration) + second_way(k))), 30) << seed;
  }
}

TEST(motion_laws, how_fast_a_robot_on_rails_travels_costs_no_bit) {
  Random random(84);
  Model m;
  m.add(random_body(random, "slide", ground, JointType::prismatic));
  m.add(random_body(random, "arm", 0, JointType::universal));
  m.add(random_body(random, "hand", 1, JointType::spherical));
  Constraint c;
  c.a = {2, random.pose()};
  c.b = {1, random.pose()};
  c.kind = Constraint::Kind::planar;
  m.constraints.push_back(c);
  const VectorX<double> q = random_configuration(m, random);
  VectorX<double> nu = VectorX<double>::NullaryExpr(m.dofs(), [&](Index) { return random.number(); });
  const Bias<double> slow = bias<double>(m, q, nu, Vector3<double>::Zero());
  nu[0] += 0x1p40;
  const Bias<double> fast = bias<double>(m, q, nu, Vector3<double>::Zero());
  EXPECT_EQ(slow.c, fast.c);
  EXPECT_EQ(slow.rows, fast.rows);
}

TEST(motion_laws, sizes_are_checked) {
  const Case k(85);
  Mechanism<double> mechanism(k.model);
  Motion<double> motion(mechanism);
  mechanism.update(k.q);
  EXPECT_THROW(motion.update(VectorX<double>::Zero(3)), std::logic_error);
  motion.update(k.nu);
  VectorX<double> tau;
  EXPECT_THROW(motion.rnea(VectorX<double>::Zero(3), k.g, tau), std::logic_error);
}

}  // namespace
}  // namespace delassus::motion_laws_test
