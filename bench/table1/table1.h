// The paper's Table I, measured anew: thirteen scenes, every operator of the table, every column, and what the paper leaves out.
//
// Per scene all operators are timed in turn (interleaved.h), so that their ratios are of one run. Λ⁻¹ and Λ_R carry the scene's R⁻¹.
// Explicit operators factor A in `update`; who wants products alone does not need that, and Table I does not count it: the first
// product of an operator that also solves is taken without what update_damping repeats, round by round.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/interleaved.h"
#include "bench/results.h"
#include "bench/table1/uses.h"
#include "models/scene.h"

namespace delassus::bench {

inline constexpr const char* free_product = "aba_sweep";   ///< the paper's matrix-free Λ⁻¹
inline constexpr const char* free_inverse = "lcaba";       ///< and its Λ_R
inline constexpr const char* certified_inverse = "lcaba_refined";
inline constexpr const char* explicit_baseline = "ltl_osim";

/// One operator on one scene.
struct Entry {
  std::string op;
  bool is_explicit = false;                   ///< keeps a dense matrix of the rows
  std::array<Spread, use_count> time;         ///< [µs]; first_apply without the factor of A
  std::array<std::string, use_count> why_not; ///< why there is none (Asked::why_not)
  std::array<std::int64_t, use_count> lines;  ///< distinct cache lines read or written; −1: not counted
  std::int64_t bytes = -1;
  double product_error = NAN;                 ///< max|δa| / max|a| of a = A x
  double force_error = NAN, motion_error = NAN;  ///< max|δλ| / max|λ|; ‖δν‖_M / ‖ν‖_M (accuracy_truth.h)
  double bound = -1;                          ///< the certificate of the solve; −1: none

  Entry() { lines.fill(-1); }
  [[nodiscard]] const Spread& of(Use use) const { return time[static_cast<std::size_t>(use)]; }
  [[nodiscard]] bool has(Use use) const { return of(use).measured(); }
  /// [µs]; NaN: none.
  [[nodiscard]] double median(Use use) const { return of(use).median; }
  [[nodiscard]] double worst_error() const;   ///< NaN: none was measured
};

struct TableRow {
  std::string scene;
  std::int64_t dofs = 0, rows = 0;
  bool loops = false, provisional_pose = false;
  double smallest_damping = 0, largest_damping = 0;  ///< of R⁻¹ [1/kg]
  double condition = NAN;                     ///< κ(A)
  std::string product_reference;              ///< of product_error, name in the table of references
  std::string truth_unknown;                  ///< why errors of solves were not measured; empty: they were
  Spread kinematics;                          ///< [µs]
  std::vector<Entry> entries;                 ///< in the order of the table of operators

  /// nullptr: there is none of that name.
  [[nodiscard]] const Entry* find(const std::string& op) const;
  /// The operator of least cost for `use`, among those that keep a matrix or among the others; nullptr: none has an answer.
  [[nodiscard]] const Entry* best(Use use, bool is_explicit) const;
};

struct TableOne {
  Machine machine;
  std::string kernels, lines_counted_with;    ///< kernels of the probe that counted cache lines; empty: not counted
  double budget = 0, load = 0;                ///< seconds per operator and use; load average of the machine at the start
  bool interrupted = false;
  std::vector<TableRow> rows;
};

struct TableOptions {
  std::vector<std::string> scenes;            ///< empty: those of the paper
  std::vector<const OperatorRow*> ops;        ///< empty: all
  double budget = 0.03;
  std::string probe;                          ///< phase_probe that valgrind can run; empty: cache lines are not counted
  std::function<bool()> stop;                 ///< asked before every scene
};

[[nodiscard]] TableRow measure_row(const Scene& scene, const std::vector<const OperatorRow*>& ops, double budget);
/// `progress` is called with a line of text per scene. @throws ModelError for an unknown scene, and when the probe cannot be run.
[[nodiscard]] TableOne measure_table(const TableOptions& options, const std::function<void(const std::string&)>& progress);

void to_json(nlohmann::json& j, const TableOne& t);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, TableOne& t);

/// Tables in Markdown, aligned for terminals: Λ⁻¹ and Λ_R first, again, memory, accuracy, who wins, every operator.
[[nodiscard]] std::string table_text(const TableOne& t);

/// Products or solves at one configuration from which on the best explicit operator costs less than the best matrix-free one: 1: always;
/// NaN: never.
[[nodiscard]] double crossover(const TableRow& row, Use first, Use again);

}  // namespace delassus::bench
