#include "algorithms/operators/choose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/factors/coupled_rows.h"
#include "algorithms/factors/plan.h"
#include "algorithms/kit/columns.h"
#include "algorithms/operators/kernel_costs.h"
#include "algorithms/operators/operators.h"

namespace delassus {

Quantities count(const Structure& s) {
  Quantities q;
  const auto add = [&](Quantities::Name name, double value) { q.of[name] += value; };
  const double N = static_cast<double>(s.bodies()), n = static_cast<double>(s.dofs()), m = static_cast<double>(s.rows);
  std::vector<double> below(static_cast<std::size_t>(s.bodies()), 0), depth = below;  // r_i; degrees of freedom to the root
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links) below[link.body] += static_cast<double>(e.rows), add(Quantities::link_rows, static_cast<double>(e.rows));
  for (const auto& e : s.joint_constraints) below[e.body] += static_cast<double>(e.rows), add(Quantities::joint_rows, static_cast<double>(e.rows));
  for (Index i = s.bodies(); i-- > 0;) {
    const double own = static_cast<double>(s.dofs(i));
    if (s.parent[i] != ground) below[s.parent[i]] += below[i];
    add(Quantities::row_depth, own * below[i]);
    add(Quantities::row_pairs, own * below[i] * below[i]);
  }
  for (Index i = 0; i < s.bodies(); ++i) {
    const double own = static_cast<double>(s.dofs(i));
    depth[i] = own + (s.parent[i] != ground ? depth[s.parent[i]] : 0);
    add(Quantities::depth, own * depth[i]);
  }
  const Plan plan = make_plan(s, Matrix::M_R);
  for (int i = plan.first_active; i < plan.steps; ++i) {
    const double members = plan.first_member[i + 1] - plan.first_member[i], own = plan.first_column[i + 1] - plan.first_column[i];
    if (!plan.simple(i) && (members > 1 || plan.parent[i] < 0)) add(Quantities::couplings, members > 0 ? own * (members + 1) * (members + 1) / 2 : 0);
  }
  const double batches = std::ceil(m / lane_count), active = plan.active(), columns = plan.active_columns();
  add(Quantities::one, 1);
  add(Quantities::bodies, N), add(Quantities::dofs, n);
  add(Quantities::active_bodies, active), add(Quantities::active_dofs, columns);
  add(Quantities::rows, m), add(Quantities::rows_squared, m * m), add(Quantities::rows_cubed, m * m * m);
  add(Quantities::row_bodies, batches * active), add(Quantities::row_dofs, batches * columns), add(Quantities::row_links, batches * q.of[Quantities::link_rows]);
  add(Quantities::row_packets, m * std::floor(m / lane_count)), add(Quantities::row_singles, m * std::fmod(m, lane_count));
  const FillSums tiles = tile_sums(s, lane_count);
  add(Quantities::tiles, tiles.entries), add(Quantities::tile_pairs, (tiles.squares - tiles.entries) / 2);
  return q;
}

PhaseTimes predicted(std::string_view op, const Quantities& q) {
  PhaseTimes t;
  t.fill(std::numeric_limits<double>::quiet_NaN());
  for (const KernelCost& k : kernel_costs()) {
    if (k.op != op) continue;
    double& sum = t[static_cast<std::size_t>(k.phase)] = 0;
    for (const auto& term : k.terms) sum += term.nanoseconds * q.of[term.quantity];
  }
  return t;
}

double cost(const PhaseTimes& of, const Demand& use) {
  const auto once = [&](Phase phase) { return of[static_cast<std::size_t>(phase)]; };
  const auto all_columns = [&](Phase one_by_one, Phase in_lanes) {
    const double single = once(one_by_one), eight = once(in_lanes);
    if (use.columns < least_lanes) return static_cast<double>(use.columns) * single;
    const Index left = use.columns % lane_count;
    return static_cast<double>(use.columns / lane_count) * eight + (left >= least_lanes ? eight : static_cast<double>(left) * single);
  };
  double t = once(Phase::update);
  if (use.dampings > 0) t += use.dampings * once(Phase::damping);
  if (use.products > 0) t += use.products * all_columns(Phase::product, Phase::product_of_eight);
  if (use.solves > 0) t += use.solves * all_columns(Phase::solve, Phase::solve_of_eight);
  return t;
}

namespace {
/// Rows with measured costs that can answer all of it.
std::vector<std::string_view> candidates(const Demand& use) {
  std::vector<std::string_view> names;
  for (const KernelCost& k : kernel_costs()) {
    if (k.phase != Phase::update) continue;
    const OperatorRow& row = find_operator(k.op);
    if (use.products > 0 && !row.applies) continue;
    if (use.solves > 0 && (!row.solves || use.certified != (row.solve_error == ErrorClass::refined))) continue;
    names.push_back(k.op);
  }
  return names;
}

struct Cheapest {
  std::string_view op;
  double nanoseconds = std::numeric_limits<double>::infinity();
  double weighed = std::numeric_limits<double>::infinity();  // more where the row is explicit
};
Cheapest cheapest(const Quantities& q, const Demand& use) {
  Cheapest best;
  for (const std::string_view op : candidates(use)) {
    const double t = cost(predicted(op, q), use), weighed = find_operator(op).holds == Holds::sparse ? t : t / (1 - explicit_saves);
    if (weighed < best.weighed) best = {op, t, weighed};
  }
  return best;
}
}  // namespace

Choice choose(const Quantities& q, const Demand& use) {
  require(use.products >= 0 && use.solves >= 0 && use.dampings >= 0, "choose: a number of uses is negative or NaN");
  require(use.products + use.solves > 0, "choose: neither products nor solves are asked for");
  require(use.columns > 0, "choose: the number of columns is not positive");
  Demand products = use, solves = use;
  products.solves = solves.products = 0;
  if (use.solves == 0) {
    const Cheapest best = cheapest(q, products);
    return {best.op, {}, best.nanoseconds};
  }
  if (use.products == 0) {
    const Cheapest best = cheapest(q, solves);
    return {{}, best.op, best.nanoseconds};
  }
  const Cheapest both = cheapest(q, use), product = cheapest(q, products), solve = cheapest(q, solves);
  if (both.weighed <= product.weighed + solve.weighed) return {both.op, both.op, both.nanoseconds};
  return {product.op, solve.op, product.nanoseconds + solve.nanoseconds};
}

double crossover(const Quantities& q, Demand use) {
  double& times = use.solves > 0 ? use.solves : use.products;
  const auto is_explicit = [&](double t) {
    times = t;
    const Choice c = choose(q, use);
    return find_operator(use.solves > 0 ? c.solve : c.product).holds != Holds::sparse;
  };
  double none = 0, some = 1;  // the cost of every row is a line over the number: the cheapest ones change sides once at most,
  while (!is_explicit(some)) {  // where explicit ones pay more first and less again
    none = some, some *= 2;
    if (some > 1e9) return std::numeric_limits<double>::quiet_NaN();
  }
  while (some - none > 1) {
    const double middle = std::floor((none + some) / 2);
    (is_explicit(middle) ? some : none) = middle;
  }
  return some;
}

}  // namespace delassus
