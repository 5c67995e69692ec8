// Declared orders of the operators that form a matrix row by row, by counted operations: exact polynomials in the sizes of one
// mechanism, whose differences are zero or not. A broom: a trunk of `trunk` joints, `arms` chains of `arm` joints on its end, one
// row on each tip and one on the root. d = trunk + arm, m = arms + 1, n = trunk + arms · arm.
#include <gtest/gtest.h>

#include <functional>

#include "algorithms/kit/ldlt.h"
#include "algorithms/kit/test_scalars.h"
#include "algorithms/operators/operators.h"

namespace delassus::explicit_orders_test {
namespace {

Problem<Counted> broom(Index trunk, Index arm, Index arms) {
  const auto s = std::make_shared<Structure>();
  Index end = ground;
  for (Index k = 0; k < trunk; ++k) end = s->add_body(end, 1);
  s->add_link_constraint(1, {0});
  for (Index a = 0; a < arms; ++a) {
    Index tip = end;
    for (Index k = 0; k < arm; ++k) tip = s->add_body(tip, 1);
    s->add_link_constraint(1, {tip});
  }
  Problem<Counted> p(s);
  for (auto& S : p.S) S.setConstant(Counted(0.5));
  for (auto& H : p.H) H = Matrix6<Counted>::Identity();
  for (auto& K : p.K) K.setConstant(Counted(0.25));
  return p;
}

struct Work {
  std::int64_t form, new_damping, apply, solve;  // form: update without the factor of A, where there is one
};

Work work(const OperatorRow& row, Index trunk, Index arm, Index arms) {
  const Problem<Counted> p = broom(trunk, arm, arms);
  const Index m = p.structure->rows;
  const auto damping = Damping<Counted>::uniform(m, Counted(1));
  const auto counted = [](auto&& call) {
    const std::int64_t before = operation_count.total();
    call();
    return operation_count.total() - before;
  };
  const auto op = row.make<Counted>();
  op->analyze(p.structure);
  Workspace<Counted> workspace(op->workspace(1));
  const MatrixX<Counted> x = MatrixX<Counted>::Constant(m, 1, Counted(1));
  MatrixX<Counted> y = x, I = MatrixX<Counted>::Identity(m, m);
  Work all{};
  all.form = counted([&] { EXPECT_TRUE(op->update(p, damping).ok()); });
  if (row.solve_error == ErrorClass::normwise) all.form -= counted([&] { EXPECT_LT(ldlt_factor(I.data(), m, m), 0); });
  all.new_damping = counted([&] { EXPECT_TRUE(op->update_damping(damping).ok()); });
  if (row.applies) all.apply = counted([&] { EXPECT_TRUE(op->apply(x, y, workspace).ok()); });
  all.solve = counted([&] { EXPECT_TRUE(op->solve(x, y, workspace).ok()); });
  return all;
}

using Phase = std::int64_t Work::*;

/// Differences of the given orders in trunk, arm and arms: 0 exactly where the count holds no such product.
std::int64_t difference(const OperatorRow& row, Phase phase, int in_trunk, int in_arm, int in_arms, Index trunk = 9, Index arm = 5, Index arms = 16) {
  if (in_trunk > 0) return difference(row, phase, in_trunk - 1, in_arm, in_arms, trunk + 2, arm, arms) - difference(row, phase, in_trunk - 1, in_arm, in_arms, trunk, arm, arms);
  if (in_arm > 0) return difference(row, phase, 0, in_arm - 1, in_arms, trunk, arm + 2, arms) - difference(row, phase, 0, in_arm - 1, in_arms, trunk, arm, arms);
  if (in_arms > 0) return difference(row, phase, 0, 0, in_arms - 1, trunk, arm, arms + 2) - difference(row, phase, 0, 0, in_arms - 1, trunk, arm, arms);
  return work(row, trunk, arm, arms).*phase;
}

struct Declared {
  const char* op;
  bool trunk_m, trunk_m2, arm_m2;  // products with the trunk's and the arms' length that the update holds
};

class Orders : public testing::TestWithParam<Declared> {};

TEST_P(Orders, AreThoseDeclared) {
  const Declared& is = GetParam();
  const OperatorRow& row = find_operator(is.op);
  const Phase form = &Work::form;
  EXPECT_GT(difference(row, form, 1, 0, 0), 0);
  EXPECT_EQ(difference(row, form, 2, 0, 0), 0) << "linear in the trunk";
  EXPECT_EQ(difference(row, form, 0, 2, 0), 0) << "linear in the arms' length";
  EXPECT_EQ(difference(row, form, 0, 0, 3), 0) << "quadratic in the rows";
  EXPECT_GT(difference(row, form, 0, 0, 2), 0);
  EXPECT_EQ(difference(row, form, 1, 0, 1) != 0, is.trunk_m || is.trunk_m2) << "trunk · m";
  EXPECT_EQ(difference(row, form, 1, 0, 2) != 0, is.trunk_m2) << "trunk · m²";
  EXPECT_EQ(difference(row, form, 0, 1, 2) != 0, is.arm_m2) << "arm · m²";
  for (const Phase phase : {&Work::apply, &Work::solve}) {
    EXPECT_EQ(difference(row, phase, 1, 0, 0), 0);
    EXPECT_EQ(difference(row, phase, 0, 1, 0), 0);
    EXPECT_EQ(difference(row, phase, 0, 0, 3), 0) << "quadratic in the rows";
  }
}

// O(m²d): the trunk passes all rows. KJR: every pair of arms, from end to end. EFP: every row through every arm.
INSTANTIATE_TEST_SUITE_P(Explicit, Orders,
                         testing::Values(Declared{"pv_osim", true, true, false}, Declared{"pv_osimr", false, false, false},
                                         Declared{"kjr", true, false, true}, Declared{"efp", true, false, true},
                                         Declared{"efpa", true, false, false}, Declared{"caba_osim", true, true, false},
                                         Declared{"caba_osimr", false, false, false}, Declared{"maximal_direct", true, false, true}),
                         [](const auto& of) { return std::string(of.param.op); });

}  // namespace
}  // namespace delassus::explicit_orders_test
