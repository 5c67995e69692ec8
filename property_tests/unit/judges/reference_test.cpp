// The references against closed forms, and against each other.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/judges/reference_cases.h"
#include "reference/definition.h"
#include "reference/kkt_cholmod.h"
#include "reference/maximal.h"
#include "reference/reference.h"
#include "reference/sensitivity.h"

namespace delassus::reference::reference_test {
namespace {

using namespace cases;

// ---- closed forms ----------------------------------------------------------------------------------------------

Rational fraction(long numerator, long denominator) { return Rational(numerator) / Rational(denominator); }

/// m = 2 kg at 1/2 m on x, I = 1/4 kg m², about z: M = I + m l² = 3/4; the tip along y: J = 1/2; A0 = 1/3.
TEST(Reference, Pendulum) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 1);
  s->add_link_constraint(1, {0});
  Problem<double> p(s);
  p.S[0] = rotation_axis<double>({0, 0, 1}, {0, 0, 0});
  p.H[0] = spatial_inertia<double>(2, {0.5, 0, 0}, Matrix3<double>::Identity() * 0.25);
  p.K[0] << 0, 0, 0.5, 0, 1, 0;
  const auto damping = Damping<double>::uniform(1, 0.5);
  const auto d = dense(p.cast<Rational>(), damping.cast<Rational>());
  EXPECT_TRUE(d.M(0, 0) == fraction(3, 4));
  EXPECT_TRUE(d.J(0, 0) == fraction(1, 2));
  EXPECT_TRUE(d.A0(0, 0) == fraction(1, 3));
  EXPECT_TRUE(dense_damped_inverse(d)(0, 0) == fraction(6, 5));
  const MatrixX<Rational> one = MatrixX<Rational>::Constant(1, 1, Rational(1));
  EXPECT_TRUE(maximal_apply(p.cast<Rational>(), damping.cast<Rational>(), one)(0, 0) == fraction(5, 6));
  EXPECT_TRUE(maximal_solve(p.cast<Rational>(), damping.cast<Rational>(), one)(0, 0) == fraction(6, 5));
}

/// Cart 3 kg along x, pole 2 kg with its centre 1/2 m up and I = 1/4, about z.
/// M = [3 + 2, −2·½; −2·½, ¼ + 2·¼]; rows: tip 1 m up along x, J = [1, −1]; the cart's joint, J = [1, 0].
TEST(Reference, CartPole) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 1);
  s->add_body(0, 1);
  s->add_link_constraint(1, {1});
  s->add_joint_constraint(1, 0);
  Problem<double> p(s);
  p.S[0] = translation_axis<double>({1, 0, 0});
  p.S[1] = rotation_axis<double>({0, 0, 1}, {0, 0, 0});
  p.H[0] = spatial_inertia<double>(3, {0, 0, 0}, Matrix3<double>::Identity());
  p.H[1] = spatial_inertia<double>(2, {0, 0.5, 0}, Matrix3<double>::Identity() * 0.25);
  p.K[0] << 0, 0, -1, 1, 0, 0;
  p.joint_K[0] = 1;
  const auto d = dense(p.cast<Rational>(), Damping<double>::uniform(2, 0).cast<Rational>());
  const Rational M[2][2] = {{5, -1}, {-1, fraction(3, 4)}}, J[2][2] = {{1, -1}, {1, 0}};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      EXPECT_TRUE(d.M(i, j) == M[i][j]);
      EXPECT_TRUE(d.J(i, j) == J[i][j]);
    }
  // det M = 11/4, M⁻¹ = 4/11 [3/4, 1; 1, 5].
  EXPECT_TRUE(d.A0(0, 0) == fraction(15, 11));
  EXPECT_TRUE(d.A0(0, 1) == fraction(-1, 11));
  EXPECT_TRUE(d.A0(1, 0) == fraction(-1, 11));
  EXPECT_TRUE(d.A0(1, 1) == fraction(3, 11));
}

/// Two free bodies about one centre, welded: A0 = H_1⁻¹ + H_2⁻¹. Hard rows.
TEST(Reference, WeldOfTwoFreeBodies) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 6);
  s->add_body(ground, 6);
  s->add_link_constraint(6, {0, 1});
  Problem<double> p(s);
  for (Index k = 0; k < 6; ++k) {
    p.S[k] = p.S[6 + k] = Vector6<double>::Unit(k);
    p.K[k] = Vector6<double>::Unit(k);
    p.K[6 + k] = -Vector6<double>::Unit(k);
  }
  p.H[0] = spatial_inertia<double>(2, {0, 0, 0}, Matrix3<double>::Identity() * 4);
  p.H[1] = spatial_inertia<double>(8, {0, 0, 0}, Matrix3<double>::Identity() * 0.5);
  const auto damping = Damping<double>::uniform(6, 0);
  for (const auto& reference : references()) {
    EXPECT_TRUE(reference.trusts(p, damping)) << reference.name;
    const MatrixX<Quad> A = reference.apply(p, damping, Matrix::Identity(6, 6));
    const MatrixX<Quad> inverse = reference.solve(p, damping, Matrix::Identity(6, 6));
    const Sensitivity bounds(p, damping);
    for (Index k = 0; k < 6; ++k) {
      const Vector unit = Vector::Unit(6, k);
      const Quad expected = k < 3 ? Quad(2.25) : Quad(0.625);
      VectorX<Quad> column = convert<Quad, double>(Matrix(unit)).col(0);
      column[k] = expected;
      EXPECT_LT(ratio(A.col(k), column, bounds.apply_sensitivity(unit), reference.roundoff), 30) << reference.name;
      column[k] = Quad(1) / expected;
      EXPECT_LT(ratio(inverse.col(k), column, bounds.solve_sensitivity(unit, rounded(column)), reference.roundoff), 30)
          << reference.name;
    }
  }
}

// ---- agreement -------------------------------------------------------------------------------------------------

void expect_agreement(const Case& c, unsigned seed) {
  const Matrix x = random_right_side(seed, c.problem.structure->rows);
  const Sensitivity bounds(c.problem, c.damping);
  const MatrixX<Quad> a = references()[0].apply(c.problem, c.damping, x);
  const MatrixX<Quad> f = references()[0].solve(c.problem, c.damping, x);
  const Vector apply_bound = bounds.apply_sensitivity(x.col(0)), solve_bound = bounds.solve_sensitivity(x.col(0), rounded(f));
  EXPECT_LT(ratio(f.col(0), bounds.solve(x.col(0)), solve_bound, unit_roundoff<Quad>), 30);
  for (const auto& reference : references()) {
    ASSERT_TRUE(reference.trusts(c.problem, c.damping)) << reference.name << " seed " << seed;
    const double apply_ratio = ratio(reference.apply(c.problem, c.damping, x).col(0), a.col(0), apply_bound, reference.roundoff);
    const double solve_ratio = ratio(reference.solve(c.problem, c.damping, x).col(0), f.col(0), solve_bound, reference.roundoff);
    EXPECT_LT(apply_ratio, 30) << reference.name << " seed " << seed;
    EXPECT_LT(solve_ratio, 30) << reference.name << " seed " << seed;
  }
}

TEST(Reference, AllAgreeOnTreesWithLoops) {
  for (unsigned seed = 1; seed <= 12; ++seed) expect_agreement(random_case(seed, 2 + seed % 5, seed % 4), seed);
}

TEST(Reference, AllAgreeWithBlockDamping) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Case c = random_case(seed, 4, 2);
    add_block(c, seed);
    expect_agreement(c, seed);
  }
}

TEST(Reference, AllAgreeWithHardRows) {
  int regular = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Case c = random_case(seed, 8, 1);
    c.damping = Damping<double>::uniform(c.problem.structure->rows, 0);
    if (!factorise(dense(c.problem.cast<Rational>(), c.damping.cast<Rational>())).regular()) continue;
    ++regular;
    expect_agreement(c, seed);
  }
  EXPECT_GE(regular, 4);
}

TEST(Reference, AllAgreeWithRedundantRowsAndSmallDamping) {
  for (unsigned seed = 1; seed <= 6; ++seed) expect_agreement(random_case(seed, 2, 6, 0x1p-40), seed);
}

TEST(Reference, SeveralColumnsAreColumns) {
  const Case c = random_case(3, 4, 2);
  const Index m = c.problem.structure->rows;
  for (const auto& reference : references()) {
    const MatrixX<Quad> both = reference.solve(c.problem, c.damping, Matrix::Identity(m, m));
    for (Index r = 0; r < m; ++r)
      EXPECT_TRUE(both.col(r) == reference.solve(c.problem, c.damping, Matrix(Vector::Unit(m, r))).col(0)) << reference.name;
  }
}

TEST(Reference, NothingToDo) {
  auto s = std::make_shared<Structure>();
  const Problem<double> no_bodies(s);
  s = std::make_shared<Structure>();
  s->add_body(ground, 1);
  Problem<double> no_rows(s);
  no_rows.S[0] = translation_axis<double>({1, 0, 0});
  no_rows.H[0] = spatial_inertia<double>(1, {0, 0, 0}, Matrix3<double>::Identity());
  const auto damping = Damping<double>::uniform(0, 0);
  for (const auto& p : {no_bodies, no_rows}) {
    for (const auto& reference : references()) {
      EXPECT_TRUE(reference.trusts(p, damping)) << reference.name;
      EXPECT_EQ(reference.apply(p, damping, Matrix(0, 2)).rows(), 0) << reference.name;
      EXPECT_EQ(reference.solve(p, damping, Matrix(0, 2)).rows(), 0) << reference.name;
    }
    const Sensitivity bounds(p, damping);
    EXPECT_EQ(bounds.apply_sensitivity(Vector(0)).size(), 0);
    EXPECT_EQ(bounds.solve_normwise(Vector(0), Vector(0)).size(), 0);
    EXPECT_EQ(bounds.solve_amplified(Vector(0)).size(), 0);
  }
}

// ---- exact arithmetic ------------------------------------------------------------------------------------------

TEST(Reference, ExactDefinitionIsExactMaximal) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Case c = random_case(seed, 3, 1 + seed % 2);
    if (seed % 2 == 0) add_block(c, seed);
    const auto p = c.problem.cast<Rational>();
    const auto damping = c.damping.cast<Rational>();
    const Matrix x = random_right_side(seed, p.structure->rows);
    const auto right = convert<Rational>(x);
    const auto d = dense(p, damping);
    const MatrixX<Rational> a = dense_apply(d, right), f = dense_solve(d, right);
    EXPECT_TRUE(a == maximal_apply(p, damping, right)) << seed;
    EXPECT_TRUE(f == maximal_solve(p, damping, right)) << seed;
    EXPECT_TRUE(dense_apply(d, f) == right) << seed;
    EXPECT_TRUE(product(dense_damped_inverse(d), right) == f) << seed;
    const Sensitivity bounds(c.problem, c.damping);
    const MatrixX<Quad> a_quad = convert<Quad>(a), f_quad = convert<Quad>(f);
    for (const auto& reference : references()) {
      EXPECT_LT(ratio(reference.apply(c.problem, c.damping, x).col(0), a_quad.col(0), bounds.apply_sensitivity(x.col(0)),
                      reference.roundoff), 30) << reference.name << " seed " << seed;
      EXPECT_LT(ratio(reference.solve(c.problem, c.damping, x).col(0), f_quad.col(0),
                      bounds.solve_sensitivity(x.col(0), rounded(f_quad)), reference.roundoff), 30) << reference.name << " seed " << seed;
    }
  }
}

// ---- singular systems ------------------------------------------------------------------------------------------

TEST(Reference, RedundantHardRowsAreRefused) {
  Case c = random_case(5, 2, 6);
  c.damping = Damping<double>::uniform(c.problem.structure->rows, 0);
  ASSERT_GT(c.problem.structure->rows, c.problem.structure->dofs());
  const Matrix a = random_right_side(5, c.problem.structure->rows);
  for (const auto& reference : references()) EXPECT_THROW((void)reference.solve(c.problem, c.damping, a), std::runtime_error) << reference.name;
  EXPECT_FALSE(kkt_cholmod_trusts(c.problem, c.damping));
  const Sensitivity bounds(c.problem, c.damping);
  EXPECT_FALSE(bounds.regular());
  EXPECT_THROW((void)bounds.solve_normwise(a.col(0), a.col(0)), std::runtime_error);
  EXPECT_THROW((void)bounds.solve_amplified(a.col(0)), std::runtime_error);
  const auto d = dense(c.problem.cast<Rational>(), c.damping.cast<Rational>());
  EXPECT_EQ(factorise(d).rank(), c.problem.structure->dofs());
  EXPECT_EQ(factorise(bounds.matrices()).rank(), c.problem.structure->dofs());
}

TEST(Reference, MasslessBodies) {
  Case c = random_case(7, 5, 2);
  c.problem.H[2].setZero();
  for (auto& a : c.problem.armature) a = 0.5;
  const Matrix x = random_right_side(7, c.problem.structure->rows);
  const Sensitivity bounds(c.problem, c.damping);
  EXPECT_LT(ratio(references()[1].apply(c.problem, c.damping, x).col(0), references()[0].apply(c.problem, c.damping, x).col(0),
                  bounds.apply_sensitivity(x.col(0)), unit_roundoff<Quad>), 30);
  for (auto& h : c.problem.H) h.setZero();
  for (auto& a : c.problem.armature) a = 0;
  for (const auto& reference : references()) EXPECT_THROW((void)reference.apply(c.problem, c.damping, x), std::runtime_error) << reference.name;
  EXPECT_FALSE(kkt_cholmod_trusts(c.problem, c.damping));
}

// ---- zeros -----------------------------------------------------------------------------------------------------

/// A planar pair of links with inertias that are not planar: rows out of the plane are exact zeros everywhere.
TEST(Reference, UnreachedRowsAreExactZeros) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 1);
  s->add_body(0, 1);
  s->add_link_constraint(3, {1});
  s->add_joint_constraint(1, 0);
  Problem<double> p(s);
  p.S[0] = rotation_axis<double>({0, 0, 1}, {0, 0, 0});
  p.S[1] = rotation_axis<double>({0, 0, 1}, {1, 0.5, 0});
  for (Index i = 0; i < 2; ++i) p.H[i] = spatial_inertia<double>(2, {0.75, 0.25, 0.375}, Matrix3<double>::Identity());
  for (Index r = 0; r < 3; ++r) {  // the acceleration of the point (3; 1; 0) along x, y, z
    const Vector3<double> axis = Vector3<double>::Unit(r);
    p.K[r] << Vector3<double>(3, 1, 0).cross(axis), axis;
  }
  p.joint_K[0] = 1;
  auto damping = Damping<double>::uniform(4, 0);
  const Matrix x = (Matrix(4, 2) << 1, 0, 3, 0, 0, 0, 2, 0).finished();
  const Sensitivity bounds(p, damping);
  EXPECT_EQ(bounds.apply_sensitivity(x.col(0))[2], 0);
  damping.diagonal = {0.5, 0.5, 0.5, 0.5};
  for (const auto& reference : references()) {
    for (const MatrixX<Quad>& y : {reference.apply(p, damping, x), reference.solve(p, damping, x)}) {
      EXPECT_TRUE(y(2, 0) == Quad(0)) << reference.name;
      for (const Index r : {0, 1, 3}) EXPECT_FALSE(y(r, 0) == Quad(0)) << reference.name;
      for (Index r = 0; r < 4; ++r) EXPECT_TRUE(y(r, 1) == Quad(0)) << reference.name;
    }
  }
}

// ---- size ------------------------------------------------------------------------------------------------------

/// 10⁴ bodies: a tree of depth about 14, every joint of one degree of freedom, three damped rows on every tenth body
/// and a loop between neighbouring ones. A (A⁻¹ a) = a.
TEST(KktCholmod, TenThousandBodies) {
  constexpr Index bodies = 10000;
  Dice dice(1);
  auto s = std::make_shared<Structure>();
  for (Index i = 0; i < bodies; ++i) s->add_body(i == 0 ? ground : (i - 1) / 2, 1);
  for (Index i = 10; i < bodies; i += 10) s->add_link_constraint(3, {i});
  for (Index i = 100; i < bodies; i += 100) s->add_link_constraint(1, {i, i - 1});
  Case c{Problem<double>(s), Damping<double>::uniform(s->rows, 0x1p-13)};
  for (Index i = 0; i < bodies; ++i) {
    fill_joint(dice, c.problem, i);
    c.problem.H[i] = random_inertia(dice, 1);
  }
  for (auto& k : c.problem.K) k = dice.vector();
  ASSERT_TRUE(kkt_cholmod_trusts(c.problem, c.damping));
  const Matrix a = random_right_side(2, s->rows);
  const MatrixX<Quad> f = kkt_cholmod_solve(c.problem, c.damping, a);
  // apply takes double: f goes through it in two parts.
  const Matrix high = convert<double>(f), low = convert<double>(MatrixX<Quad>(f - convert<Quad>(high)));
  const MatrixX<Quad> back = kkt_cholmod_apply(c.problem, c.damping, high) + kkt_cholmod_apply(c.problem, c.damping, low);
  EXPECT_LT(ratio(back.col(0), convert<Quad>(a).col(0), Vector::Constant(s->rows, a.cwiseAbs().maxCoeff()),
                  unit_roundoff<double>), 30);
}

}  // namespace
}  // namespace delassus::reference::reference_test
