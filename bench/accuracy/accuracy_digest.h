// What a campaign of measurements comes to: the claims, the costs, the digits kept, the picture.
#pragma once

#include "bench/accuracy/accuracy.h"

namespace delassus::accuracy {

/// The claim about a rung: on every scene at R⁻¹ from 1e-14 to 1e-2 its motion error is below this, its certificate true,
/// and λ within 30 roundings of the largest force (a residual in plain double passes the first two, not this).
inline constexpr double claimed_motion = 1e-10, claimed_lambda = 30 * 0x1p-53, claimed_from = 1e-14, claimed_to = 1e-2;
/// What the default and the QR rung may cost, relative to the paper's formula.
inline constexpr double aimed_default = 1.6, aimed_qr = 4;

/// The claim about one rung on one scene at one place. Errors are the worst over the claimed dampings; infinite where there was no answer.
struct Claim {
  std::string scene, rung;
  double away = 0;
  double motion = 0, lambda = 0;
  double motion_damping = 0, lambda_damping = 0;   ///< where they occurred
  double condition = 0;                            ///< κ_∞(A) where λ's did; NaN: not known
  int certificates = 0, levels = 0;                ///< true ones, of so many
  double fast = 0, world = 0;                      ///< motion error of lcaba, and of lcaba about the world's origin; NaN: not run

  [[nodiscard]] bool holds() const { return motion < claimed_motion && lambda < claimed_lambda && certificates == levels; }
};
/// None for tables that are of no scene, lack the rung, or have none of the claimed dampings.
[[nodiscard]] std::vector<Claim> claims(const std::vector<Table>& tables, const std::string& rung);

/// Median cost of a rung over all scenes and claimed dampings, relative to lcaba at the same place; NaN: not measured.
struct Cost {
  std::string rung;
  double time, operations;
  int points, timed, counted;   ///< scenes × dampings, and where there was a time (an answer) and a count
};
[[nodiscard]] std::vector<Cost> costs(const std::vector<Table>& tables);

/// Cells of a printed table, its head first.
using Grid = std::vector<std::vector<std::string>>;
[[nodiscard]] Grid claims_grid(const std::vector<Claim>& claims);
[[nodiscard]] Grid costs_grid(const std::vector<Cost>& costs);
/// Digits kept, motion/λ, of every rung (columns) on every table (rows) at its first level.
[[nodiscard]] Grid digits_grid(const std::vector<Table>& tables);
[[nodiscard]] std::string markdown(const Grid& grid);
[[nodiscard]] std::string html(const Grid& grid, const std::string& caption);

enum class Price : bool { time, operations };

/// Motion error against price, one line per rung from the stiffest damping (ringed) on. SVG; empty without gnuplot.
[[nodiscard]] std::string picture(const Table& table, Price price);
/// Worst motion error over the tables against the median price relative to lcaba: four points per rung, for R⁻¹ ≤ 1e-10,
/// ≤ 1e-6, ≤ 1e-2 and above.
[[nodiscard]] std::string overview(const std::vector<Table>& tables, Price price);

/// 16 for an exact answer, 0 for one without a correct digit.
[[nodiscard]] double digits(double error);

}  // namespace delassus::accuracy
