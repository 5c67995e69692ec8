// The choice between explicit and matrix-free: what it counts, what it may name, and that `auto` answers as the rows it names.
#include "algorithms/operators/choose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/factors/coupled_rows.h"
#include "algorithms/kit/columns.h"
#include "algorithms/operators/auto.h"
#include "algorithms/operators/operators.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::choose_test {
namespace {

generators::Built made(const char* family, Index n) { return generators::build(generators::find_family(family).make(n, 1)); }

double of(const Quantities& q, Quantities::Name name) { return q.of[name]; }

TEST(Choose, quantities_are_sums_over_bodies) {
  for (const char* family : {"generic", "comb", "humanoid", "several_trees", "joint_friction", "lattice", "no_rows", "no_bodies"}) {
    const auto structure = made(family, 9).problem.structure;
    const Structure& s = *structure;
    const Quantities q = count(s);
    double links = 0, depth = 0, row_depth = 0, row_pairs = 0, bodies = 0, dofs = 0;
    for (const auto& e : s.link_constraints) links += static_cast<double>(e.rows) * static_cast<double>(e.links.size());
    const auto is_below = [&](Index below, Index body) {
      while (below != ground && below != body) below = s.parent[below];
      return below == body;
    };
    for (Index i = 0; i < s.bodies(); ++i) {
      double rows = 0;
      for (const auto& e : s.link_constraints)
        for (const auto& link : e.links) rows += is_below(link.body, i) ? static_cast<double>(e.rows) : 0;
      for (const auto& e : s.joint_constraints) rows += is_below(e.body, i) ? static_cast<double>(e.rows) : 0;
      const double own = static_cast<double>(s.dofs(i));
      for (Index j = 0; j < s.bodies(); ++j) depth += is_below(i, j) ? own * static_cast<double>(s.dofs(j)) : 0;
      row_depth += own * rows, row_pairs += own * rows * rows;
      if (rows > 0) bodies += 1, dofs += own;
    }
    EXPECT_EQ(of(q, Quantities::link_rows), links) << family;
    double on_joints = 0;
    for (const auto& e : s.joint_constraints) on_joints += static_cast<double>(e.rows);
    EXPECT_EQ(of(q, Quantities::joint_rows), on_joints) << family;
    EXPECT_EQ(of(q, Quantities::depth), depth) << family;
    EXPECT_EQ(of(q, Quantities::row_depth), row_depth) << family;
    EXPECT_EQ(of(q, Quantities::row_pairs), row_pairs) << family;
    EXPECT_EQ(of(q, Quantities::active_bodies), bodies) << family;
    EXPECT_EQ(of(q, Quantities::active_dofs), dofs) << family;
    EXPECT_EQ(of(q, Quantities::bodies), static_cast<double>(s.bodies())) << family;
    EXPECT_EQ(8 * of(q, Quantities::row_packets) + of(q, Quantities::row_singles), of(q, Quantities::rows_squared)) << family;
    double tiles = 0, pairs = 0;
    const Fill fill = coupled_rows(s, lane_count);
    for (std::size_t p = 0; p + 1 < fill.first.size(); ++p) {
      const double below = static_cast<double>(fill.first[p + 1] - fill.first[p] - 1);
      tiles += below + 1, pairs += below * (below + 1) / 2;
    }
    EXPECT_EQ(of(q, Quantities::tiles), tiles) << family;
    EXPECT_EQ(of(q, Quantities::tile_pairs), pairs) << family;
  }
  EXPECT_EQ(of(count(*made("star", 5).problem.structure), Quantities::couplings), 0) << "nothing couples bodies there";
  EXPECT_GT(of(count(*made("lattice", 9).problem.structure), Quantities::couplings), 0);
}

TEST(Choose, costs_add_up) {
  const PhaseTimes t{1, 10, 100, 1000, 350, 4000};  // update, damping, product, solve, of eight
  EXPECT_EQ(cost(t, {.products = 3}), 301);
  EXPECT_EQ(cost(t, {.solves = 2, .dampings = 5}), 2051);
  EXPECT_EQ(cost(t, {.products = 1, .columns = 3}), 301);
  EXPECT_EQ(cost(t, {.products = 1, .columns = 4}), 351) << "lanes";
  EXPECT_EQ(cost(t, {.products = 1, .columns = 10}), 551) << "eight, and two by themselves";
  EXPECT_EQ(cost(t, {.products = 1, .columns = 12}), 701);
  EXPECT_EQ(cost(t, {.products = 2, .solves = 1}), 1201);
  PhaseTimes none = t;
  none[static_cast<std::size_t>(Phase::solve)] = NAN;
  EXPECT_EQ(cost(none, {.products = 1}), 101) << "what is not asked is not missed";
  EXPECT_TRUE(std::isnan(cost(none, {.solves = 1})));
}

const Demand uses[] = {{.products = 1}, {.products = 1000}, {.solves = 1}, {.solves = 1000}, {.solves = 30, .dampings = 30},
                    {.solves = 1, .certified = true}, {.solves = 1000, .certified = true}, {.products = 10, .solves = 10},
                    {.products = 100, .solves = 100, .certified = true}, {.products = 100, .columns = 8}, {.solves = 1e6, .columns = 8}};

TEST(Choose, names_rows_that_can_and_none_is_cheaper) {
  for (const char* family : {"chain", "humanoid", "comb", "contacts", "lattice"})
    for (const Index n : {3, 12, 40}) {
      const Quantities q = count(*made(family, n).problem.structure);
      for (const Demand& use : uses) {
        const Choice c = choose(q, use);
        EXPECT_EQ(c.product.empty(), use.products == 0);
        EXPECT_EQ(c.solve.empty(), use.solves == 0);
        EXPECT_GT(c.nanoseconds, 0);
        if (!c.product.empty()) {
          EXPECT_TRUE(find_operator(c.product).applies);
        }
        if (!c.solve.empty()) {
          const OperatorRow& row = find_operator(c.solve);
          EXPECT_TRUE(row.solves);
          EXPECT_EQ(row.solve_error == ErrorClass::refined, use.certified) << c.solve;
          EXPECT_TRUE(row.zero_damping || !use.certified) << "hard rows are solved where a bound is asked for: " << c.solve;
        }
        for (const OperatorRow& row : operators()) {
          const bool applies = use.products == 0 || row.applies, solves = use.solves == 0 || (row.solves && (row.solve_error == ErrorClass::refined) == use.certified);
          if (!applies || !solves) continue;
          const double other = cost(predicted(row.name, q), use);
          EXPECT_FALSE(other < (row.holds == Holds::sparse ? c.nanoseconds : (1 - explicit_saves) * c.nanoseconds)) << row.name << " is cheaper than " << c.product << ' ' << c.solve;
        }
      }
    }
}

TEST(Choose, few_rows_and_many_answers_are_explicit_and_long_chains_are_not) {
  const Quantities small = count(*made("humanoid", 26).problem.structure), chain = count(*made("swimmer", 1000).problem.structure);
  EXPECT_EQ(choose(chain, {.products = 1}).product, "aba_sweep");
  EXPECT_EQ(choose(chain, {.solves = 1}).solve, "lcaba");
  EXPECT_EQ(choose(chain, {.solves = 1, .certified = true}).solve, "ladder");
  const double from = crossover(small, {.products = 1});
  if (!std::isnan(from)) {
    EXPECT_NE(find_operator(choose(small, {.products = from}).product).holds, Holds::sparse);
    if (from > 1) {
      EXPECT_EQ(find_operator(choose(small, {.products = from - 1}).product).holds, Holds::sparse);
    }
  }
  Structure arm;  // one row at the end of thirty joints
  for (Index i = 0; i < 30; ++i) arm.add_body(i - 1, 1);
  arm.add_link_constraint(1, {29});
  EXPECT_NE(find_operator(choose(arm, {.products = 1000}).product).holds, Holds::sparse) << "one number against thirty joints";
  EXPECT_NE(find_operator(choose(arm, {.solves = 1000}).solve).holds, Holds::sparse);
  EXPECT_LT(crossover(count(arm), {.products = 1}), 1000);
}

TEST(Choose, misuse_is_refused) {
  const Quantities q = count(*made("chain", 3).problem.structure);
  EXPECT_THROW((void)choose(q, {}), std::logic_error);
  EXPECT_THROW((void)choose(q, {.products = -1, .solves = 3}), std::logic_error);
  EXPECT_THROW((void)choose(q, {.products = NAN}), std::logic_error);
  EXPECT_THROW((void)choose(q, {.products = 1, .columns = 0}), std::logic_error);
}

MatrixX<double> columns(Index m, Index k) {
  MatrixX<double> x(m, k);
  for (Index c = 0; c < k; ++c)
    for (Index r = 0; r < m; ++r) x(r, c) = static_cast<double>((5 * r + 3 * c) % 7) - 3;
  return x;
}

TEST(Auto, answers_bit_for_bit_as_the_rows_it_chose) {
  int of_one_row = 0, of_two = 0;
  for (const char* family : {"humanoid", "comb", "contacts", "block_damping", "chain"})
    for (const Index n : {2, 10, 30})
      for (Demand use : uses)
        for (const Index k : {Index{1}, Index{8}}) {
          const generators::Built built = made(family, n);
          Auto<double> op(use);
          op.analyze(built.problem.structure);
          const Choice c = choose(*built.problem.structure, use);
          EXPECT_EQ(op.chosen().product, c.product);
          EXPECT_EQ(op.chosen().solve, c.solve);
          (c.product == c.solve ? of_one_row : of_two) += use.products > 0 && use.solves > 0;
          const Index m = op.size();
          Damping<double> other = built.damping;
          for (double& d : other.diagonal) d *= 3;
          for (auto& b : other.blocks) b.R_inverse *= 3;
          const auto ask = [&](Operator<double>& of, bool product) {
            EXPECT_TRUE(of.update(built.problem, built.damping).ok());
            EXPECT_TRUE(of.update_damping(other).ok());
            EXPECT_TRUE(of.update_rows(built.problem, other).ok());
            Workspace<double> w(of.workspace(k));
            MatrixX<double> y(m, k);
            const Report report = product ? of.apply(columns(m, k), y, w) : of.solve(columns(m, k), y, w);
            EXPECT_EQ(report.ok(), true) << family << ' ' << n << ' ' << c.product << ' ' << c.solve << ' ' << name(report.status);
            return y;
          };
          for (const bool product : {true, false}) {
            const std::string_view row = product ? c.product : c.solve;
            Workspace<double> w(op.workspace(k));
            MatrixX<double> y(m, k);
            if (row.empty()) {
              EXPECT_TRUE(op.update(built.problem, built.damping).ok());
              EXPECT_EQ((product ? op.apply(columns(m, k), y, w) : op.solve(columns(m, k), y, w)).status, Status::not_supported);
              continue;
            }
            const auto chosen = find_operator(row).make<double>();
            chosen->analyze(built.problem.structure);
            EXPECT_TRUE(ask(op, product) == ask(*chosen, product)) << family << ' ' << n << ' ' << row;
          }
        }
  EXPECT_GT(of_two, 0);
  EXPECT_GT(of_one_row + of_two, 20);
}

}  // namespace
}  // namespace delassus::choose_test
