// What accuracy costs in a whole simulation: the error of the trajectory against the time it takes, over integrator, solver or operator,
// tolerance and step.
//
// Errors are against the limit of refined steps, whose own error is estimated and shown (trajectory.h). Scenes with Coulomb's friction
// have two limits, of the exact law and of its convex relaxation. Of a run by the relaxation at step h,
//   error        against the limit of the exact law                        what its user gets
//   numerical    against the limit of the relaxation                       what a smaller step or a better solver removes
//   modelling    against the run by the exact law at the same step h       what the law alone changes
// The relaxation asks for u_n ≥ μ |u_t|: what begins to slide, or lands sliding, is thrown up at any step; what slides on is lifted by
// μ h |u_t|. So the modelling error may fall with the step or not: between_laws says which.
#pragma once

#include "bench/accuracy/trajectory.h"

namespace delassus::accuracy {

struct SimulationOptions {
  double duration = 1;                       ///< [s]
  double step = 1.0 / 64;                    ///< the largest [s]; errors are looked at after each of its like. A whole number of them is the duration
  int halvings = 5;                          ///< of the step
  std::vector<std::string> integrators, solvers, ops;  ///< empty: all integrators, all solvers of the table, ladder
  std::vector<double> tolerances;            ///< of solvers [m/s], operators and error control; empty: 1e-6 and 1e-10, of error control 1e-3 to 1e-11
  double longest = 20;                       ///< [s] a run that computes longer ends, and smaller steps of its line are not tried
  double budget = 0.25;                      ///< [s] of repeated timing for each run; 0: no times
  std::function<bool()> stop = {};           ///< looked at before every run; what follows is left out
  Runner runner = simulate;
};

/// One run.
struct SimulatedCell {
  double step = 0, tolerance = 0;            ///< [s]; of error control, 0: fixed steps
  std::string why_not;                       ///< it has no error and no time then; empty: it ran to the end
  Distance error, numerical, modelling;
  double order = std::numeric_limits<double>::quiet_NaN();  ///< seen from the cell before; where both errors are above thrice the reference's
  double seconds = std::numeric_limits<double>::quiet_NaN();  ///< of the steps: the lowest of up to five runs
  std::int64_t steps = 0, rejected = 0, iterations = 0;
};

/// One way to simulate, over its steps or tolerances.
struct SimulatedLine {
  std::string name;
  simulation::Settings settings;             ///< but for what varies along the line
  int order = 1;                             ///< declared
  bool relaxed = false, controlled = false;
  std::string why_not;                       ///< the scene is refused
  std::vector<SimulatedCell> cells;
};

struct SimulatedScene {
  std::string name;
  double duration = 0;
  Index bodies = 0, dofs = 0;
  int instants = 0;
  bool has_relaxed = false;
  std::string reference_by;                  ///< the line the references are the limits of
  double reference_step = 0;                 ///< the smallest [s]
  Reference reference, relaxed;              ///< of the exact law, of its relaxation
  Distance between_laws;                     ///< of the limits
  std::vector<SimulatedLine> lines;
};

/// The lines that a scene calls for. @throws ModelError for names that do not exist, and for solvers, operators or tolerances on which
/// nothing of the scene depends.
[[nodiscard]] std::vector<SimulatedLine> simulated_lines(const Scene& scene, const SimulationOptions& options);

/// @throws ModelError as above; for a duration that is not a whole number of steps.
[[nodiscard]] SimulatedScene measure_simulation(const Scene& scene, const SimulationOptions& options);

/// Time against error, metres or radians, whichever is more, both logarithmic. SVG; empty without gnuplot.
[[nodiscard]] std::string picture(const SimulatedScene& s);

}  // namespace delassus::accuracy
