// Which rung's answer and report the ladder gives.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <set>
#include <thread>

#include "algorithms/operators/ladder.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/laws/verdict.h"

namespace delassus::rungs_test {
namespace {

struct Said {
  Report updated, report;
  MatrixX<double> f;
  std::vector<Index> dependent = {};
};

Said asked(std::string_view name, const Problem<double>& p, const Damping<double>& d, const MatrixX<double>& a, Accuracy wanted) {
  const auto op = find_operator(name).make<double>();
  op->analyze(p.structure);
  Said said{op->update(p, d), {}, MatrixX<double>::Constant(a.rows(), 1, 0.75)};
  Workspace<double> w(op->workspace());
  said.report = op->solve(a, said.f, wanted, w);
  said.dependent = op->dependent_rows();
  return said;
}

/// A body of two freedoms, as far apart as `angle` says, with rows of two entries.
Problem<double> sliding(double angle, const std::vector<std::array<double, 2>>& K) {
  Structure s;
  s.add_body(ground, 2);
  for (std::size_t r = 0; r < K.size(); r += 7) s.add_link_constraint(static_cast<Index>(std::min<std::size_t>(7, K.size() - r)), {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.H[0].diagonal().setOnes();
  p.S[0][0] = p.S[1][0] = 1;
  p.S[1][1] = angle;
  for (std::size_t r = 0; r < K.size(); ++r) p.K[r].head<2>() << K[r][0], K[r][1];
  return p;
}

TEST(Rungs, AContradictionWinsOverAnIterate) {
  const Problem<double> p = sliding(1, {{1, 0}, {1, 0}});
  const auto hard = Damping<double>::uniform(2, 0);
  MatrixX<double> a(2, 1);
  a << 1, 2;  // no force does that
  const Said ladder = asked("ladder", p, hard, a, Accuracy::full()), dense = asked("kkt_elimination", p, hard, a, Accuracy::full());
  EXPECT_EQ(asked("proximal", p, hard, a, Accuracy::full()).report.status, Status::not_converged);
  for (const Said& said : {ladder, dense, asked("ladder", p, hard, a, {0.5})}) {
    EXPECT_EQ(said.report.status, Status::inconsistent);
    EXPECT_EQ(said.report.where, dense.report.where);
    EXPECT_EQ(said.dependent, dense.dependent);
    EXPECT_TRUE(said.f.array().isNaN().all());
  }
  EXPECT_EQ(dense.dependent.size(), 1U);
}

TEST(Rungs, ManyHardRowsAreIteratedWithoutABound) {
  const Index m = Ladder<double>::first_dense_rows + 1;
  const std::vector<std::array<double, 2>> K(static_cast<std::size_t>(m), {1, 0});
  const Problem<double> p = sliding(1, K);
  const auto hard = Damping<double>::uniform(m, 0);
  MatrixX<double> a = MatrixX<double>::Ones(m, 1);
  const Said many = asked("ladder", p, hard, a, Accuracy::full());
  EXPECT_TRUE(many.report.ok());
  EXPECT_EQ(many.report.rung, "proximal");
  EXPECT_LT(many.report.error_bound, 0);
  EXPECT_EQ(many.dependent.size(), static_cast<std::size_t>(m - 1)) << "factored when asked for";
  a(7, 0) = 2;
  EXPECT_EQ(asked("ladder", p, hard, a, Accuracy::full()).report.status, Status::inconsistent) << "of a later rung";
  EXPECT_EQ(asked("ladder", p, hard, a, {0.1}).report.status, Status::inconsistent) << "1/k after k steps is no accuracy";
}

TEST(Rungs, WithoutABoundTheLastCorrectionReachesAnAccuracy) {
  const Problem<double> p = sliding(1, {{1, 0}, {1, 0x1p-9}});
  const auto hard = Damping<double>::uniform(2, 0);
  MatrixX<double> a(2, 1);
  a << 1, -1;
  const Said loose = asked("proximal", p, hard, a, {1e-3}), full = asked("proximal", p, hard, a, Accuracy::full());
  EXPECT_TRUE(loose.report.ok() && full.report.ok());
  EXPECT_LT(loose.report.error_bound, 0);
  EXPECT_LE(loose.report.error_estimate, 1e-3);
  EXPECT_LT(loose.report.iterations, full.report.iterations);
  EXPECT_LE((loose.f - full.f).norm(), 1e-3 * full.f.norm());
  const Said dense = asked("ladder", p, hard, a, {1e-3});
  EXPECT_TRUE(dense.report.ok() && dense.report.error_bound >= 0 && dense.report.error_bound <= 1e-3);
}

TEST(Rungs, OfAnswersThatAreNotGoodEnoughTheFirstWithTheSmallestBoundIsKept) {
  std::set<std::string_view> kept;
  for (const char* family : {"redundant", "humanoid", "mixed_damping"})
    for (const double damping : {1.0, 1e-4, 1e-10, 1e-14}) {
      const auto built = generators::build(generators::find_family(family).make(6, 1));
      const auto d = Damping<double>::uniform(built.problem.structure->rows, damping);
      const MatrixX<double> a = MatrixX<double>::Ones(built.problem.structure->rows, 1);
      Said best;
      std::string_view rung;
      int steps = 0, until_best = 0;
      for (const char* name : {"lcaba_refined", "lcaba_qr", "proximal", "kkt_elimination"}) {
        const Said said = asked(name, built.problem, d, a, {1e-20});
        steps += said.report.iterations;
        if (said.report.status != Status::not_converged || (!rung.empty() && !(said.report.error_bound < best.report.error_bound))) continue;
        best = said;
        until_best = steps;
        rung = name;
      }
      const Said ladder = asked("ladder", built.problem, d, a, {1e-20});
      EXPECT_EQ(ladder.report.status, Status::not_converged);
      EXPECT_EQ(ladder.report.rung, rung) << family << ' ' << damping;
      EXPECT_EQ(ladder.report.iterations, until_best) << family << ' ' << damping;
      EXPECT_EQ(ladder.report.error_bound, best.report.error_bound) << family << ' ' << damping;
      EXPECT_TRUE(laws::judge_bits(ladder.f, best.f).passed()) << family << ' ' << damping;
      kept.insert(rung);
    }
  EXPECT_GE(kept.size(), 2U);
}

TEST(Rungs, WhatAnAnswerCostIsReported) {
  const Problem<double> p = sliding(1, {{1, 0}, {0.5, 1}});
  const MatrixX<double> a = MatrixX<double>::Ones(2, 1);
  const Report soft = asked("ladder", p, Damping<double>::uniform(2, 1), a, Accuracy::full()).report;
  EXPECT_TRUE(soft.ok() && soft.rungs_tried == 1);
  const auto hard = Damping<double>::uniform(2, 0);
  const Report dense = asked("ladder", p, hard, a, Accuracy::full()).report;
  EXPECT_EQ(dense.rung, "kkt_elimination");
  EXPECT_EQ(dense.rungs_tried, 1);
  EXPECT_EQ(dense.iterations, asked("kkt_elimination", p, hard, a, Accuracy::full()).report.iterations);
  EXPECT_GT(dense.iterations, 0);
}

TEST(Rungs, NoneIsAskedWhenTheStepsAreUsedUp) {
  int later_better = 0;
  for (const char* family : {"redundant", "humanoid", "mixed_damping"})
    for (const double damping : {1e-8, 1e-10, 1e-12, 1e-14}) {
      const auto built = generators::build(generators::find_family(family).make(6, 1));
      const Index m = built.problem.structure->rows;
      const auto ask = [&](std::string_view name) {
        return asked(name, built.problem, Damping<double>::uniform(m, damping), MatrixX<double>::Ones(m, 1), {1e-20, 0}).report;
      };
      const Report ladder = ask("ladder"), first = ask("lcaba_refined");
      EXPECT_EQ(ladder.error_bound, first.error_bound) << family << ' ' << damping;
      EXPECT_EQ(ladder.rungs_tried, 1) << family << ' ' << damping;
      later_better += ask("lcaba_qr").error_bound < first.error_bound;
    }
  EXPECT_GT(later_better, 0);
}

TEST(Rungs, ThreadsThatClimbAtOnceGetTheSameAnswer) {
  const auto built = generators::build(generators::find_family("redundant").make(6, 1));
  const Index m = built.problem.structure->rows;
  const auto soft = Damping<double>::uniform(m, 1e-10);  // update is content with the first rung, and solve with none
  const MatrixX<double> a = MatrixX<double>::Ones(m, 1);
  const Said expected = asked("ladder", built.problem, soft, a, {1e-20});
  EXPECT_EQ(expected.report.status, Status::not_converged);
  EXPECT_NE(expected.report.rung, "lcaba_refined");
  const auto op = find_operator("ladder").make<double>();
  op->analyze(built.problem.structure);
  for (int round = 0; round < 10; ++round) {
    EXPECT_TRUE(op->update(built.problem, soft).ok());
    std::atomic<int> ready = 0, wrong = 0;
    const auto ask = [&] {
      Workspace<double> w(op->workspace());
      MatrixX<double> f(m, 1);
      for (++ready; ready < 2;) std::this_thread::yield();
      for (int k = 0; k < 10; ++k) wrong += op->solve(a, f, {1e-20}, w).error_bound != expected.report.error_bound || !laws::judge_bits(f, expected.f).passed();
    };
    std::thread other(ask);
    ask();
    other.join();
    EXPECT_EQ(wrong, 0);
  }
}

TEST(Rungs, TheDenseOneTakesSoManyRows) {
  const auto bytes = [](Index rows) {
    const Problem<double> p = sliding(1, std::vector<std::array<double, 2>>(static_cast<std::size_t>(rows), {1, 0}));
    const auto op = find_operator("ladder").make<double>();
    op->analyze(p.structure);
    EXPECT_TRUE(op->update(p, Damping<double>::uniform(rows, 1)).ok());
    Workspace<double> w(op->workspace());
    MatrixX<double> f(rows, 1);
    EXPECT_EQ(op->solve(MatrixX<double>::Ones(rows, 1), f, {1e-20}, w).status, Status::not_converged) << "all rungs are asked";
    return op->bytes();
  };
  EXPECT_GT(bytes(Ladder<double>::max_dense_rows), 2 * bytes(Ladder<double>::max_dense_rows + 1));
}

TEST(Rungs, AnUpdateIsWhatTheFirstUsableRungSays) {
  const Problem<double> p = sliding(0x1p-25, {{1, 0}});  // a pivot of 2⁻⁵⁰: positive, and below 30 eps
  const auto soft = Damping<double>::uniform(1, 1);
  const MatrixX<double> a = MatrixX<double>::Ones(1, 1);
  EXPECT_EQ(asked("lcaba_qr", p, soft, a, Accuracy::full()).updated.status, Status::lost_pivot);
  EXPECT_TRUE(asked("ladder", p, soft, a, Accuracy::full()).updated.ok());
}

TEST(Rungs, AnUpdateNamesTheRowThatNoRungCanDoWithout) {
  const Index m = Ladder<double>::max_dense_rows + 1;  // the dense one could
  std::vector<std::array<double, 2>> K(static_cast<std::size_t>(m), {1, 0});
  K[5] = {0, 0};
  const Report updated = asked("ladder", sliding(1, K), Damping<double>::uniform(m, 0), MatrixX<double>::Ones(m, 1), Accuracy::full()).updated;
  EXPECT_EQ(updated.status, Status::zero_damping);
  EXPECT_EQ(updated.where, 5);
}

}  // namespace
}  // namespace delassus::rungs_test
