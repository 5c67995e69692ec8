// The square-root elimination where the loop over the laws does not reach: its kernel, lost pivots, general right-hand
// sides, roots of block damping.
#include <gtest/gtest.h>

#include <random>

#include "algorithms/delassus.h"
#include "algorithms/square_root_factor.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/verdict.h"
#include "reference/definition.h"

namespace delassus {
namespace {

using laws::judge;

// One block of at most six columns, and what its reduction leaves.
struct Reduction {
  std::vector<Six<double>> rows;
  std::vector<double> v, beta;
  std::vector<int> pivot;
  std::vector<Six<double>> kept;
  int lane[6] = {}, reduced = 0;

  Reduction(const MatrixX<double>& A, int columns)
      : rows(static_cast<std::size_t>(A.rows()), Six<double>::zero()), v(static_cast<std::size_t>(6 * stride(A)), 7.0),
        beta(6), pivot(6), kept(6, Six<double>::zero()) {
    const double nothing[6] = {};
    for (Index r = 0; r < A.rows(); ++r)
      for (Index c = 0; c < A.cols(); ++c) rows[r].v[c] = A(r, c);
    const Strip<double> strip{rows.data(), A.rows(), 1, static_cast<int>(A.rows())};
    reduced = triangularise(strip, 0, columns, nothing, Reflections<double>{v.data(), stride(A), beta.data(), pivot.data()}, 0,
                            lane, [&](int k, int row) {
                              kept[k] = rows[row];
                              rows[row] = Six<double>::zero();
                            });
  }
  static Index stride(const MatrixX<double>& A) { return (A.rows() + 7) / 8 * 8; }
  [[nodiscard]] Reflections<const double> reflections(const MatrixX<double>& A) const {
    return {v.data(), stride(A), beta.data(), pivot.data()};
  }
};

TEST(Householder, PivotsAreExactWhereNormsAre) {
  MatrixX<double> A(4, 2);
  A << 0, 2, 0, 2, 4, 0, 0, 1;
  const Reduction r(A, 2);
  ASSERT_EQ(r.reduced, 2);
  EXPECT_EQ(r.lane[0], 0);  // the longer column first
  EXPECT_EQ(r.pivot[0], 2);  // its largest entry
  EXPECT_EQ(r.kept[0][0], -4);
  EXPECT_EQ(r.kept[0][1], 0);
  EXPECT_EQ(r.pivot[1], 0);
  EXPECT_EQ(r.kept[1][1], -3);
}

TEST(Householder, StopsAtAColumnWithoutSupport) {
  MatrixX<double> A = MatrixX<double>::Zero(5, 3);
  A.col(1) << 1, 2, 3, 4, 5;
  const Reduction r(A, 3);
  EXPECT_EQ(r.reduced, 1);
  EXPECT_EQ(r.lane[0], 1);
  A(2, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LT(Reduction(A, 3).reduced, 3);
}

// A = Q (R; 0), each row to an accuracy of its own size, whatever the sizes of the others.
TEST(Householder, EveryRowKeepsItsOwnAccuracy) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int draw = 0; draw < 50; ++draw) {
    MatrixX<double> A(11, 4);
    for (Index r = 0; r < 11; ++r)
      for (Index c = 0; c < 4; ++c) A(r, c) = number(engine) * (r % 3 == 2 ? 0x1p40 : r % 3 == 1 ? 0x1p10 : 1);
    const Reduction reduction(A, 4);
    ASSERT_EQ(reduction.reduced, 4);
    MatrixX<Quad> error(11, 4), bound(11, 4);
    for (int c = 0; c < 4; ++c) {
      alignas(64) double x[16] = {};
      const auto column = reduction.lane[c];
      for (int k = 0; k <= c; ++k) x[reduction.pivot[k]] = reduction.kept[k][column];
      reduction.reflections(A).apply_transposed(x, 4, 11);
      for (Index r = 0; r < 11; ++r) {
        error(r, c) = Quad(x[r]) - Quad(A(r, column));
        bound(r, c) = Quad(A.row(r).cwiseAbs().maxCoeff()) * Quad(4);
      }
    }
    const auto verdict = judge(error, bound, unit_roundoff<double>, "4 · largest entry of the row");
    EXPECT_TRUE(verdict.passed()) << verdict.ratio << " in row " << verdict.row;
  }
}

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

TEST(WeightRoot, IsARootAndNamesTheRowItDoesNotExistIn) {
  const auto built = generators::build(generators::find_family("block_damping").make(6, 1));
  const Structure& s = *built.problem.structure;
  WeightRoot<double> root;
  root.analyze(s);
  ASSERT_TRUE(root.assign(built.damping).ok());
  const MatrixX<double> x = random_columns(s.rows, 3);
  MatrixX<double> y = x, z = x;
  root.multiply(x.data(), y.data());
  root.multiply_transposed(y.data(), z.data());  // z = R x
  const MatrixX<Quad> R_inverse = reference::damping_matrix<Quad>(s, built.damping.cast<Quad>());
  const MatrixX<Quad> error = R_inverse * z.cast<Quad>() - x.cast<Quad>();
  const Quad bound = Quad(static_cast<double>(s.rows)) * norm(R_inverse) * largest(z.cast<Quad>());
  EXPECT_TRUE(judge(error, MatrixX<Quad>::Constant(s.rows, 1, bound), unit_roundoff<double>, "m ‖R⁻¹‖ ‖z‖").passed());

  Damping<double> damping = built.damping;
  ASSERT_FALSE(damping.blocks.empty());
  damping.blocks[0].R_inverse.setZero();
  const Report report = root.assign(damping);
  EXPECT_EQ(report.status, Status::zero_damping);
  EXPECT_EQ(report.where, damping.blocks[0].row);
}

}  // namespace
}  // namespace delassus
