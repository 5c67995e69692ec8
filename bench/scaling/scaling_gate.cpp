// Gate on orders: on every ladder (generators/ladders.h) the counted operations of every operator and phase grow as declared
// (algorithms/operators/declared_orders.h), ± 0.02 in the order; scaling.h says how it is measured. No clock.
//
// With --defect a wrong row takes the place of all others, which must be noticed (exit code 1).
#include <cstdio>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/operators/aba_sweep.h"
#include "algorithms/operators/explicit_columns.h"
#include "bench/scaling/scaling.h"
#include "cli/program/options.h"

namespace {

using namespace delassus;
using namespace delassus::bench;

void waste(Index operations) {
  Counted x(1);
  for (Index k = 0; k < operations; ++k) x += Counted(1);
}

/// Products that pass over the pairs of rows, a thousandth of an operation for each.
class QuadraticProduct : public AbaSweep<Counted> {
  Report do_apply(ConstRef<Counted> f, Ref<Counted> a, Counted* workspace) const override {
    waste(f.rows() * f.rows() / 1000);
    return AbaSweep<Counted>::do_apply(f, a, workspace);
  }
};

/// A matrix formed in m³/1000 operations more.
class CubicForm : public ExplicitColumns<Counted> {
  void form(const Problem<Counted>& problem, MatrixX<Counted>& A0) override {
    const Index m = problem.structure->rows;
    waste(m * m * m / 1000);
    ExplicitColumns<Counted>::form(problem, A0);
  }
};

template <class Op> OperatorRow as(const char* name) {
  OperatorRow row = find_operator(name);
  std::get<Maker<Counted>>(row.makers) = []() -> std::unique_ptr<Operator<Counted>> { return std::make_unique<Op>(); };
  return row;
}

OperatorRow defect(const std::string& name) {
  if (name == "quadratic_product") return as<QuadraticProduct>("aba_sweep");
  if (name == "cubic_form") return as<CubicForm>("explicit_columns");
  return as<ExplicitColumns<Counted>>("ltl_osim");  // declared_too_high: m² d is declared, n m is what it takes
}

/// Prints what is not as declared; returns how many.
int judge(const Scaling& s, bool all) {
  int held = 0, wrong = 0, few = 0;
  for (const ScalingLadder& ladder : s.ladders)
    for (const ScalingCell& c : ladder.sizes.front().cells)
      for (std::size_t k = 0; k < asks_count; ++k) {
        const Asks what = static_cast<Asks>(k);
        if (declared_orders(c.op)[k].empty()) continue;
        const Order order = order_of(ladder, c.op, what);
        if (std::isnan(order.declared) && generators::find_ladder(ladder.name).powers.empty()) {
          ++few;  // of boxes in hundreds no matrix is formed within the budget
          continue;
        }
        ++held, wrong += !order.agree();
        if (all || !order.agree())
          std::printf("%-8s %-18s %-14s measured %.4f declared %.4f%s\n", ladder.name.c_str(), c.op.c_str(), std::string(name(what)).c_str(), order.measured, order.declared, order.agree() ? "" : "  NOT AS DECLARED");
      }
  std::printf("%d orders on %zu ladders held, %d not as declared; %d more have too few sizes for a fit\n", held, s.ladders.size(), wrong, few);
  return held > 0 ? wrong : 1;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Counted operations against declared orders, on every ladder. Exit code 1: some differ by more than 0.02."};
  std::vector<std::string> names, ops;
  std::string wanted;
  bool all = false;
  double budget = 4e8;
  app.add_option("--ladder", names, "only these ladders");
  app.add_option("--op", ops, "only these operators");
  app.add_option("--defect", wanted, "a wrong row in the place of all others")->check(options::one_of({"quadratic_product", "cubic_form", "declared_too_high"}));
  app.add_option("--budget", budget, "counted operations of a phase, beyond which no size is taken")->check(options::above(0, ""))->capture_default_str();
  app.add_flag("--all", all, "print what is as declared, too");
  return options::run(app, argc, argv, [&] {
    std::vector<const generators::LadderRow*> ladders;
    for (const generators::LadderRow& row : generators::ladders())
      if (names.empty()) ladders.push_back(&row);
    for (const std::string& name : names) ladders.push_back(&generators::find_ladder(name));
    std::vector<const OperatorRow*> rows;
    const OperatorRow wrong = defect(wanted);
    if (!wanted.empty()) rows.push_back(&wrong);
    for (const OperatorRow& row : operators())
      if (wanted.empty() && ops.empty()) rows.push_back(&row);
    for (const std::string& name : ops) rows.push_back(&find_operator(name));
    return judge(measure_scaling(ladders, rows, {.budget = budget, .gate = true, .progress = {}, .stop = {}}), all) == 0 ? 0 : 1;
  });
}
