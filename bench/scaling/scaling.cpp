#include "bench/scaling/scaling.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "algorithms/kit/test_scalars.h"
#include "bench/scaling/ladder.h"
#include "bench/machine.h"
#include "bench/text.h"
#include "bench/table1/uses.h"
#include "generators/build.h"

namespace delassus::bench {

namespace {

using Sequence = std::vector<double>;

/// f(2s) − 2ᵖ f(s).
Sequence without(const Sequence& f, int power) {
  Sequence g;
  for (std::size_t i = 0; i + 1 < f.size(); ++i) g.push_back(f[i + 1] - std::ldexp(f[i], power));
  return g;
}

double doubles_with(const Sequence& g) { return g.size() < 2 ? NAN : std::log2(g.back() / g[g.size() - 2]); }

std::int64_t counted(const std::function<void()>& f) {
  const std::int64_t before = operation_count.total();
  f();
  return operation_count.total() - before;
}

/// Every phase once, of one column.
ScalingCell count(const OperatorRow& row, const Problem<Counted>& problem, const Damping<Counted>& damping, const Damping<Counted>& other, bool whole) {
  ScalingCell c;
  c.op = std::string(row.name);
  const auto of = [&](Asks what) -> std::int64_t& { return c.operations[static_cast<std::size_t>(what)]; };
  const auto op = row.make<Counted>();
  op->analyze(problem.structure);
  const MatrixX<Counted> in = sample_vector(op->size()).unaryExpr([](double x) { return Counted(x); });
  MatrixX<Counted> out = MatrixX<Counted>::Zero(op->size(), 1);
  Workspace<Counted> workspace(op->workspace());
  Report report;
  constexpr Accuracy one_step{0, 1};
  const std::int64_t update = counted([&] { report = op->update(problem, damping); });
  c.status = std::string(name(report.status));
  if (row.applies) of(Asks::apply) = counted([&] { report = op->apply(in, out, workspace); });
  if (row.solves) {
    of(Asks::first_solve) = update + counted([&] { report = op->solve(in, out, one_step, workspace); });
    of(Asks::solve) = counted([&] { report = op->solve(in, out, one_step, workspace); });
    if (whole) c.whole = counted([&] { report = op->solve(in, out, workspace); });
    if (whole) c.steps = report.iterations;
    if (whole && c.status == "ok") c.status = std::string(name(report.status));
  }
  of(Asks::new_damping) = counted([&] { report = op->update_damping(other); });
  if (row.applies) of(Asks::product) = update + of(Asks::apply) - (row.solves ? of(Asks::new_damping) : 0);
  c.bytes = op->bytes();
  return c;
}

/// Why an operator is not run at size s, from its cells at the two sizes before; empty: it is.
std::string why_not(const std::vector<ScalingSize>& below, std::size_t i, Index s, const ScalingOptions& o) {
  if (below.empty()) return "";
  const ScalingCell& b = below.back().cells[i];
  if (!b.skipped.empty() || below.size() < 2) return b.skipped;
  const ScalingSize &before = below[below.size() - 2], &last = below.back();
  const ScalingCell& a = before.cells[i];
  const auto at = [&](std::int64_t y0, std::int64_t y1) {
    return y0 <= 0 || y1 <= 0 ? 0.0 : continued(static_cast<double>(s), static_cast<double>(before.s), static_cast<double>(y0), static_cast<double>(last.s), static_cast<double>(y1));
  };
  double operations = at(a.whole, b.whole);
  for (std::size_t k = 0; k < asks_count; ++k) operations = std::max(operations, at(a.operations[k], b.operations[k]));
  if (operations > o.budget) return format("%.0e operations at %lld", operations, static_cast<long long>(s));
  const double bytes = at(a.bytes, b.bytes);
  return bytes > o.most_bytes ? format("%.1f GB at %lld", 1e-9 * bytes, static_cast<long long>(s)) : "";
}

/// Doubling; where the order is by fit, quarters between, too.
std::vector<Index> sizes_of(const generators::LadderRow& row, Index largest) {
  std::vector<Index> sizes;
  for (Index s = row.smallest; s <= largest; s *= 2) {
    sizes.push_back(s);
    for (const Index quarters : {5, 6, 7})
      if (row.powers.empty() && quarters * s % 4 == 0 && quarters * s / 4 <= largest) sizes.push_back(quarters * s / 4);
  }
  return sizes;
}

}  // namespace

Order order_of(const std::vector<int>& powers, const Sequence& counts, const Sequence& declared) {
  Order order;
  Sequence f = counts, q = declared;
  for (std::size_t k = 0; k < powers.size(); ++k) {
    const Sequence next = without(q, powers[k]);
    if (next.empty() || std::abs(next.back()) <= 1e-12 * declared.back()) {  // nothing is left of what is declared
      order.declared = powers[k];
      order.measured = doubles_with(f);
      return order;
    }
    order.logarithms = k + 1 < powers.size() && powers[k + 1] == powers[k] ? order.logarithms + 1 : 0;
    q = next;
    f = without(f, powers[k]);
  }
  return {};
}

Order order_by_fit(const Sequence& sizes, const Sequence& counts, const std::vector<Sequence>& terms) {
  const std::size_t last = counts.size() - 1;  // sizes fitted
  Eigen::MatrixXd G(static_cast<Index>(last), static_cast<Index>(terms[0].size()));
  for (std::size_t i = 0; i < last; ++i)
    for (std::size_t j = 0; j < terms[i].size(); ++j) G(static_cast<Index>(i), static_cast<Index>(j)) = terms[i][j] / counts[i];
  const Eigen::VectorXd scale = G.colwise().norm().transpose().cwiseMax(1e-300);
  const auto fit = (G * scale.cwiseInverse().asDiagonal()).eval().completeOrthogonalDecomposition();
  if (static_cast<Index>(last) < fit.rank() + 2) return {};
  const Eigen::VectorXd c = fit.solve(Eigen::VectorXd::Ones(static_cast<Index>(last))).cwiseQuotient(scale);
  const auto fitted = [&](std::size_t i) {
    double sum = 0;
    for (std::size_t j = 0; j < terms[i].size(); ++j) sum += c[static_cast<Index>(j)] * terms[i][j];
    return sum;
  };
  std::size_t half = last - 1;
  while (half > 0 && 2 * sizes[half] > sizes[last]) --half;
  const double step = std::log(sizes[last] / sizes[half]);
  return {std::log(counts[last] / counts[half]) / step, std::log(fitted(last) / fitted(half)) / step, 0};
}

Order order_of(const ScalingLadder& ladder, std::string_view op, Asks what) {
  const std::vector<int>& powers = generators::find_ladder(ladder.name).powers;
  const std::vector<Term>& declared = declared_orders(op)[static_cast<std::size_t>(what)];
  const bool takes_steps = find_operator(op).solve_error == ErrorClass::refined && (what == Asks::first_solve || what == Asks::solve);
  Sequence sizes, counts, sums;
  std::vector<Sequence> terms;
  int steps = -1;
  for (const ScalingSize& size : ladder.sizes) {
    Sequence& of = terms.emplace_back();
    for (const Term t : declared) of.push_back(size.terms[static_cast<std::size_t>(t)]);
    sums.push_back(0);
    for (const double t : of) sums.back() += t;
    for (const ScalingCell& c : size.cells) {
      if (c.op != op || !c.skipped.empty() || counts.size() + 1 < terms.size()) continue;
      if (steps < 0) steps = c.steps;
      if (takes_steps && c.steps != steps) continue;  // from here on another number of them
      sizes.push_back(static_cast<double>(size.s)), counts.push_back(static_cast<double>(c.operations[static_cast<std::size_t>(what)]));
    }
  }
  if (declared.empty() || counts.empty() || counts.back() <= 0) return {};
  const Order order = order_of(powers, counts, sums);
  return std::isnan(order.declared) ? order_by_fit(sizes, counts, terms) : order;
}

Scaling measure_scaling(const std::vector<const generators::LadderRow*>& ladders, const std::vector<const OperatorRow*>& rows, const ScalingOptions& o) {
  Scaling all{this_machine(), o.budget, o.most_bytes, {}};
  for (const generators::LadderRow* ladder : ladders) {
    ScalingLadder& of = all.ladders.emplace_back(ScalingLadder{std::string(ladder->name), {}});
    for (const Index s : sizes_of(*ladder, o.gate ? ladder->gate : ladder->largest)) {
      if (o.stop && o.stop()) return all;
      const generators::Built built = generators::build(ladder->make(s));
      const Structure& structure = *built.problem.structure;
      const Problem<Counted> problem = built.problem.cast<Counted>();
      const Damping<Counted> damping = built.damping.cast<Counted>(), other = other_damping(built.damping).cast<Counted>();
      const auto sums = terms(structure);
      ScalingSize size{s, structure.bodies(), structure.dofs(), structure.rows, {sums.begin(), sums.end()}, {}};
      for (std::size_t i = 0; i < rows.size(); ++i) {
        ScalingCell cell;
        cell.op = std::string(rows[i]->name);
        cell.skipped = std::get<Maker<Counted>>(rows[i]->makers) ? why_not(of.sizes, i, s, o) : "is not counted";
        size.cells.push_back(cell.skipped.empty() ? count(*rows[i], problem, damping, other, !o.gate) : cell);
      }
      if (o.progress) o.progress(format("%s %lld: %lld bodies, n = %lld, m = %lld", of.name.c_str(), static_cast<long long>(s), static_cast<long long>(size.bodies), static_cast<long long>(size.dofs), static_cast<long long>(size.rows)));
      of.sizes.push_back(std::move(size));
    }
  }
  return all;
}

}  // namespace delassus::bench
