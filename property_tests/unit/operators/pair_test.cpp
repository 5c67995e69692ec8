// solve_kkt as a user meets it: every operator that solves has it, it begins where it is told, it refuses misuse; and rows that
// come and go within the capacity of a structure.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws.h"
#include "property_tests/laws/route.h"
#include "reference/definition.h"

namespace delassus::laws::pair_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

template <class T> void expect_pairs(const OperatorRow& row) {
  if (!row.solves || std::get<Maker<T>>(row.makers) == nullptr) return;
  const Case c = make_case("generic", 4, 1);
  const auto [p, d] = numbers<T>(c);
  Route<T> route(row, p, d);
  const Index n = p.structure->dofs();
  const MatrixX<T> r1 = vectors<T>(n, 1, 1), r2 = vectors<T>(c.rows(), 1, 2);
  MatrixX<T> nu(n, 1), lambda(c.rows(), 1);
  Workspace<T> w(route.get().kkt_workspace());
  EXPECT_NE(route.get().solve_kkt(r1, r2, nu, lambda, Accuracy::full(), w).status, Status::not_supported) << row.name;
}

TEST(Pair, EveryOperatorThatSolvesHasIt) {
  for (const OperatorRow& row : operators()) {
    expect_pairs<double>(row);
    expect_pairs<float>(row);
    expect_pairs<Quad>(row);
    expect_pairs<Counted>(row);
    expect_pairs<Rational>(row);
    expect_pairs<PrimeField>(row);
  }
}

struct Asked {
  Case c = make_case("generic", 5, 2);
  Index n = c.problem.structure->dofs(), m = c.rows();
  MatrixX<double> r1 = vectors<double>(n, 1, 7), r2 = vectors<double>(m, 1, 8), nu{n, 1}, lambda{m, 1};
  Route<double> route;
  Workspace<double> w;
  explicit Asked(const OperatorRow& row) : route(row, c.problem, c.damping), w(route.get().kkt_workspace()) {}
  Report ask(Accuracy wanted, Start start) { return route.get().solve_kkt(r1, r2, nu, lambda, wanted, w, start); }
};

TEST(Pair, GoodEnoughComesBackAsItIs) {
  for (const OperatorRow& row : operators()) {
    if (row.solve_error != ErrorClass::refined || !row.solves) continue;
    Asked a(row);
    ASSERT_TRUE(a.ask(Accuracy::full(), Start::zero).ok()) << row.name;
    const MatrixX<double> nu = a.nu, lambda = a.lambda;
    const Report again = a.ask(Accuracy{1e-8}, Start::given);
    EXPECT_TRUE(again.ok()) << row.name;
    EXPECT_EQ(again.iterations, 0) << row.name;
    EXPECT_LE(again.error_bound, 1e-8) << row.name;
    EXPECT_TRUE(a.nu == nu && a.lambda == lambda) << row.name;
  }
}

/// √(‖δν‖²_M + ‖δλ‖²_{R⁻¹}) of a pair, relative to that of the solution: what Accuracy speaks of.
double error_in_energy(const Asked& a) {
  const reference::Dense<Quad> d = reference::dense(a.c.problem.cast<Quad>(), a.c.damping.cast<Quad>());
  const reference::PivotedLdlt<Quad> M(d.M);
  const MatrixX<Quad> r1 = converted<Quad>(a.r1), r2 = converted<Quad>(a.r2);
  const MatrixX<Quad> lambda = reference::dense_solve(d, MatrixX<Quad>(r2 - reference::product<Quad>(d.M_inv_Jt.transpose(), r1)));
  const MatrixX<Quad> nu = M.solve(MatrixX<Quad>(r1 + reference::product<Quad>(d.J.transpose(), lambda)));
  const auto square = [&](const MatrixX<Quad>& n, const MatrixX<Quad>& l) {
    return static_cast<double>((n.transpose() * d.M * n + l.transpose() * d.R_inverse * l)(0, 0));
  };
  return std::sqrt(square(converted<Quad>(a.nu) - nu, converted<Quad>(a.lambda) - lambda) / square(nu, lambda));
}

TEST(Pair, APoorStartIsMended) {
  for (const OperatorRow& row : operators()) {
    if (!row.solves) continue;
    Asked a(row);
    a.nu.setConstant(1);
    a.lambda.setConstant(-2);
    EXPECT_GT(error_in_energy(a), 0.1) << row.name;
    EXPECT_TRUE(a.ask(Accuracy{1e-8}, Start::given).ok()) << row.name;
    EXPECT_LE(error_in_energy(a), 1e-8) << row.name;
  }
}

TEST(Pair, MisuseIsRefused) {
  for (const OperatorRow& row : operators()) {
    if (!row.solves) continue;
    Asked a(row);
    Operator<double>& op = a.route.get();
    MatrixX<double> short_nu(a.n - 1, 1), two(a.m, 2);
    Workspace<double> none(0);
    EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, short_nu, a.lambda, Accuracy::full(), a.w)), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, a.nu, two, Accuracy::full(), a.w)), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, a.r1, a.lambda, Accuracy::full(), a.w)), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, a.nu, a.r2, Accuracy::full(), a.w)), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, a.nu, a.lambda, Accuracy{-1}, a.w)), std::logic_error) << row.name;
    if (op.kkt_workspace() > 0) {
      EXPECT_THROW(static_cast<void>(op.solve_kkt(a.r1, a.r2, a.nu, a.lambda, Accuracy::full(), none)), std::logic_error) << row.name;
    }
    const auto fresh = row.make<double>();
    EXPECT_THROW(static_cast<void>(fresh->kkt_workspace()), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(fresh->update_rows(a.c.problem, a.c.damping)), std::logic_error) << row.name;
    EXPECT_THROW(static_cast<void>(op.update_rows(make_case("generic", 4, 1).problem, a.c.damping)), std::logic_error) << row.name;
  }
}

TEST(Pair, NaNStays) {
  for (const OperatorRow& row : operators()) {
    if (!row.solves) continue;
    for (const bool in_r1 : {false, true}) {
      Asked a(row);
      (in_r1 ? a.r1 : a.r2)(0, 0) = std::numeric_limits<double>::quiet_NaN();
      EXPECT_EQ(a.ask(Accuracy::full(), Start::zero).status, Status::not_finite) << row.name;
      EXPECT_TRUE(a.nu.array().isNaN().all() && a.lambda.array().isNaN().all()) << row.name;
    }
  }
}

/// Rows come and go at random: the answer is that of the rows that are there, exactly, and absent ones carry nothing.
TEST(RowsThatComeAndGo, AreThoseOfTheStructureWithoutTheOthers) {
  const Case c = make_case("generic", 5, 2);
  for (const OperatorRow& row : operators()) {
    if (!row.solves) continue;
    Route<double> route(row, c.problem, c.damping);
    const MatrixX<double> a = vectors<double>(c.rows(), 1, 3);
    Workspace<double> w(route.get().workspace());
    generators::Random random(11);
    for (int turn = 0; turn < 8; ++turn) {
      Damping<double> d = c.damping;
      for (double& r : d.diagonal)
        if (random.coin()) r = inf;
      const Report updated = turn % 2 == 0 ? route.get().update_rows(c.problem, d) : route.get().update_damping(d);
      ASSERT_TRUE(updated.ok()) << row.name << ": " << name(updated.status);
      MatrixX<double> f(c.rows(), 1);
      ASSERT_TRUE(route.get().solve(a, f, w).ok()) << row.name;
      const MatrixX<double> fresh = Route<double>(row, c.problem, d).narrow(Function::solve, a);
      EXPECT_TRUE(judge_bits(f, fresh).passed()) << row.name;
      for (Index r = 0; r < c.rows(); ++r) EXPECT_TRUE(d.diagonal[static_cast<std::size_t>(r)] != inf || f(r, 0) == 0) << row.name;
    }
  }
}

TEST(RowsThatComeAndGo, AllMayBeAway) {
  const Case c = make_case("generic", 4, 1);
  for (const OperatorRow& row : operators()) {
    Route<double> route(row, c.problem, Damping<double>::uniform(c.rows(), inf));
    ASSERT_TRUE(route.updated().ok()) << row.name << ": " << name(route.updated().status);
    const MatrixX<double> x = vectors<double>(c.rows(), 1, 3);
    for (const Function f : {Function::apply, Function::solve}) {
      if (!(f == Function::apply ? row.applies : row.solves)) continue;
      EXPECT_TRUE((route.narrow(f, x).array() == 0).all()) << row.name;
    }
    EXPECT_TRUE(route.get().dependent_rows().empty()) << row.name;
  }
}

}  // namespace
}  // namespace delassus::laws::pair_test
