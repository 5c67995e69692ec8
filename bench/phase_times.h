// Times of the phases that a choice between rows is made of (algorithms/operators/choose.h): measured, and what they make of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/delassus.h"
#include "algorithms/operators/choose.h"

namespace delassus::bench {

/// One operator on one problem.
struct RowTimes {
  std::string op;
  bool is_explicit = false, certified = false;  ///< keeps a matrix of the rows; class refined
  PhaseTimes time{};                            ///< [µs], lower quartiles: a machine that is busy adds to times; NaN: no such answer, or one that is not ok
};
/// All of them timed in turn (interleaved.h). Cost: about `budget` seconds per phase and row.
[[nodiscard]] std::vector<RowTimes> phase_times(const Problem<double>& problem, const Damping<double>& damping,
                                                const std::vector<const OperatorRow*>& rows, double budget);

/// A kind of use, asked a number of times at one configuration.
struct Reuse {
  const char* name;
  Demand (*times)(double);
};
[[nodiscard]] const std::vector<Reuse>& reuses();

/// The fastest of those measured and the one that choose() names. NaN and empty where nobody has such an answer.
struct Pick {
  std::string best, chosen;
  double best_time = NAN, chosen_time = NAN;  ///< [µs] of all that is asked
  [[nodiscard]] double ratio() const { return chosen_time / best_time; }
};
[[nodiscard]] Pick pick(const std::vector<RowTimes>& rows, const Demand& use, const std::string& chosen);

/// From how many on the best explicit row is faster than the best matrix-free one, by the times measured: a whole number; NaN: never.
[[nodiscard]] double measured_crossover(const std::vector<RowTimes>& rows, const Reuse& reuse);

inline constexpr double reuse_counts[] = {1, 10, 1000};
inline constexpr double promised_ratio = 1.1;

struct ChoiceRow {
  std::string scene;
  std::int64_t dofs = 0, rows = 0;
  Quantities quantities;
  std::vector<RowTimes> times;
  double weight = 1;                            ///< in calibrated(): as so many problems
};
/// Rows chosen beyond the promise, and those that were faster.
[[nodiscard]] std::vector<std::string> doubtful(const ChoiceRow& row);
/// Of each phase the lower time, where it is in both.
void keep_lower(std::vector<RowTimes>& of, const std::vector<RowTimes>& again);
/// All rows in turn; then those that are doubtful by themselves, a few times, both ways: the fastest of two dozen is the luckiest, too.
[[nodiscard]] ChoiceRow measure_choice(const std::string& scene, const Problem<double>& problem, const Damping<double>& damping,
                                       const std::vector<const OperatorRow*>& rows, double budget);
/// A table in Markdown per kind of use: scene × reuse, with the crossovers measured and predicted, and the worst ratio below.
[[nodiscard]] std::string choices_text(const std::vector<ChoiceRow>& rows);
/// Of what is promised: all kinds of use but those with an error bound, whose steps no structure shows.
[[nodiscard]] double worst_ratio(const std::vector<ChoiceRow>& rows);

/// The table of kernels (kernel_costs.cpp) by least squares of relative errors on these, no term negative: the file's text.
[[nodiscard]] std::string calibrated(const std::vector<ChoiceRow>& rows);
/// Rows and phases that it has.
[[nodiscard]] std::vector<const OperatorRow*> calibrated_rows();
/// max |predicted/measured − 1| and its median, per row and phase, in Markdown.
[[nodiscard]] std::string predictions_text(const std::vector<ChoiceRow>& rows);

}  // namespace delassus::bench
