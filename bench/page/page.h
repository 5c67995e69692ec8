// The report as one self-contained HTML page: no other file, no network, no script; readable on a phone, in print and
// without colour.
#pragma once

#include <string>

#include "bench/results.h"

namespace delassus::bench {

/// The whole document.
[[nodiscard]] std::string page(const Results& results);

// Its sections, in order.
[[nodiscard]] std::string summary_section(const Results& results);
[[nodiscard]] std::string choosing_section(const Results& results);
[[nodiscard]] std::string overview_section(const Results& results);
[[nodiscard]] std::string accuracy_section(const Results& results);
[[nodiscard]] std::string ladder_section(const Results& results);
[[nodiscard]] std::string scenes_section(const Results& results);
[[nodiscard]] std::string laws_section(const Results& results);
[[nodiscard]] std::string operators_section(const Results& results);
[[nodiscard]] std::string machine_section(const Results& results);

/// The style sheet.
[[nodiscard]] const char* page_style();

/// `✓ 2.31` or `✗ 45.2`: the worst ratio of a cell as a table cell `<td>`.
[[nodiscard]] std::string verdict_cell(const Cell& cell);
/// A name that may be broken after its underscores.
[[nodiscard]] std::string breakable(const std::string& name);
/// Lowest time [µs] as a table cell `<td>`, the median in its title; `mark` for the fastest of a row.
[[nodiscard]] std::string time_cell(const Timing& t, bool mark = false);

}  // namespace delassus::bench
