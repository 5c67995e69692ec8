#include "bench/simulation/solver_profile.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/kit/ldlt_pivoted.h"
#include "bench/interleaved.h"
#include "bench/machine.h"
#include "bench/text.h"
#include "reference/contact_residual.h"

namespace delassus::bench {

using nlohmann::json;
using simulation::ContactProblem;
using simulation::SolverReport;
using simulation::SolverRow;
using Numbers = reference::DenseContact<Quad>;

namespace {

std::int64_t rank_of(const MatrixX<Quad>& G) {
  const Index m = G.rows();
  MatrixX<double> a(m, m);
  for (Index k = 0; k < G.size(); ++k) a.data()[k] = static_cast<double>(G.data()[k]);
  std::vector<Index> order(static_cast<std::size_t>(m));
  const double least = m > 0 ? 1e-10 * a.diagonal().maxCoeff() : 0;
  return ldlt_pivoted(a.data(), m, order.data(), [&](Index, double pivot, Index) { return pivot > least; });
}

std::string outcome_of(const SolverReport& report, double residual, double wanted) {
  if (residual <= wanted) return "solved";
  return report.ok() ? "says_ok" : std::string(name(report.status));
}

SolverRun run(simulation::ContactSolver<double>& solver, const ContactProblem<double>& p, const Numbers& numbers, double scale, double wanted, int iterations) {
  SolverRun r;
  VectorX<double> lambda;
  SolverReport report;
  double total = 0;
  for (int k = 0; k < 3 && total < 2e-3; ++k) {
    const double start = thread_seconds();
    report = solver.solve(p, {wanted * scale, iterations}, lambda);
    const double seconds = thread_seconds() - start;
    total += seconds;
    r.microseconds = k == 0 ? 1e6 * seconds : std::min(r.microseconds, 1e6 * seconds);
  }
  r.iterations = report.iterations;
  r.residual = reference::contact_residual(p, numbers, lambda, p.law).natural / scale;
  r.outcome = outcome_of(report, r.residual, wanted);
  return r;
}

Runs runs_of(const SolverRow& row, const ContactProblem<double>& p, const Numbers& numbers, double scale, int iterations) {
  Runs runs;
  const auto solver = row.make();
  if (!solver->supports(p)) {
    for (SolverRun& r : runs) r.outcome = "refused";
    return runs;
  }
  solver->analyze(p);
  for (std::size_t k = 0; k < wanted_count; ++k)
    runs[k] = k > 0 && !runs[k - 1].solved() ? runs[k - 1] : run(*solver, p, numbers, scale, wanted_residuals[k], iterations);
  return runs;
}

}  // namespace

ProfiledProblem profile_problem(const SolverProblem& of, const std::vector<SolverRow>& rows, int iterations) {
  const ContactProblem<double>& p = of.problem;
  const Numbers numbers(p);
  ProfiledProblem out{of.set, of.name, of.density, p.rows(), rank_of(numbers.G), {}};
  const double largest = p.rows() > 0 ? (p.free_velocity - p.target).lpNorm<Eigen::Infinity>() : 0;
  for (const SolverRow& row : rows) out.runs.push_back(runs_of(row, p, numbers, largest > 0 ? largest : 1, iterations));
  return out;
}

SolverProfile profile_solvers(const std::vector<SolverProblem>& problems, const std::vector<SolverRow>& rows, int iterations,
                              const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop) {
  SolverProfile out;
  out.machine = this_machine();
  out.iterations = iterations;
  for (const SolverRow& row : rows) out.solvers.emplace_back(row.name);
  std::string said;
  for (const SolverProblem& p : problems) {
    if (stop && stop()) {
      out.interrupted = true;
      break;
    }
    const std::string at = p.set + (std::isnan(p.density) ? "" : format(", density %g", p.density));
    if (at != said) progress(at);
    said = at;
    out.problems.push_back(profile_problem(p, rows, iterations));
  }
  return out;
}

double profile_at(const SolverProfile& p, const std::string& set, std::size_t solver, std::size_t wanted, Measure by, double tau) {
  const auto cost = [&](const SolverRun& r) { return by == Measure::time ? r.microseconds : std::max(r.iterations, 1); };
  int all = 0, within = 0;
  for (const ProfiledProblem& q : p.problems) {
    if (q.set != set) continue;
    ++all;
    const SolverRun& own = q.runs[solver][wanted];
    if (!own.solved()) continue;
    double best = cost(own);
    for (const Runs& other : q.runs)
      if (other[wanted].solved()) best = std::min(best, cost(other[wanted]));
    within += cost(own) <= tau * best;
  }
  return all > 0 ? static_cast<double>(within) / all : NAN;
}

std::vector<std::string> sets_of(const SolverProfile& p) {
  std::vector<std::string> sets;
  for (const ProfiledProblem& q : p.problems)
    if (std::find(sets.begin(), sets.end(), q.set) == sets.end()) sets.push_back(q.set);
  return sets;
}

namespace {

json number(double x) { return std::isfinite(x) ? json(std::stod(format("%.4g", x))) : json(nullptr); }
double number_of(const json& j) { return j.is_null() ? NAN : j.get<double>(); }

json written(const ProfiledProblem& p, const std::vector<std::string>& solvers) {
  json runs;
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    json& of = runs[solvers[s]];
    for (const SolverRun& r : p.runs[s]) of.push_back(r.refused() ? json("refused") : json{r.outcome, r.iterations, number(r.microseconds), number(r.residual)});
  }
  return {{"set", p.set}, {"name", p.name}, {"density", number(p.density)}, {"rows", p.rows}, {"rank", p.rank}, {"runs", runs}};
}

SolverRun run_read(const json& j) {
  if (j.is_string()) return {j.get<std::string>()};
  return {j.at(0), j.at(1), number_of(j.at(2)), number_of(j.at(3))};
}

ProfiledProblem problem_read(const json& j, const std::vector<std::string>& solvers) {
  ProfiledProblem p{j.at("set"), j.at("name"), number_of(j.at("density")), j.at("rows"), j.at("rank"), {}};
  for (const std::string& s : solvers) {
    Runs& runs = p.runs.emplace_back();
    for (std::size_t k = 0; k < wanted_count; ++k) runs[k] = run_read(j.at("runs").at(s).at(k));
  }
  return p;
}

}  // namespace

void to_json(json& j, const SolverProfile& p) {
  const Machine& m = p.machine;
  j = {{"machine", {{"processor", m.processor}, {"cores", m.cores}, {"system", m.system}, {"compiler", m.compiler}, {"flags", m.flags}, {"revision", m.revision}, {"date", m.date}}},
       {"iterations", p.iterations}, {"interrupted", p.interrupted}, {"wanted", wanted_residuals}, {"solvers", p.solvers}, {"problems", json::array()}};
  for (const ProfiledProblem& q : p.problems) j["problems"].push_back(written(q, p.solvers));
}

void from_json(const json& j, SolverProfile& p) {
  const json& m = j.at("machine");
  p.machine = {m.at("processor"), m.at("system"), m.at("compiler"), m.at("flags"), m.at("revision"), m.at("date"), m.at("cores")};
  p.iterations = j.at("iterations");
  p.interrupted = j.at("interrupted");
  p.solvers = j.at("solvers").get<std::vector<std::string>>();
  p.problems.clear();
  for (const json& q : j.at("problems")) p.problems.push_back(problem_read(q, p.solvers));
}

std::string solver_json(const SolverProfile& p) {
  json head = p;
  const json problems = head["problems"];
  head.erase("problems");
  std::string s = "{\n";
  for (const auto& [key, value] : head.items()) s += json(key).dump() + ": " + value.dump() + ",\n";
  s += "\"problems\": [";
  for (std::size_t k = 0; k < problems.size(); ++k) s += (k > 0 ? ",\n" : "\n") + problems[k].dump();
  return s + "\n]}\n";
}

}  // namespace delassus::bench
