// Where the bodies of a moving scene are at equal instants, how far two such trajectories are apart, and what they go to with the step.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "models/scene.h"
#include "simulation/step.h"

namespace delassus::accuracy {

/// Of a body: its centre of mass is at `reference` + `centre` in the world [m]; world from body axes.
struct Placement {
  Vector3<double> reference, centre;
  Matrix3<double> rotation;
};

/// What became of a run.
struct Trajectory {
  std::vector<std::vector<Placement>> at;  ///< per instant, per body
  std::string why_not;                     ///< why it ended before the last instant, and when; empty: it did not
  bool refused = false;                    ///< before the first step
  bool too_long = false;
  double seconds = std::numeric_limits<double>::quiet_NaN();  ///< of steps alone, by the clock of the thread
  std::int64_t steps = 0, rejected = 0, iterations = 0;
  [[nodiscard]] bool ok() const { return why_not.empty(); }
};

/// `instants` equal intervals, each of so many steps of settings.step. A run that computes longer than `longest` [s] ends.
struct Run {
  simulation::Settings settings;
  int instants = 1;
  std::int64_t steps_each = 1;
  double longest = 60;
};
/// By the simulation; tests put something else with a known error in its place.
using Runner = std::function<Trajectory(const Scene& scene, const Run& run)>;
[[nodiscard]] Trajectory simulate(const Scene& scene, const Run& run);

/// The largest over the instants of the root mean square over the bodies: of the distance of the centres of mass, and of the angle of
/// the turn between the two rotations.
struct Distance {
  double metres = std::numeric_limits<double>::quiet_NaN(), radians = std::numeric_limits<double>::quiet_NaN();
  /// A radian for a metre: of ratios only.
  [[nodiscard]] double size() const { return metres + radians; }
};
/// NaN where one of them did not reach the last instant.
[[nodiscard]] Distance distance(const Trajectory& a, const Trajectory& b);

/// fine + (fine − coarse)/(2^order − 1), on the manifold: the limit of runs with h and 2h to the next order.
[[nodiscard]] Trajectory extrapolated(const Trajectory& fine, const Trajectory& coarse, int order);

/// The trajectory that errors are taken against.
struct Reference {
  Trajectory limit;
  Distance error;             ///< its own, estimated
  double order = std::numeric_limits<double>::quiet_NaN();  ///< seen from h, 2h, 4h
  bool extrapolates = false;  ///< the order seen is the declared one; otherwise the limit is the run with h
  std::string why_not;        ///< there is none
};

/// From runs with h, 2h and 4h of a method of that order. Where the order seen is within 0.3 of it: the extrapolation X_h, its error
/// estimated by |X_h − X_2h|. Elsewhere the run with h, by |x_h − x_2h|/(2^q − 1) with the order seen, q, held between ½ and the declared one.
[[nodiscard]] Reference reference_of(const Trajectory& h, const Trajectory& h2, const Trajectory& h4, int order);

}  // namespace delassus::accuracy
