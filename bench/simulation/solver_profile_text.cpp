// A profile of solvers in tables and pictures.
#include <algorithm>
#include <cmath>
#include <map>

#include "bench/page/plot.h"
#include "bench/simulation/solver_profile.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

using Cells = std::vector<std::vector<std::string>>;
using Choose = std::function<bool(const ProfiledProblem&)>;

constexpr std::size_t in_the_middle = 1;  // 1e-8

/// What a solver did on some problems: taken, and solved per wanted residual.
struct Success {
  int taken = 0;
  std::array<int, wanted_count> solved{};
};
Success success(const SolverProfile& p, std::size_t solver, const Choose& chosen) {
  Success s;
  for (const ProfiledProblem& q : p.problems) {
    if (!chosen(q) || q.runs[solver][0].refused()) continue;
    ++s.taken;
    for (std::size_t k = 0; k < wanted_count; ++k) s.solved[k] += q.runs[solver][k].solved();
  }
  return s;
}

/// "12 · 12 · 9 of 12": solved at the three residuals; "all 12" where they are.
std::string success_text(const Success& s) {
  if (s.taken == 0) return "refused";
  if (std::all_of(s.solved.begin(), s.solved.end(), [&](int n) { return n == s.taken; })) return "all " + std::to_string(s.taken);
  return format("%d · %d · %d of %d", s.solved[0], s.solved[1], s.solved[2], s.taken);
}

std::vector<std::size_t> takers(const SolverProfile& p, const std::string& set) {
  std::vector<std::size_t> out;
  for (std::size_t s = 0; s < p.solvers.size(); ++s)
    if (success(p, s, [&](const auto& q) { return q.set == set; }).taken > 0) out.push_back(s);
  return out;
}

/// A line per part of a set that has problems, a column per solver that takes any.
struct Part {
  std::string name;
  Choose chosen;
};
std::string success_table(const SolverProfile& p, const std::string& set, const std::string& by, const std::vector<Part>& parts) {
  Cells cells{{by, "problems"}};
  const auto solvers = takers(p, set);
  for (const std::size_t s : solvers) cells[0].push_back(p.solvers[s]);
  for (const Part& part : parts) {
    const auto chosen = [&](const ProfiledProblem& q) { return q.set == set && part.chosen(q); };
    const auto count = std::count_if(p.problems.begin(), p.problems.end(), chosen);
    if (count == 0) continue;
    cells.push_back({part.name, std::to_string(count)});
    for (const std::size_t s : solvers) cells.back().push_back(success_text(success(p, s, chosen)));
  }
  return markdown_table(cells);
}

std::vector<Part> by_density(const SolverProfile& p, const std::string& set) {
  std::vector<double> met;
  for (const ProfiledProblem& q : p.problems)
    if (q.set == set && !std::isnan(q.density) && std::find(met.begin(), met.end(), q.density) == met.end()) met.push_back(q.density);
  std::sort(met.begin(), met.end());
  std::vector<Part> parts;
  for (const double d : met) parts.push_back({format("%g", d), [d](const auto& q) { return q.density == d; }});
  parts.push_back({"not known", [](const auto& q) { return std::isnan(q.density); }});
  return parts;
}

std::vector<Part> by_rank() {
  const auto part = [](const char* name, double from, double below) {
    return Part{name, [from, below](const ProfiledProblem& q) {
                  const double share = static_cast<double>(q.rank) / static_cast<double>(q.rows);
                  return share >= from && share < below;
                }};
  };
  return {part("1: independent rows", 1, 2), part("½ to 1", 0.5, 1), part("¼ to ½", 0.25, 0.5), part("⅛ to ¼", 0.125, 0.25), part("below ⅛", 0, 0.125)};
}

double median(std::vector<double> x) {
  if (x.empty()) return NAN;
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

/// "3 not_converged, 1 says_ok" of the problems that were taken.
std::string failures(const SolverProfile& p, const std::string& set, std::size_t solver, std::size_t wanted) {
  std::map<std::string, int> count;
  for (const ProfiledProblem& q : p.problems)
    if (const SolverRun& r = q.runs[solver][wanted]; q.set == set && !r.solved() && !r.refused()) ++count[r.outcome];
  std::string s;
  for (const auto& [outcome, n] : count) s += (s.empty() ? "" : ", ") + std::to_string(n) + " " + outcome;
  return s.empty() ? "–" : s;
}

std::string effort_table(const SolverProfile& p, const std::string& set) {
  Cells cells{{"solver", "wanted", "taken", "solved", "failed", "iterations", "largest", "µs"}};
  for (const std::size_t s : takers(p, set))
    for (std::size_t k = 0; k < wanted_count; ++k) {
      std::vector<double> iterations, times;
      for (const ProfiledProblem& q : p.problems)
        if (const SolverRun& r = q.runs[s][k]; q.set == set && r.solved()) iterations.push_back(r.iterations), times.push_back(r.microseconds);
      const Success of = success(p, s, [&](const auto& q) { return q.set == set; });
      const double largest = iterations.empty() ? NAN : *std::max_element(iterations.begin(), iterations.end());
      cells.push_back({k == 0 ? p.solvers[s] : "", format("%.0e", wanted_residuals[k]), std::to_string(of.taken), std::to_string(of.solved[k]), failures(p, set, s, k),
                       three_digits(median(iterations)), three_digits(largest), three_digits(median(times))});
    }
  return markdown_table(cells);
}

constexpr double taus[] = {1, 2, 5, 10, 100};

std::string profile_table(const SolverProfile& p, const std::string& set, Measure by) {
  Cells cells{{"solver"}};
  for (const double tau : taus) cells[0].push_back(format("within %g×", tau));
  for (const std::size_t s : takers(p, set)) {
    cells.push_back({p.solvers[s]});
    for (const double tau : taus) cells.back().push_back(format("%.0f %%", 100 * profile_at(p, set, s, in_the_middle, by, tau)));
  }
  return markdown_table(cells);
}

std::string title(const std::string& set) {
  if (set == "equality") return "Equality rows, hard";
  if (set == "relaxed") return "Coulomb, relaxed";
  if (set == "exact") return "Coulomb, exact";
  return "Problems from " + set;
}

}  // namespace

std::string solver_text(const SolverProfile& p) {
  const Machine& m = p.machine;
  std::string s = m.processor + "; " + m.compiler + " " + m.flags + "; revision " + m.revision + ", " + m.date + format(". At most %d iterations.", p.iterations) +
                  (p.interrupted ? " Interrupted: problems are missing." : "") + "\n";
  for (const std::string& set : sets_of(p)) {
    const auto densities_met = by_density(p, set);
    s += "\n### " + title(set) + "\nSolved at 1e-4 · 1e-8 · 1e-12 of those taken:\n\n";
    s += success_table(p, set, "density", densities_met);
    s += "\n" + success_table(p, set, "rank / rows", by_rank());
    s += "\nMedians of those solved:\n\n" + effort_table(p, set);
    s += "\nShare solved at 1e-8 within a multiple of the least time:\n\n" + profile_table(p, set, Measure::time);
    s += "\nand of the fewest iterations:\n\n" + profile_table(p, set, Measure::iterations);
  }
  return s;
}

std::string solver_picture(const SolverProfile& p, const std::string& set, std::size_t wanted, Measure by) {
  std::vector<Series> series;
  for (const std::size_t s : takers(p, set)) {
    Series one{p.solvers[s], {}, static_cast<int>(s), false};
    for (int k = 0; k <= 18; ++k) {
      const double tau = std::pow(10, k / 6.0);
      one.points.emplace_back(tau, profile_at(p, set, s, wanted, by, tau * (1 + 1e-12)));
    }
    series.push_back(one);
  }
  const char* const cost = by == Measure::time ? "time" : "iterations";
  const std::string what = title(set) + format(", %.0e: share solved", wanted_residuals[wanted]);
  return standalone(plot("profile-" + set + format("-%zu-", wanted) + cost, what + " within a multiple of the best", std::string("multiple of the best ") + cost, what, series, Axes::profile));
}

}  // namespace delassus::bench
