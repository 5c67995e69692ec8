#include "bench/instruction_gate.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/text.h"

namespace delassus::bench {

const std::vector<std::pair<std::string, std::vector<std::string>>>& gated_cells() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> cells{
      {"go2_standing", {"aba_sweep/first_apply", "lcaba/first_solve", "lcaba_refined/first_solve", "lcaba_qr/first_solve", "ltl_osim/first_solve"}},
      {"cassie", {"lcaba/new_damping", "ltl_osim/solve"}},
      {"g1_fallen_friction", {"aba_sweep/apply", "lcaba/first_solve", "lcaba_refined/solve"}},
      {"boxes_tower", {"aba_sweep/first_apply", "lcaba/first_solve"}}};
  return cells;
}

InstructionVerdict judge_instructions(const nlohmann::json& baseline, const nlohmann::json& counted) {
  InstructionVerdict v;
  for (const auto& [cell, before] : baseline.items())
    if (!counted.contains(cell)) v.lines.push_back(cell + "  not counted"), ++v.off;
  for (const auto& [cell, now] : counted.items()) {
    if (!baseline.contains(cell)) {
      v.lines.push_back(cell + "  is not in the baseline"), ++v.off;
      continue;
    }
    const double change = now.get<double>() / baseline[cell].get<double>() - 1;
    const bool good = std::fabs(change) <= instruction_tolerance;
    v.off += !good;
    v.lines.push_back(pad_right(cell, 46) + pad_left(now.dump(), 10) + format("  %+.2f %%  ", 100 * change) + (good ? "ok" : change > 0 ? "MORE INSTRUCTIONS" : "FEWER INSTRUCTIONS: the baseline is stale"));
  }
  return v;
}

}  // namespace delassus::bench
