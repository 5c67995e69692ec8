// The ladder of accuracies: no more work than asked for, a certificate that reaches what was asked, and never a silently
// worse answer.
#include <gtest/gtest.h>

#include <limits>

#include "algorithms/delassus.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::ladder_test {
namespace {

struct Solver {
  explicit Solver(std::string_view family, double damping = -1, std::string_view op_name = "ladder")
      : built(generators::build(generators::find_family(family).make(12, 1))), op(find_operator(op_name).make<double>()) {
    if (damping >= 0) built.damping = Damping<double>::uniform(built.problem.structure->rows, damping);
    op->analyze(built.problem.structure);
    updated = op->update(built.problem, built.damping);
    a = MatrixX<double>::Ones(built.problem.structure->rows, 1);
    f = MatrixX<double>::Zero(a.rows(), 1);
  }
  Report solve(Accuracy wanted) {
    Workspace<double> w(op->workspace());
    return op->solve(a, f, wanted, w);
  }
  /// a = A f of a force, so that hard dependent rows agree.
  void make_consistent() {
    const auto apply = find_operator("aba_sweep").make<double>();
    apply->analyze(built.problem.structure);
    static_cast<void>(apply->update(built.problem, built.damping));
    Workspace<double> w(apply->workspace());
    const MatrixX<double> force = a;
    ASSERT_TRUE(apply->apply(force, a, w).ok());
  }

  generators::Built built;
  std::unique_ptr<Operator<double>> op;
  Report updated;
  MatrixX<double> a, f;
};

TEST(Ladder, FastestTakesOneEvaluationAndGivesNoCertificate) {
  Solver s("humanoid", 1e-4);
  const Report r = s.solve(Accuracy::fastest());
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.rung, "lcaba_refined");
  EXPECT_EQ(r.iterations, 0);
  EXPECT_LT(r.error_bound, 0);
}

TEST(Ladder, PaysOnlyForWhatIsAsked) {
  Solver s("humanoid", 1e-4);
  const Report loose = s.solve({1e-3}), full = s.solve(Accuracy::full());
  EXPECT_EQ(loose.iterations, 0);
  EXPECT_GE(loose.error_bound, 0);
  EXPECT_LE(loose.error_bound, 1e-3);
  EXPECT_GE(full.iterations, 1);
  EXPECT_LE(full.error_bound, loose.error_bound);
}

/// Operations of update and one solve.
std::int64_t operations(std::string_view op_name, Accuracy wanted, std::string_view family = "humanoid", double R_inverse = 1e-4) {
  const generators::Built built = generators::build(generators::find_family(family).make(12, 1));
  const Index m = built.problem.structure->rows;
  const Problem<Counted> problem = built.problem.cast<Counted>();
  const Damping<Counted> damping = Damping<double>::uniform(m, R_inverse).cast<Counted>();
  const auto op = find_operator(op_name).make<Counted>();
  op->analyze(problem.structure);
  Workspace<Counted> w(op->workspace());
  const MatrixX<Counted> a = MatrixX<Counted>::Constant(m, 1, Counted(1));
  MatrixX<Counted> f = a;
  const std::int64_t before = operation_count.total();
  EXPECT_TRUE(op->update(problem, damping).ok());
  EXPECT_TRUE(op->solve(a, f, wanted, w).ok());
  return operation_count.total() - before;
}

TEST(Ladder, WhatIsNotAskedIsNotComputed) {
  const auto lcaba = operations("lcaba", Accuracy::full()), fastest = operations("ladder", Accuracy::fastest());
  const auto loose = operations("ladder", {1e-3}), full = operations("ladder", Accuracy::full());
  EXPECT_LT(10 * fastest, 11 * lcaba) << "no factor of M, no residual";
  EXPECT_LT(fastest, loose);
  EXPECT_LT(loose, full);
}

// Hard rows are answered by kkt_elimination: nothing is factored, and no number is taken, for who has no answer to them.
TEST(Ladder, HardRowsPayForTheirRungAlone) {
  for (const Accuracy wanted : {Accuracy::fastest(), Accuracy{1e-3}})
    EXPECT_EQ(operations("ladder", wanted, "chain", 0), operations("kkt_elimination", wanted, "chain", 0)) << wanted.error;
  EXPECT_LT(operations("ladder", Accuracy::fastest(), "chain", 0), operations("ladder", {1e-3}, "chain", 0)) << "no residual";
}

// Who kept the numbers of hard rows hands them on when the damping softens them, and the other way round.
TEST(Ladder, NumbersGoFromRungToRung) {
  Solver s("chain", 0), soft("chain", 1e-4);
  ASSERT_TRUE(s.op->update_damping(soft.built.damping).ok());
  EXPECT_EQ(s.solve(Accuracy::full()).rung, "lcaba_refined");
  ASSERT_TRUE(soft.solve(Accuracy::full()).ok());
  EXPECT_EQ(s.f, soft.f);
  Solver hard("chain", 0);
  ASSERT_TRUE(soft.op->update_damping(hard.built.damping).ok());
  EXPECT_EQ(soft.solve(Accuracy::full()).rung, "kkt_elimination");
  ASSERT_TRUE(hard.solve(Accuracy::full()).ok());
  EXPECT_EQ(soft.f, hard.f);
}

TEST(Ladder, WhatNobodyClimbsToHoldsNoMemory) {
  for (const auto family : {"humanoid", "redundant"}) {
    Solver s(family, 1e-4), first(family, 1e-4, "lcaba_refined"), dense(family, 1e-4, "kkt_elimination");
    const auto m = static_cast<Index>(s.a.rows());
    EXPECT_LE(s.op->bytes(), first.op->bytes() + static_cast<Index>(sizeof(double)) * (2 * m + 36)) << family;
    EXPECT_LE(s.op->workspace(), first.op->workspace() + m + 8) << family;
    ASSERT_TRUE(s.solve({1e-3}).ok());
    EXPECT_LT(s.op->bytes(), first.op->bytes() + dense.op->bytes()) << family;
    EXPECT_EQ(s.solve({1e-20}).status, Status::not_converged) << "all rungs";
    EXPECT_GE(s.op->bytes(), first.op->bytes() + dense.op->bytes()) << family;
  }
}

TEST(Ladder, ACertifiedAnswerReachesEveryTargetItClaims) {
  for (const double damping : {1e-2, 1e-6, 1e-10, 1e-14})
    for (const double target : {1e-2, 1e-6, 1e-10}) {
      Solver s("redundant", damping);
      const Report r = s.solve({target});
      if (r.ok()) {
        EXPECT_GE(r.error_bound, 0) << damping;
        EXPECT_LE(r.error_bound, target) << damping;
      } else {
        EXPECT_EQ(r.status, Status::not_converged);
        EXPECT_GT(r.error_bound, target) << damping;
      }
    }
}

TEST(Ladder, ATargetBelowRoundingIsNotClaimed) {
  Solver s("humanoid", 1e-4);
  const Report r = s.solve({1e-20});
  EXPECT_EQ(r.status, Status::not_converged);
  EXPECT_GT(r.error_bound, 1e-20);
  EXPECT_TRUE(s.f.allFinite());
}

TEST(Ladder, ClimbsWhereTheFirstRungFails) {
  Solver first("redundant", 1e-15, "lcaba_refined"), s("redundant", 1e-15);
  const Report alone = first.solve(Accuracy::full()), r = s.solve(Accuracy::full());
  EXPECT_TRUE(r.ok()) << name(r.status);
  if (!alone.ok()) {
    EXPECT_NE(r.rung, "lcaba_refined");
  }
}

TEST(Ladder, HardRowsAreSolvedOrRefusedByName) {
  Solver s("hard");
  EXPECT_TRUE(s.updated.ok());
  const Report r = s.solve(Accuracy::full());
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.rung, "kkt_elimination");
  EXPECT_GE(r.error_bound, 0);
  EXPECT_LT(r.error_bound, 1e-14);
}

TEST(KktElimination, NamesDependentRowsAndRefusesWhatTheyContradict) {
  Solver s("hard_redundant", -1, "kkt_elimination");
  EXPECT_FALSE(s.op->dependent_rows().empty());
  const Report contradicted = s.solve(Accuracy::full());
  EXPECT_EQ(contradicted.status, Status::inconsistent);
  EXPECT_TRUE(std::isnan(s.f(0, 0)));
  s.make_consistent();
  EXPECT_TRUE(s.solve(Accuracy::full()).ok());
  for (const Index r : s.op->dependent_rows()) EXPECT_EQ(s.f(r, 0), 0);
}

TEST(Ladder, MisuseAndNaN) {
  Solver s("humanoid", 1e-4);
  EXPECT_THROW(s.solve({-1}), std::logic_error);
  EXPECT_THROW(s.solve({std::numeric_limits<double>::quiet_NaN()}), std::logic_error);
  s.a(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(s.solve(Accuracy::full()).status, Status::not_finite);
}

}  // namespace
}  // namespace delassus::ladder_test
