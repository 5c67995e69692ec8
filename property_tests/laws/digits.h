// How many digits each link costs: the recursions that ship, run on Stochastic (algorithms/kit/stochastic.h).
//
//   apply   a = J M⁻¹ Jᵀ x + R⁻¹ x             as aba_sweep
//   solve   f = R x − R J M_R⁻¹ Jᵀ R x          as lcaba: the direct formula
//
// The problem's numbers are taken as exact: only roundings count, not the data's own uncertainty.
// Vectors visit every joint (Branches::all), so that links without rows are shown too.
// Digits of several numbers together are those of their weighted 2-norm, with weights that take the units away:
//   inertia H_ii  its entries by √(H_rr H_cc)       D⁻¹u, ν   by D (the energy of the joint)
//   acceleration  a_i by the diagonal of H_ii       rows      together: unweighted
// The cost of a part is found by rounding to nearest before a point of the computation and at random from there on: the
// cost is what the result loses when that point moves from behind the part to before it, at least 0. (Rounding at random
// in one part only would not do: its perturbations stir the roundings of all that follows.) Each figure
// pools `cost_runs` runs: of few roundings, three samples often agree by chance. Two figures of equal true digits differ
// by more than `clear_cost` less than twice in 10⁵ times: the ratio F(16, 16) of their variances exceeds 10.
#pragma once

#include <string_view>
#include <vector>

#include "algorithms/errors/status.h"
#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::digits {

inline constexpr int cost_runs = 8;
inline constexpr double clear_cost = 0.5;  ///< log10 √10

enum class Computation : std::uint8_t { apply, solve };

/// Digits kept on one link, between 0 and most_digits.
struct Link {
  Index body;
  double inertia;       ///< H_ii when its step runs
  double pivot;         ///< D_i⁻¹, its worst column
  double backward;      ///< D_i⁻¹ u_i
  double forward;       ///< ν_i
  double acceleration;  ///< a_i
  double cost;          ///< digits of the result this link's step of the factor takes; NaN: not asked for
  [[nodiscard]] double fewest() const;
};

/// A part of the computation: the digits its own numbers keep, and those of the result it takes (NaN: not asked for).
struct Stage {
  std::string_view name;
  double kept, cost;
};

struct Measured {
  Report report;                    ///< lost_pivot, zero_damping; then everything below is empty
  std::vector<Link> links;          ///< in order of bodies
  std::vector<Stochastic> motion;   ///< J ν: J M⁻¹ Jᵀ x, or J M_R⁻¹ Jᵀ R x
  std::vector<Stochastic> result;
  std::vector<Stage> stages;        ///< in the order of the computation
};

/// Which costs to find: none (one run), those of the stages, or those of the links too, O(N²) instead of O(N).
enum class Costs : std::uint8_t { none, of_stages, of_links_too };

/// x: m numbers. The same seed gives the same digits. With random rounding off (random_rounding) it stays off. @throws std::logic_error when sizes do not fit.
[[nodiscard]] Measured measure(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& x,
                               Computation computation, std::uint64_t seed, Costs costs = Costs::none);

}  // namespace delassus::digits
