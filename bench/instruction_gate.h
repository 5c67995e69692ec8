// Gate on instructions: some cells of operator and use, counted by callgrind, against a committed baseline within 2 %.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace delassus::bench {

inline constexpr double instruction_tolerance = 0.02;   ///< relative, either way: fewer make the baseline stale

/// scene → `operator/use`; the cells of the gate.
[[nodiscard]] const std::vector<std::pair<std::string, std::vector<std::string>>>& gated_cells();

struct InstructionVerdict {
  std::vector<std::string> lines;   ///< a cell each
  int off = 0;                      ///< cells outside the tolerance, and cells that only one side has
};
/// Objects `scene operator/use` → instructions.
[[nodiscard]] InstructionVerdict judge_instructions(const nlohmann::json& baseline, const nlohmann::json& counted);

}  // namespace delassus::bench
