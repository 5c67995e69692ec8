// The figures of the paper's Table I, as printed there (Core Ultra 7 165H, clang 21): times in µs, distinct cache lines in thousands,
// memory in kB.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace delassus::bench {

struct PaperFigures {
  double time, lines, kilobytes;
};
struct PaperRow {
  const char *scene, *label;   ///< ours, and the paper's name for it
  std::int64_t points, rows;
  PaperFigures free_apply, explicit_apply, free_solve, explicit_solve;   ///< Λ⁻¹ and Λ_R, first evaluation
  double free_again[3], explicit_again[3];                               ///< Λ⁻¹ again, Λ_R again, Λ'_R
};
/// The thirteen rows in the paper's order.
[[nodiscard]] const std::vector<PaperRow>& paper_rows();
/// @throws std::out_of_range for a scene that is none of them.
[[nodiscard]] const PaperRow& paper_row(const std::string& scene);

}  // namespace delassus::bench
