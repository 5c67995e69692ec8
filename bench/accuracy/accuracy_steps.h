// How an iteration comes to its answer: errors, certificate and estimate after 0, 1, 2, … steps.
#pragma once

#include "bench/accuracy/accuracy.h"

namespace delassus::accuracy {

/// The answer after at most `steps` steps (Accuracy::steps).
struct Step {
  int steps = 0;
  std::string status;
  Errors errors;
  double error_bound = -1, error_estimate = -1;
};

/// Of one rung, up to where it ends by itself.
struct Path {
  std::string rung, status;   ///< the status at the end; when the update fails that is all there is
  int style = 0;
  std::vector<Step> steps;
};

/// Of one subject at one damping.
struct Convergence {
  std::string name;
  Index dofs = 0, rows = 0;
  double damping = 0;         ///< R⁻¹ of every row [1/kg], or own_damping
  double largest_eigenvalue = 0, condition = 0;
  std::string no_reference;   ///< why errors are not known; empty: they are
  std::vector<Path> paths;
};

/// Of the operators among the rungs: refinement, proximal iterations, Krylov iterations; those that take no steps have one point. Every point
/// is a solve of its own; beyond 16 steps each lies an eighth further than the one before. `damping` may be 0: hard rows.
/// @throws std::runtime_error when M is singular.
[[nodiscard]] Convergence converge(const Subject& subject, const std::vector<Rung>& rungs, double damping, const Options& options);

/// Motion error against the number of evaluations (steps + 1), both logarithmic. SVG; empty without gnuplot.
[[nodiscard]] std::string picture(const Convergence& c);

}  // namespace delassus::accuracy
