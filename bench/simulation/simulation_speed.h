// Steps per second of the examples (docs/examples.md), ours beside those of other programs: the same robot from the same state with the
// same step, compared before timed, timed in turn (interleaved.h), and every program's steps judged by one residual (step_residual.h).
//
// Compared   M, and ν̇ without rows, at a q beside the scene's and a ν that is not zero: gravity, velocity products, springs, motors and
//            wrenches are in it. An error above `same` and nothing of that row is timed.
// Judged     some thirty steps of a run from the start, evenly spread: median and largest. Two where n + m > 1000, none above 2000. A run that its program does not stand by is
//            judged and timed as far as it came, and says so.
// Ours         at the residual that the example asks for, and besides at that which each of the others reaches, in the middle: the same
//              accuracy, where theirs is the coarser.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "bench/peers/beside.h"
#include "bench/interleaved.h"
#include "bench/peers/simulator.h"
#include "bench/simulation/step_residual.h"

namespace delassus::bench {

inline constexpr double same = 0x1p-26;  ///< of M and ν̇, relative: half of double's digits
inline constexpr double most_asked = 1e-2, least_asked = 1e-12;  ///< residuals that ours is asked for [m/s]

struct SpeedExample {
  std::string name, scene;  ///< in a word; as open_scene takes it
  double residual = 1e-10;  ///< [m/s]
  int steps = 1000;
  bool robot = false;       ///< a robot in contact: where we want to be faster
  std::vector<std::string> without = {};
};
/// The lines of docs/examples.md. Linkages are stepped by Euler here, too: no program from outside has steps that follow their error.
[[nodiscard]] const std::vector<SpeedExample>& speed_examples();
inline constexpr double speed_step = 1e-3;  ///< [s]

/// One program at one setting on one example.
struct SpeedEntry {
  std::string name, program, what;  ///< program empty: ours
  std::string cannot;               ///< why it cannot express the scene; empty: it can
  std::string disagrees;            ///< what differs and by how much; then there are no times
  std::string ended;                ///< at which step its run ended before its time, and with which words; empty: it did not
  double M_error = NAN, free_error = NAN;
  double asked = NAN;               ///< of our solver [m/s]
  StepResidual median, worst;       ///< of each number by itself
  std::int64_t steps = 0;           ///< of a run
  std::int64_t contacts = 0, rows = 0;  ///< the most of a step
  double iterations = NAN;          ///< of the solver, mean of a step
  Spread time;                      ///< [µs] a step

  [[nodiscard]] bool ours() const { return program.empty(); }
  [[nodiscard]] double steps_per_second() const { return 1e6 / time.median; }
};

struct SpeedScene {
  SpeedExample example;
  std::int64_t dofs = 0;
  std::vector<SpeedEntry> entries;  ///< ours, the others in their order, ours at their residuals (where they are coarser)

  [[nodiscard]] const SpeedEntry* find(const std::string& name) const;
  /// The fastest of ours whose residual is not above theirs, in the middle, or the example's; null: none, or they were not timed.
  [[nodiscard]] const SpeedEntry* as_accurate_as(const std::string& theirs) const;
};

inline constexpr const char* own_name = "delassus";
/// Ours, asked for the residual of another.
[[nodiscard]] std::string own_name_at(const std::string& other);

struct SimulationSpeed : Beside {
  std::vector<SpeedScene> scenes;

  [[nodiscard]] int disagreements() const;
};

[[nodiscard]] SpeedScene measure_speed(const SpeedExample& example, const std::vector<SimulatorRow>& rows, double budget);
/// `examples`: names or scenes of speed_examples(), or any scene; none: all of them. `progress` is called with a line of text per example,
/// `stop` is asked before every one. @throws ModelError where `rows` is empty: what can be installed.
[[nodiscard]] SimulationSpeed measure_speed(const std::vector<std::string>& examples, const std::vector<SimulatorRow>& rows, double budget,
                                            const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop);

void to_json(nlohmann::json& j, const SimulationSpeed& s);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, SimulationSpeed& s);
/// Tables in Markdown: steps per second and residuals, where others are faster, what was left out.
[[nodiscard]] std::string speed_text(const SimulationSpeed& s);

}  // namespace delassus::bench
