// Certificates against the truth: on random problems the bound an operator returns is never below the error.
//
//   certificate [--count K] [--seed S] [--shard i/n] [--divide D] [--hard] [--markdown]
//
// Problems are generators::arbitrary(S), arbitrary(S + 1), …, those with A regular beyond rounding and up to 40 degrees of freedom and rows.
// Where a row is hard (R⁻¹ = 0), answers are counted apart: another bound (algorithms/operators/kkt_elimination.h).
// Judged are the λ of every operator that gives a bound, in the energy norm (truth.h); and of refinement.h itself every
// iterate on the way, the pair (ν, λ) and λ alone, also with corrections that are off by 1 %. Rounding the answer to
// double is allowed for once, and so is the rounding of the bound's own evaluation (truth.h). The estimate is compared
// with the error of the pair and of the largest force before its step, where the step at least halved it.
// --divide: the bounds are divided by D first; the program must then fail. Exit code 0: no bound is violated; 1: one is.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>

#include "algorithms/factors/capped_inverse.h"
#include "algorithms/factors/refinement.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/arbitrary.h"
#include "cli/program/options.h"
#include "property_tests/laws/route.h"
#include "property_tests/campaigns/truth.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

struct Options {
  std::uint64_t count = 20000, seed = 1;
  options::Shard shard;
  double divide = 1;
  bool hard = false, markdown = false;
};

/// What one kind of answer came to.
struct Tally {
  std::uint64_t answers = 0, violated = 0;
  std::uint64_t evaluated = 0;     ///< above the bound by what its evaluation rounds
  std::uint64_t below_half = 0, below_tenth = 0;
  std::vector<double> pessimism;   ///< bound / error, where the error is above its rounding
  std::vector<double> estimates;   ///< estimate / error
};

/// One problem with its truth and a right-hand side.
struct Question {
  const Problem<double>& problem;
  const Damping<double>& damping;
  const Truth& truth;
  VectorX<double> a;
  VectorX<Quad> lambda;
  double rounding;  ///< of λ to double
  std::uint64_t seed;
};

void judge_bound(const Options& o, Tally& t, const Question& q, std::string_view subject, double error, double rounding,
                 double bound) {
  ++t.answers;
  if (error > rounding) t.pessimism.push_back(bound / error);
  const double violation = q.truth.violation(error, bound / o.divide, rounding);
  t.evaluated += violation > 0 && violation < pass_below ? 1 : 0;
  if (violation < pass_below) return;
  if (t.violated++ < 3)
    std::cout << "violated: seed " << q.seed << ", " << subject << ": error " << error << ", bound " << bound
              << ", rounding " << rounding << '\n';
}

void judge_estimate(Tally& t, double estimate, double before) {
  t.estimates.push_back(estimate / before);
  t.below_half += estimate < before / 2 ? 1 : 0;
  t.below_tenth += estimate < before / 10 ? 1 : 0;
}

/// The answer of an operator after so many steps at most.
void check_operator(const Options& o, const OperatorRow& row, const Question& q, Tally& t, int steps = std::numeric_limits<int>::max()) {
  const auto op = row.make<double>();
  op->analyze(q.problem.structure);
  if (!op->update(q.problem, q.damping).ok()) return;
  Workspace<double> work(op->workspace());
  MatrixX<double> f(q.a.size(), 1);
  const Report r = op->solve(q.a, f, {0, steps}, work);
  if ((r.ok() || r.status == Status::not_converged) && r.error_bound >= 0)
    judge_bound(o, t, q, row.name, q.truth.errors(q.a, q.lambda, f.col(0)).energy, q.rounding, r.error_bound);
  const bool nothing_left = r.error_bound >= 0 && r.error_bound <= 8 * unit_roundoff<double> && r.error_estimate >= 0 &&
                            r.error_estimate <= 4 * unit_roundoff<double>;
  if (r.status == Status::not_converged && nothing_left && t.violated++ < 3)
    std::cout << "contradicted: seed " << q.seed << ", " << row.name << ": not_converged, bound " << r.error_bound << '\n';
}

/// (K) by the inversion lemma, the damping capped at R (J M⁻¹Jᵀ)_rr ≤ g; every entry off by up to `noise`, relative.
template <class F> class Correction {
 public:
  Correction(const Question& q, double g, double noise) : inverse_(g), noise_(noise), random_(q.seed), seed_(q.seed) {
    inverse_.analyze(*q.problem.structure);
  }
  /// M: the factor of the refinement this correction is for.
  [[nodiscard]] bool update(const Question& q, const Factor<double>& M) {
    return inverse_.update(q.problem, M).ok() && inverse_.update_damping(q.damping).ok();
  }
  void restart() { random_ = generators::Random(seed_); }
  [[nodiscard]] Index workspace() const { return inverse_.workspace(); }
  void operator()(const Question& q, const double* r1, const double* r2, double* d_nu, double* d_lambda, double* work) {
    inverse_.solve_kkt(r1, r2, d_nu, d_lambda, work);
    for (Index c = 0; c < q.problem.structure->dofs(); ++c) d_nu[c] *= off();
    for (Index r = 0; r < q.problem.structure->rows; ++r) d_lambda[r] *= off();
  }

 private:
  double off() { return 1 + noise_ * random_.integer(-8, 8) / 8; }
  CappedInverse<double, F> inverse_;
  double noise_;
  generators::Random random_;
  std::uint64_t seed_;
};

/// The iterates (ν, λ) of refinement.h after 0, 1, …, 5 steps.
template <class F> void check_refinement(const Options& o, const Question& q, double g, double noise, Tally& t) {
  const auto& exact = *q.truth.dense();
  Refinement<double> refinement;
  refinement.analyze(q.problem.structure);
  Correction<F> correct(q, g, noise);
  refinement.update(q.problem);
  if (!refinement.factor_mass().ok() || !correct.update(q, refinement.factor_M())) return;
  refinement.update_damping(q.damping);
  Workspace<double> work(refinement.workspace(correct.workspace()));
  VectorX<double> nu(exact.J.cols()), f(exact.J.rows());
  const VectorX<Quad> exact_nu = reference::product<Quad>(exact.M_inv_Jt, MatrixX<Quad>(q.lambda));
  const Quad total = q.truth.energy(q.lambda);
  double before = 0;
  for (int steps = 0; steps <= 5; ++steps) {
    correct.restart();
    const Report r = refinement.solve({.r2 = q.a.data()}, f.data(), Accuracy::full(), {steps},
                                      [&](auto... x) { correct(q, x...); }, work.data(), nu.data());
    if (r.error_bound < 0 || r.iterations < steps) return;
    const VectorX<Quad> motion = converted<Quad>(MatrixX<double>(nu)), force = converted<Quad>(MatrixX<double>(f));
    const auto size = [&](const MatrixX<Quad>& M, const MatrixX<Quad>& R_inverse, const VectorX<Quad>& x, const VectorX<Quad>& y) {
      const Quad of_x = norm(M, x), of_y = norm(R_inverse, y);
      return static_cast<double>(sqrt(of_x * of_x + of_y * of_y) / total);
    };
    const double rounding = unit_roundoff<double> * size(entrywise(exact.M), entrywise(exact.R_inverse),
                                                         entrywise(MatrixX<Quad>(motion)), entrywise(MatrixX<Quad>(force)));
    const double error = size(exact.M, exact.R_inverse, motion - exact_nu, force - q.lambda);
    judge_bound(o, t, q, "(ν, λ)", error, rounding, r.error_bound);
    const Errors e = q.truth.errors(q.a, q.lambda, f);
    judge_bound(o, t, q, "λ", e.energy, q.rounding, r.error_bound);
    const double now = std::max(e.force, error);
    if (now < before / 2) judge_estimate(t, r.error_estimate, before);
    before = now;
    if (r.ok()) return;
  }
}

bool check_problem(const Options& o, std::uint64_t seed, std::map<std::string, Tally>& tallies) {
  const Case c = make_case(generators::arbitrary(seed));
  const Structure& s = *c.problem.structure;
  if (s.rows == 0 || s.rows > 40 || s.dofs() == 0 || s.dofs() > 40 ) return false;
  if (o.hard && damped(c)) return false;
  const Truth truth(c.problem, c.damping);
  if (!truth.regular() || (!damped(c) && dependent_to_rounding(c))) return false;
  VectorX<double> a = vectors<double>(s.rows, 1, seed);
  if (seed % 2 == 0) a = truth.reachable(a);
  if (a.isZero(0)) return false;
  const VectorX<Quad> lambda = truth.solve(a);
  const Question q{c.problem, c.damping, truth, a, lambda, truth.rounding(lambda), seed};
  for (const OperatorRow& row : operators())  // one that iterates in maximal coordinates takes a thousand times as long
    if (row.solves && !(row.maximal && seed % 50 != 0)) check_operator(o, row, q, tallies[(damped(c) ? "" : "hard rows, ") + std::string(row.name)]);
  if (!damped(c))
    for (const OperatorRow& row : operators())
      if (row.solves && !(row.maximal && seed % 50 != 0)) check_operator(o, row, q, tallies["hard rows, no step, " + std::string(row.name)], 0);
  if (!damped(c)) return true;
  constexpr double uncapped = 1e300;
  check_refinement<double>(o, q, uncapped, 0, tallies["steps of lcaba"]);
  check_refinement<float>(o, q, 0x1p10, 0, tallies["steps of lcaba in float"]);
  check_refinement<double>(o, q, uncapped, 0.01, tallies["steps off by 1 %"]);
  return true;
}

std::string percent(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", x);
  return text;
}

/// Three digits; a dash when there are no values.
std::string quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return "–";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
  return text;
}

void print(const Options& o, std::map<std::string, Tally>& tallies) {
  std::puts(o.markdown ? "| answers of | bounds | violated | by its evaluation | error above rounding | bound / error: median | 90 % | 99 % | estimates | below half | below a tenth | estimate / error: least | 0.1 % | median |\n"
                         "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
                       : "answers of, bounds, violated, by its evaluation, error above rounding, bound / error: median, 90 %, 99 %, estimates, below half, below a tenth, estimate / error: least, 0.1 %, median");
  for (auto& [name, t] : tallies) {
    if (t.answers == 0) continue;
    std::sort(t.pessimism.begin(), t.pessimism.end());
    std::sort(t.estimates.begin(), t.estimates.end());
    const auto share = [total = t.estimates.size()](std::uint64_t k) {
      return total == 0 ? std::string("–") : percent(100 * static_cast<double>(k) / static_cast<double>(total));
    };
    std::printf(o.markdown ? "| %s | %llu | %llu | %llu | %zu | %s | %s | %s | %zu | %s | %s | %s | %s | %s |\n"
                           : "%-38s %8llu %4llu %4llu %8zu  %s %s %s  %8zu %s %s  %s %s %s\n",
                name.c_str(), static_cast<unsigned long long>(t.answers), static_cast<unsigned long long>(t.violated),
                static_cast<unsigned long long>(t.evaluated), t.pessimism.size(), quantile(t.pessimism, 0.5).c_str(), quantile(t.pessimism, 0.9).c_str(),
                quantile(t.pessimism, 0.99).c_str(), t.estimates.size(), share(t.below_half).c_str(), share(t.below_tenth).c_str(),
                quantile(t.estimates, 0).c_str(), quantile(t.estimates, 0.001).c_str(), quantile(t.estimates, 0.5).c_str());
  }
}

int run(const Options& o) {
  std::map<std::string, Tally> tallies;
  std::uint64_t problems = 0;
  for (std::uint64_t k = o.shard.number - 1; k < o.count; k += o.shard.of) problems += check_problem(o, o.seed + k, tallies) ? 1 : 0;
  std::printf("%llu problems of seeds %llu to %llu\n\n", static_cast<unsigned long long>(problems),
              static_cast<unsigned long long>(o.seed), static_cast<unsigned long long>(o.seed + o.count - 1));
  print(o, tallies);
  const bool violated = std::any_of(tallies.begin(), tallies.end(), [](const auto& t) { return t.second.violated > 0; });
  return violated || problems == 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Certificates of random problems against the truth (docs/hard_cases.md).\n"
               "Exit code 1 when one is violated."};
  Options o;
  app.add_option("--count", o.count, "problems, of all shards together")->check(options::whole(1))->capture_default_str();
  app.add_option("--seed", o.seed, "of the first")->check(options::whole(0))->capture_default_str();
  options::add_shard(app, o.shard);
  app.add_option("--divide", o.divide, "divide every bound by this: the program must fail")->check(options::above(0, ""))->capture_default_str();
  app.add_flag("--hard", o.hard, "only problems with a hard row");
  app.add_flag("--markdown", o.markdown, "a table for a page");
  return options::run(app, argc, argv, [&] { return run(o); });
}
