// J, Jᵀ, M, M⁻¹ as functions, and chosen blocks of J M⁻¹Jᵀ: equal to the matrices, over the rational numbers and modulo a prime.
#include "algorithms/dynamics/tree_operators.h"

#include <gtest/gtest.h>

#include "algorithms/dynamics/delassus_blocks.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::tree_operators_test {
namespace {

template <class T> class ExactTrees : public testing::Test {};
using ExactScalars = testing::Types<Rational, PrimeField>;
TYPED_TEST_SUITE(ExactTrees, ExactScalars);

template <class T> Problem<T> problem(const char* family) {
  return generators::build(generators::find_family(family).make(generators::find_family(family).exact_size, 3)).problem.template cast<T>();
}
// Loops within a tree and between trees, rows of several bodies and rows on joints, massless links, joints of 0 to 6 freedoms.
constexpr const char* mechanisms[] = {"generic", "random_tree", "comb", "humanoid", "several_trees", "massless", "joint_friction", "no_rows", "no_bodies"};

template <class T> MatrixX<T> identity(Index n) { return MatrixX<T>::Identity(n, n); }

TYPED_TEST(ExactTrees, functions_are_the_matrices) {
  using T = TypeParam;
  for (const char* family : mechanisms) {
    const Problem<T> p = problem<T>(family);
    const Index n = p.structure->dofs(), m = p.structure->rows;
    const MatrixX<T> M = unit::mass_matrix(p), J = unit::constraint_jacobian(p);
    TreeOperators<T> of(p.structure);
    ASSERT_TRUE(of.update(p).ok()) << family;
    MatrixX<T> j(m, n), jt(n, m), mass(n, n), inverse(n, n);
    of.J(identity<T>(n), j);
    of.J_transposed(identity<T>(m), jt);
    of.M(identity<T>(n), mass);
    ASSERT_TRUE(of.M_inverse(identity<T>(n), inverse).ok()) << family;
    EXPECT_TRUE(j == J) << family;
    EXPECT_TRUE(jt == J.transpose()) << family;
    EXPECT_TRUE(mass == M) << family;
    EXPECT_TRUE(MatrixX<T>(M * inverse) == identity<T>(n)) << family;
  }
}

TYPED_TEST(ExactTrees, blocks_are_those_of_the_matrix) {
  using T = TypeParam;
  for (const char* family : mechanisms) {
    const Problem<T> p = problem<T>(family);
    const Structure& s = *p.structure;
    TreeOperators<T> of(p.structure);
    ASSERT_TRUE(of.update(p).ok()) << family;
    const MatrixX<T> J = unit::constraint_jacobian(p), Jt = J.transpose();
    MatrixX<T> motion(s.dofs(), s.rows);
    ASSERT_TRUE(of.M_inverse(Jt, motion).ok());
    const MatrixX<T> A0 = J * motion;
    DelassusBlocks<T> blocks(p.structure);
    ASSERT_TRUE(blocks.update(p).ok()) << family;
    VectorX<T> d;
    ASSERT_TRUE(blocks.diagonal(d).ok());
    EXPECT_TRUE(d == A0.diagonal()) << family;
    std::vector<std::pair<Index, Index>> constraints;  // row, rows
    for (const auto& e : s.link_constraints) constraints.emplace_back(e.row, e.rows);
    for (const auto& e : s.joint_constraints) constraints.emplace_back(e.row, e.rows);
    MatrixX<T> block;
    for (std::size_t e = 0; e < constraints.size(); ++e)
      for (std::size_t f = 0; f < constraints.size(); ++f) {
        ASSERT_TRUE(blocks.block(static_cast<Index>(e), static_cast<Index>(f), block).ok());
        EXPECT_TRUE(block == A0.block(constraints[e].first, constraints[f].first, constraints[e].second, constraints[f].second)) << family << " " << e << " " << f;
      }
  }
}

/// A massless body at the end of two free joints: M is singular.
Problem<double> massless() {
  auto s = std::make_shared<Structure>();
  s->add_body(s->add_body(ground, 1), 2);
  s->add_link_constraint(1, {1});
  Problem<double> p(s);
  p.H[0].setIdentity();
  p.S[0][0] = p.S[1][1] = p.S[2][2] = p.K[0][1] = 1;
  return p;
}

TEST(TreeOperators, a_singular_M_is_said_and_not_answered) {
  const Problem<double> p = massless();
  TreeOperators<double> of(p.structure);
  DelassusBlocks<double> blocks(p.structure);
  for (const Report& report : {of.update(p), blocks.update(p)}) {
    EXPECT_EQ(report.status, Status::lost_pivot);
    EXPECT_EQ(report.where, 1);
  }
  MatrixX<double> x = MatrixX<double>::Ones(3, 1), y(3, 1), row(1, 1), block;
  VectorX<double> d;
  EXPECT_EQ(of.M_inverse(x, y).status, Status::lost_pivot);
  EXPECT_TRUE(y.array().isNaN().all());
  EXPECT_EQ(blocks.diagonal(d).status, Status::lost_pivot);
  EXPECT_TRUE(d.array().isNaN().all());
  EXPECT_EQ(blocks.block(0, 0, block).status, Status::lost_pivot);
  EXPECT_TRUE(block.array().isNaN().all());
  of.J(x, row);
  EXPECT_EQ(row(0, 0), 1);
  of.M(x, y);
  EXPECT_EQ(y, (MatrixX<double>(3, 1) << 1, 0, 0).finished());
}

TEST(TreeOperators, misuse_is_refused) {
  const Problem<double> p = massless();
  TreeOperators<double> of(p.structure);
  DelassusBlocks<double> blocks(p.structure);
  MatrixX<double> three = MatrixX<double>::Ones(3, 1), four(4, 1), two(3, 2), row(1, 1);
  VectorX<double> d;
  EXPECT_THROW(of.J(three, row), std::logic_error) << "before update";
  EXPECT_THROW((void)blocks.diagonal(d), std::logic_error) << "before update";
  (void)of.update(p);
  (void)blocks.update(p);
  EXPECT_THROW(of.J(four, row), std::logic_error);
  EXPECT_THROW(of.J_transposed(row, four), std::logic_error);
  EXPECT_THROW(of.M(three, two), std::logic_error);
  EXPECT_THROW((void)blocks.block(0, 1, row), std::logic_error);
  EXPECT_THROW((void)blocks.block(-1, 0, row), std::logic_error);
  EXPECT_THROW((void)of.update(massless()), std::logic_error) << "another structure";
}

}  // namespace
}  // namespace delassus::tree_operators_test
