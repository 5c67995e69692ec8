// The main job: check and time every operator on every scene, write the page and the numbers.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "algorithms/delassus.h"
#include "bench/results.h"
#include "models/scene.h"

namespace delassus::bench {

struct ReportOptions {
  std::vector<std::string> scenes;   ///< names; empty: every scene that comes with the library
  bool quick = false;                ///< shorter timings, ladder to 1000 links, checks on scenes of up to 120 rows
  bool check = true;                 ///< hold the laws
  bool ladder = true;                ///< climb the swimmers; with `ops` never
  std::vector<const OperatorRow*> ops;  ///< these operators; empty: all
  std::function<bool()> stop;        ///< looked at before every scene, size and law; what follows is left out, and said
  SceneOptions opening;              ///< how `scenes` are opened; their warnings become notes of the page
};

using Progress = std::function<void(const std::string&)>;

/// Runs everything. Checks run on all cores, one scene each; timings run alone. @throws ModelError for an unknown scene.
[[nodiscard]] Results run_report(const ReportOptions& options, const Progress& progress);

/// Makes DIR and a file in it, so that a wrong one is refused before anything is measured. @throws ModelError when it cannot.
void check_writable(const std::filesystem::path& directory);

/// Writes DIR/index.html and DIR/results.json. @throws ModelError when DIR cannot be written.
void write_report(const Results& results, const std::filesystem::path& directory);

/// 0, or 1 when a law that was checked is broken.
[[nodiscard]] int exit_code(const Results& results);

/// Scenes × operators as plain text: rows, worst ratio, update, apply and solve times.
[[nodiscard]] std::string text_table(const Results& results);

}  // namespace delassus::bench
