// The paper's Fig. 2, measured anew: swimmers of growing length, every operator until it exceeds a budget, slopes of the upper decade.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/results.h"

namespace delassus::bench {

/// One operator at one length. NaN and −1: it has no such answer, or was not counted.
struct SwimmerCell {
  std::string op, skipped;               ///< skipped: why it was left out from here on; empty: it was not
  double product = NAN, solve = NAN;     ///< first evaluations [µs], lowest; the product without the factor of A (table1.h)
  double product_operations = NAN, solve_operations = NAN;
  std::int64_t bytes = -1;
};
struct SwimmerSize {
  std::int64_t links = 0, dofs = 0, rows = 0;
  double kinematics = NAN;               ///< [µs]
  std::vector<SwimmerCell> cells;
};
struct Figure2 {
  Machine machine;
  double longest = 1, most_bytes = 1e9;  ///< the budget: seconds of a phase, bytes of an operator
  std::vector<SwimmerSize> sizes;
};

/// From 3 links to `largest`; `progress` and `stop` as climb (ladder.h).
[[nodiscard]] Figure2 measure_swimmers(std::int64_t largest, double budget, double longest, double most_bytes,
                                       const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop = {});

/// Slope of log y over log x by least squares, of the points within a factor of ten of the largest x; NaN with fewer than two.
[[nodiscard]] double slope(const std::vector<std::pair<double, double>>& points);

/// The slopes, how far each operator came and why it was left out, in Markdown.
[[nodiscard]] std::string figure2_text(const Figure2& f);
/// First products, or first solves, over the length: an SVG; empty without gnuplot.
[[nodiscard]] std::string figure2_picture(const Figure2& f, bool solves);

void to_json(nlohmann::json& j, const Figure2& f);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, Figure2& f);

}  // namespace delassus::bench
