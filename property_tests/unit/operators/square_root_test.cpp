// The square-root elimination where the loop over the laws does not reach: lost pivots, general right-hand sides, roots of
// block damping. Its kernel: householder_test.cpp.
#include <gtest/gtest.h>

#include <random>

#include "algorithms/delassus.h"
#include "algorithms/factors/factor.h"
#include "algorithms/factors/mass_root.h"
#include "algorithms/factors/square_root_factor.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/laws/verdict.h"
#include "reference/definition.h"

namespace delassus::square_root_test {
namespace {

using laws::judge;

MatrixX<double> random_columns(Index rows, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  return MatrixX<double>::NullaryExpr(rows, 1, [&] { return number(engine); });
}

Quad largest(const MatrixX<Quad>& x) {
  Quad m(0);
  for (Index k = 0; k < x.size(); ++k) m = std::max(m, abs(x.data()[k]));
  return m;
}
Quad norm(const MatrixX<Quad>& A) {  // ∞-norm
  Quad m(0);
  for (Index r = 0; r < A.rows(); ++r) {
    Quad sum(0);
    for (Index c = 0; c < A.cols(); ++c) sum += abs(A(r, c));
    m = std::max(m, sum);
  }
  return m;
}

// M δν − Jᵀδλ = r₁ and J δν + R⁻¹δλ = r₂ hold to the rounding of their own terms and of the fit's, M_R δν.
TEST(SquareRootFactor, SolvesAnyRightSide) {
  for (const char* family : {"humanoid", "generic", "massless", "block_damping", "comb", "redundant", "joint_friction", "star"}) {
    const auto built = generators::build(generators::find_family(family).make(8, 1));
    const Structure& s = *built.problem.structure;
    SquareRootFactor<double> factor;
    factor.analyze(s);
    ASSERT_TRUE(factor.update(built.problem, built.damping).ok()) << family;
    const MatrixX<double> r1 = random_columns(s.dofs(), 1), r2 = random_columns(s.rows, 2);
    MatrixX<double> nu(s.dofs(), 1), lambda(s.rows, 1);
    Workspace<double> work(factor.workspace());
    work.fill(std::numeric_limits<double>::quiet_NaN());
    factor.solve_kkt(r1.data(), r2.data(), nu.data(), lambda.data(), work.data());

    const auto d = reference::dense<Quad>(built.problem.cast<Quad>(), built.damping.cast<Quad>());
    const MatrixX<Quad> v = nu.cast<Quad>(), f = lambda.cast<Quad>(), a = r1.cast<Quad>(), b = r2.cast<Quad>();
    const MatrixX<Quad> e1 = d.M * v - d.J.transpose() * f - a, e2 = d.J * v + d.R_inverse * f - b;
    const Quad size = Quad(static_cast<double>(s.dofs() + s.rows));
    const Quad b1 = size * (norm(d.M) * largest(v) + norm(d.J.transpose()) * largest(f) + largest(a));
    const Quad b2 = size * (norm(d.J) * largest(v) + norm(d.R_inverse) * largest(f) + largest(b));
    const auto first = judge(e1, MatrixX<Quad>::Constant(e1.rows(), 1, b1), unit_roundoff<double>, "(n + m) · terms");
    const auto second = judge(e2, MatrixX<Quad>::Constant(e2.rows(), 1, b2), unit_roundoff<double>, "(n + m) · terms");
    EXPECT_TRUE(first.passed() && second.passed()) << family << ' ' << first.ratio << ' ' << second.ratio;

    const MatrixX<double> zero = MatrixX<double>::Zero(s.dofs(), 1);  // no r₁ = a zero r₁
    MatrixX<double> nu0 = nu, lambda0 = lambda;
    factor.solve_kkt(zero.data(), r2.data(), nu.data(), lambda.data(), work.data());
    factor.solve_kkt(nullptr, r2.data(), nu0.data(), lambda0.data(), work.data());
    EXPECT_TRUE(laws::judge_equal<double>(nu, nu0).passed() && laws::judge_equal<double>(lambda, lambda0).passed()) << family;
  }
}

// A double pendulum of point masses, held at its tip: both inertias have rank 3.
Problem<double> point_masses() {
  auto structure = std::make_shared<Structure>();
  structure->add_body(ground, 1);
  structure->add_body(0, 2);
  structure->add_link_constraint(2, {1});
  Problem<double> p(structure);
  const auto inertia = [](double mass, double x, double y, double z) {
    Matrix3<double> c;
    c << 0, -z, y, z, 0, -x, -y, x, 0;
    Matrix6<double> H;
    H << mass * c * c.transpose(), mass * c, mass * c.transpose(), mass * Matrix3<double>::Identity();
    return H;
  };
  p.H = {inertia(2, 1, 0, 0.5), inertia(3, 2, 1, 0.5)};
  p.S[0] << 0, 0, 1, 0, 0, 0;
  p.S[1] << 0, 0, 1, 0, -1, 0;
  p.S[2] << 0, 1, 0, 0, 0, 1;
  p.K[0] << 0, 0, 0, 1, 0, 0;
  p.K[1] << 0, 0, 2, 0, 1, 0;
  return p;
}

TEST(SquareRootFactor, NamesTheFreedomWithoutInertia) {
  const Problem<double> original = point_masses();
  Problem<double> p = original;
  SquareRootFactor<double> factor;
  factor.analyze(*p.structure);
  const auto damping = Damping<double>::uniform(2, 1.0);
  ASSERT_TRUE(factor.update(p, damping).ok());
  p.H[1].setZero();
  p.K[0].setZero();
  p.K[1].setZero();
  p.H[1](2, 2) = 1;  // about z only: the second freedom of body 1 moves nothing
  const Report lost = factor.update(p, damping);
  EXPECT_EQ(lost.status, Status::lost_pivot);
  EXPECT_EQ(lost.where, 2);
  p.armature[2] = 0x1p-60;  // however small
  EXPECT_TRUE(factor.update(p, damping).ok());

  p = original;
  p.S[1] << 0.1, 0.3, 1, 0.7, -1, 0.9;
  p.S[2] = p.S[1] / 3;  // dependent but for rounding
  const Report dependent = factor.update(p, damping);
  EXPECT_EQ(dependent.status, Status::lost_pivot);
  EXPECT_EQ(dependent.where, 2);
}

// z = Wᵀ W x against x = R⁻¹ z.
void expect_root(const WeightRoot<double>& root, const Structure& s, const Damping<double>& damping) {
  const MatrixX<double> x = random_columns(s.rows, 3);
  MatrixX<double> y = x, z = x;
  root.multiply(x.data(), y.data());
  root.multiply_transposed(y.data(), z.data());
  const MatrixX<Quad> R_inverse = reference::damping_matrix<Quad>(s, damping.cast<Quad>());
  const MatrixX<Quad> error = R_inverse * z.cast<Quad>() - x.cast<Quad>();
  const Quad bound = Quad(static_cast<double>(s.rows)) * norm(R_inverse) * largest(z.cast<Quad>());
  EXPECT_TRUE(judge(error, MatrixX<Quad>::Constant(s.rows, 1, bound), unit_roundoff<double>, "m ‖R⁻¹‖ ‖z‖").passed());
}

TEST(WeightRoot, IsARootOfWhatItWasAssignedLast) {
  const auto built = generators::build(generators::find_family("block_damping").make(6, 1));
  const Structure& s = *built.problem.structure;
  ASSERT_FALSE(built.damping.blocks.empty());
  WeightRoot<double> root;
  root.analyze(s);
  for (const Damping<double>& damping : {built.damping, Damping<double>::uniform(s.rows, 0.3), built.damping}) {
    ASSERT_TRUE(root.assign(damping).ok());
    expect_root(root, s, damping);
  }
}

TEST(WeightRoot, NamesTheRowItDoesNotExistIn) {
  Structure s;
  s.add_body(ground, 1);
  s.add_link_constraint(3, {0});
  s.add_joint_constraint(3, 0);
  WeightRoot<double> root;
  root.analyze(s);
  for (Index row = 0; row < 6; ++row) {
    auto damping = Damping<double>::uniform(6, 1.0);
    damping.diagonal[row] = 0;
    const Report plain = root.assign(damping);
    EXPECT_TRUE(plain.status == Status::zero_damping && plain.where == row) << row << ": " << plain.where;
    damping.blocks = {{row / 3 * 3, MatrixX<double>::Identity(3, 3)}};
    damping.blocks[0].R_inverse(row % 3, row % 3) = 0;
    const Report block = root.assign(damping);
    EXPECT_TRUE(block.status == Status::zero_damping && block.where == row) << row << ": " << block.where;
  }
}

// A pivot of 28 or 29 units of 2⁻⁵² where 30 eps of its diagonal are 28.4.
TEST(MassRoot, APivotIsLostAt30EpsOfItsDiagonal) {
  auto structure = std::make_shared<Structure>();
  structure->add_body(ground, 1);
  structure->add_body(0, 2);
  Problem<double> p(structure);
  for (auto& H : p.H) H.diagonal().setOnes();
  p.S[0][1] = p.S[1][0] = 1;
  p.S[2][0] = 1.375;
  const Plan plan = make_plan(*structure, Matrix::M, Branches::all);
  MassRoot<double> root;
  root.analyze(*structure, plan);
  p.armature[2] = 29 * 0x1p-52;
  EXPECT_TRUE(root.update(p).ok());
  p.armature[2] = 28 * 0x1p-52;
  const Report lost = root.update(p);
  EXPECT_TRUE(lost.status == Status::lost_pivot && lost.where == 2) << lost.where;
}

TEST(MassRoot, EnergyIsThatOfTheFactor) {
  for (const char* family : {"generic", "several_trees", "random_tree", "joint_friction"}) {
    const Problem<double> p = generators::build(generators::find_family(family).make(6, 1)).problem;
    const Plan plan = make_plan(*p.structure, Matrix::M, Branches::all);
    Factor<double> factor;
    MassRoot<double> root;
    factor.analyze(*p.structure, plan);
    root.analyze(*p.structure, plan);
    ASSERT_TRUE(factor.start(p).ok() && factor.update_undamped().ok() && root.update(p).ok());
    Workspace<double> of_factor(factor.workspace()), of_root(static_cast<Index>(6 * sizeof(Six<double>)) * p.structure->bodies());
    of_root.fill(0.75);
    std::vector<double> tau(static_cast<std::size_t>(p.structure->dofs()));
    for (std::size_t c = 0; c < tau.size(); ++c) tau[c] = c % 3 == 0 ? -1 : 0.5 + 0.125 * static_cast<double>(c);
    const double expected = factor.energy(tau.data(), of_factor.data()), got = root.energy(tau.data(), of_root.data());
    const auto one = [](double x) { return MatrixX<Quad>::Constant(1, 1, Quad(x)); };  // half the digits: M is not near singular
    EXPECT_TRUE(judge(one(got - expected), one(expected), unit_roundoff<float>, "itself").passed()) << family << ": " << got << " for " << expected;
  }
}

}  // namespace
}  // namespace delassus::square_root_test
