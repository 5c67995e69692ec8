// The graded problems: mechanisms from easy to hopeless, each at constraints from soft to nearly rigid.
//
//   for (const Mechanism& m : mechanisms())
//     for (const Level& l : levels) …
#pragma once

#include "property_tests/campaigns/answered.h"

namespace delassus::laws {

/// A member of a family, and what it stands for.
struct Mechanism {
  std::string_view family;
  Index n;
  std::string_view what;
};
[[nodiscard]] const std::vector<Mechanism>& mechanisms();

/// Decades between which R λmax(J M⁻¹Jᵀ) is drawn, row by row.
struct Level {
  std::string_view name;
  int low, high;
};
inline constexpr Level levels[] = {{"1e-2", -2, -2}, {"1e2", 2, 2},    {"1e4", 4, 4},    {"1e6", 6, 6},  {"1e8", 8, 8},
                                   {"1e10", 10, 10}, {"1e12", 12, 12}, {"1e14", 14, 14}, {"mixed", -8, 12}};

/// λmax(J M⁻¹Jᵀ) [1/kg]. Cost m sweeps and m³.
[[nodiscard]] double largest_eigenvalue(const Problem<double>& problem);
/// R⁻¹ = λmax 10^−decade, the decade drawn for every row.
[[nodiscard]] Damping<double> damping_at(const Level& level, double largest_eigenvalue, Index rows, std::uint64_t seed);
/// J ν, summed in Quad and rounded once. Shapes: n to m.
[[nodiscard]] VectorX<double> constraint_acceleration(const Problem<double>& problem, const VectorX<double>& nu);

}  // namespace delassus::laws
