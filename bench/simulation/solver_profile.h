// Contact solvers held against each other: every solver of a table on every problem, at several wanted residuals.
//
// Solved   the natural residual of the impulse that came back, computed in Quad by code that shares nothing with the solvers
//          (reference/contact_residual.h), is at most wanted × the largest |g − target|. What the solver says of itself does not count; where it says
//          ok and is not, that is a failure of its own kind.
// Tighter  An answer that meets a tighter target meets a looser one: after a failure the tighter ones are not tried and count as it does.
// Time     of solve, update of the numbers included, cold start, clock of the thread; the least of three where it is short.
// Profile  ρ(τ): share of the problems that a solver solves within τ times what the best one needs there. Refused and failed: never.
// Source   E. Dolan, J. Moré 2002 (performance profiles); V. Acary, M. Brémond, O. Huber 2018 (success over the density of contacts).
#pragma once

#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/results.h"
#include "bench/simulation/solver_problems.h"
#include "simulation/solvers.h"

namespace delassus::bench {

inline constexpr std::array<double, 3> wanted_residuals{1e-4, 1e-8, 1e-12};
inline constexpr std::size_t wanted_count = wanted_residuals.size();

struct SolverRun {
  std::string outcome;        ///< "solved", "refused", "says_ok" (it is not), or the status it ended with
  int iterations = 0;         ///< as the solver counts them
  double microseconds = NAN;
  double residual = NAN;      ///< natural, in Quad, over the largest |g − target|
  [[nodiscard]] bool solved() const { return outcome == "solved"; }
  [[nodiscard]] bool refused() const { return outcome == "refused"; }
};
using Runs = std::array<SolverRun, wanted_count>;

struct ProfiledProblem {
  std::string set, name;
  double density = NAN;       ///< 3 n_c / n; NaN: a given matrix
  std::int64_t rows = 0, rank = 0;  ///< rank of G: pivots above 1e-10 of the largest
  std::vector<Runs> runs;     ///< in the order of the solvers
};

struct SolverProfile {
  Machine machine;
  int iterations = 0;         ///< that a solver had at most
  bool interrupted = false;
  std::vector<std::string> solvers;
  std::vector<ProfiledProblem> problems;
};

/// One problem, every solver. `rows`: a table of solvers.
[[nodiscard]] ProfiledProblem profile_problem(const SolverProblem& p, const std::vector<simulation::SolverRow>& rows, int iterations);
/// `progress` is called with a line of text per set and density; `stop` is asked before every problem.
[[nodiscard]] SolverProfile profile_solvers(const std::vector<SolverProblem>& problems, const std::vector<simulation::SolverRow>& rows, int iterations,
                                            const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop = {});

/// What is compared: time, or iterations (of different solvers they cost differently).
enum class Measure : bool { time, iterations };
/// ρ of a solver at τ over the problems of a set, at the wanted residual of that place. NaN: the set is empty.
[[nodiscard]] double profile_at(const SolverProfile& p, const std::string& set, std::size_t solver, std::size_t wanted, Measure by, double tau);

/// Success by density, by rank and elsewhere; failures by status, iterations, time; profiles. Markdown.
[[nodiscard]] std::string solver_text(const SolverProfile& p);
/// The profile of a set: an SVG; empty without gnuplot, and where the set has no problem.
[[nodiscard]] std::string solver_picture(const SolverProfile& p, const std::string& set, std::size_t wanted, Measure by);
/// Sets in the order they are met.
[[nodiscard]] std::vector<std::string> sets_of(const SolverProfile& p);

void to_json(nlohmann::json& j, const SolverProfile& p);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, SolverProfile& p);
/// The JSON as text, a line per problem.
[[nodiscard]] std::string solver_json(const SolverProfile& p);

}  // namespace delassus::bench
