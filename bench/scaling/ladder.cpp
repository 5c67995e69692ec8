#include "bench/scaling/ladder.h"

#include <cmath>

#include "bench/text.h"
#include "models/swimmer.h"

namespace delassus::bench {

namespace {

/// Time of the slowest phase [µs].
double slowest(const Cell& c) {
  double t = 0;
  for (const Timing* x : {&c.time.analyze, &c.time.update, &c.time.new_damping, &c.time.apply, &c.time.solve})
    if (x->measured()) t = std::max(t, x->lowest);
  return t;
}

/// Why the operator in column `i` is not run at size n; empty: it is.
std::string why_not(const std::vector<Rung>& below, std::size_t i, Index n, double longest, double most_bytes) {
  if (below.size() < 2) return "";
  const Rung &a = below[below.size() - 2], &b = below.back();
  const Cell &ca = a.cells[i], &cb = b.cells[i];
  if (!cb.skipped.empty()) return cb.skipped;
  const auto at = [&](double y0, double y1) {
    return continued(static_cast<double>(n), static_cast<double>(a.links), y0, static_cast<double>(b.links), y1);
  };
  const double seconds = 1e-6 * at(slowest(ca), slowest(cb));
  if (seconds > longest)
    return format("left out from %lld links: a phase would take about %.1f s", static_cast<long long>(n), seconds);
  const double bytes = at(static_cast<double>(ca.bytes), static_cast<double>(cb.bytes));
  if (bytes > most_bytes)
    return format("left out from %lld links: it would need about %.1f GB", static_cast<long long>(n), 1e-9 * bytes);
  return "";
}

}  // namespace

double continued(double n, double n0, double y0, double n1, double y1) {
  const double order = std::max(1.0, std::log(y1 / y0) / std::log(n1 / n0));
  return y1 * std::pow(n / n1, order);
}

std::vector<Index> ladder_sizes(Index largest) {
  std::vector<Index> sizes;
  for (Index decade = 1; decade <= largest; decade *= 10)
    for (const Index n : {decade, 3 * decade})
      if (n >= 3 && n <= largest) sizes.push_back(n);
  return sizes;
}

std::vector<Rung> climb(const std::vector<Index>& links, const Limits& limits, double longest, double most_bytes,
                        const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop) {
  std::vector<Rung> rungs;
  for (const Index n : links) {
    if (stop && stop()) break;
    const Scene scene = swimmer(n);
    const Problem<double> problem = problem_of(scene);
    Rung rung{n, problem.structure->dofs(), problem.structure->rows,
              time_kinematics(scene.model, scene.q, limits.budget), {}};
    progress(format("swimmer of %lld links: %lld dofs, %lld rows", static_cast<long long>(n),
                    static_cast<long long>(rung.dofs), static_cast<long long>(rung.rows)));
    for (std::size_t i = 0; i < operators().size(); ++i) {
      const OperatorRow& row = operators()[i];
      Cell cell;
      cell.op = std::string(row.name);
      cell.skipped = why_not(rungs, i, n, longest, most_bytes);
      rung.cells.push_back(cell.skipped.empty() ? measure(row, problem, scene.damping, limits) : cell);
    }
    rungs.push_back(std::move(rung));
  }
  return rungs;
}

}  // namespace delassus::bench
