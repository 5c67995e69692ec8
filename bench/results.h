// What a run of the bench measured: plain values, written as JSON (DIR/results.json) and as a page (DIR/index.html).
// Times in µs, operations counted (additions, multiplications, divisions, square roots), memory in bytes; NaN or −1:
// not measured.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/stopwatch.h"

namespace delassus::bench {

/// The phases of an operator that are timed and counted; `analyze` is timed only.
struct Phases {
  Timing analyze, update, new_damping, apply, solve;
  Timing unrefined;   ///< of a solve without refinement and certificate, by operators that have them
};
struct Operations {
  std::int64_t update = -1, new_damping = -1, apply = -1, solve = -1;
};

/// One law on one operator and one problem.
struct LawResult {
  std::string law;
  double ratio = 0;        ///< error / (eps · bound); a law holds below 30
  bool passed = true;
  std::string skipped;     ///< why the law does not apply here; empty: it was checked
  std::string note;        ///< what went wrong when it is not a matter of size
  bool left_out = false;   ///< skipped although it applies: for want of time, or interrupted
};

/// One operator on one problem.
struct Cell {
  std::string op;
  Phases time;
  Operations operations;
  std::int64_t bytes = -1, workspace_bytes = -1;
  std::string solve_status, update_status;   ///< name of the Report's status; empty: not run
  std::string skipped;                       ///< why nothing was measured; empty: it was
  std::vector<LawResult> laws;

  [[nodiscard]] int checked() const;
  [[nodiscard]] int failed() const;
  [[nodiscard]] int left_out() const;
  /// Whether a law against an independent definition was checked.
  [[nodiscard]] bool against_definition() const;
  /// Whether a phase ended with an answer: a time without one is none.
  [[nodiscard]] bool answered(Timing Phases::*phase) const {
    const bool updated = update_status.empty() || update_status == "ok";
    return phase == &Phases::analyze || (updated && (phase != &Phases::solve || solved()));
  }
  [[nodiscard]] bool solved() const { return solve_status.empty() || solve_status == "ok"; }
  /// The checked law with the largest ratio; nullptr when none was checked.
  [[nodiscard]] const LawResult* worst() const;
};

/// One scene and every operator on it.
struct SceneResult {
  std::string name, summary;   ///< summary: robots, contacts, loops in words
  std::int64_t bodies = 0, dofs = 0, rows = 0, trees = 0;
  bool has_loops = false, provisional_pose = false;
  double loop_residual = 0;    ///< largest closure error after assembly [m or rad]
  double smallest_damping = 0, largest_damping = 0;  ///< of R⁻¹ [1/kg]
  Timing kinematics;
  std::string picture;         ///< SVG
  std::vector<std::string> notes;
  std::vector<Cell> cells;
};

/// One size of the ladder and every operator on it.
struct Rung {
  std::int64_t links = 0, dofs = 0, rows = 0;
  Timing kinematics;
  std::vector<Cell> cells;
};

/// One row of the table of operators, as printed.
struct OperatorInfo {
  std::string name, summary, formula, source, cost, apply_error, solve_error;
  bool applies = false, solves = false, zero_damping = false;
};

/// One row of the table of laws (detail: its bound) or of references (detail: where it can be trusted), as printed.
struct RowInfo {
  std::string name, text, detail;
};

/// Accuracy against time, as shown.
struct AccuracyResult {
  std::string overview;                            ///< SVG: worst motion error against relative time
  std::vector<std::vector<std::string>> digits;    ///< digits kept, rungs on families; the head first
  std::vector<std::string> left_out;               ///< for want of time
};

struct Machine {
  std::string processor, system, compiler, flags, revision, date;
  int cores = 0;
};

struct Results {
  Machine machine;
  bool quick = false;
  bool chosen = false;         ///< scenes were asked for by name: the page is about them first
  bool interrupted = false;    ///< ended before its time
  double seconds = 0;          ///< duration of the run
  std::vector<OperatorInfo> operators;
  std::vector<RowInfo> laws, references;
  std::vector<SceneResult> scenes;
  std::vector<Rung> ladder;
  AccuracyResult accuracy;

  [[nodiscard]] int checked() const;
  [[nodiscard]] int failed() const;
  [[nodiscard]] int left_out() const;   ///< laws that apply and were not checked
};

void to_json(nlohmann::json& j, const Results& r);
void to_json(nlohmann::json& j, const SceneResult& s);
void to_json(nlohmann::json& j, const Rung& r);
void to_json(nlohmann::json& j, const Cell& c);

}  // namespace delassus::bench
