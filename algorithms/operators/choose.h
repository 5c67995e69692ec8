// Which row of the table answers cheapest: explicit or matrix-free, from the structure and from how often it is asked.
//
// What     an explicit row pays once for a matrix and then for its entries per answer; a matrix-free one pays per answer for the way through
//          the tree. Which is cheaper depends on n, m, where rows act, on the number of columns, and on how many answers one
//          configuration has to give.
// Formula  cost(row, use) = U + d D + p P_k + s S_k,  each of them Σ_j c_j q_j: quantities q counted in the structure
//          (Quantities: bodies, degrees of freedom and rows that a sweep visits, entries that a matrix has) times nanoseconds c
//          of this row's kernel per unit of each (kernel_costs.cpp, measured: `delassus bench --calibrate` prints that file).
//          k columns: eight at a time where the row's kernel has lanes (columns.h), the others one by one.
// Left out what no structure shows: how many refinement steps or rungs a certified solve needs. Its cost is that of the usual number.
// Cost     two symbolic eliminations (plan.h, coupled_rows.h); no timing is taken: the same structure and use give the same row on every machine.
// Held     `delassus bench --choose`: against the fastest of all rows on every scene, 1, 10 and 1000 times.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// What is asked at one configuration, after one update.
struct Demand {
  double products = 0;     ///< A f, how often
  double solves = 0;       ///< A⁻¹ a, how often
  double dampings = 0;     ///< other R⁻¹, how often
  Index columns = 1;       ///< of every right-hand side
  bool certified = false;  ///< solves with an error bound: rows of class refined, which serve hard rows too
};

/// Rows of the table by name: one for the products and one for the solves, the same where one matrix serves both. Empty: not asked.
struct Choice {
  std::string_view product, solve;
  double nanoseconds = 0;  ///< predicted
};

/// What is counted in a structure.
struct Quantities {
  enum Name : std::uint8_t {
    one,
    bodies, dofs,                 ///< N, n: what an update visits
    active_bodies, active_dofs,   ///< what a vector visits: bodies with rows in their subtree
    rows, link_rows, joint_rows,  ///< m; rows of K, one per row and body it acts on; rows on joints
    couplings,                    ///< Σ_i n_i (|Q_i| + 1)²/2 over steps of M + JᵀRJ that rows couple to others
    depth,                        ///< Σ_i n_i (degrees of freedom from i to the root)
    row_depth,                    ///< Σ_i n_i r_i, r_i rows in the subtree of i (m d)
    row_pairs,                    ///< Σ_i n_i r_i²                                  (m² d)
    row_bodies, row_dofs,         ///< ⌈m/8⌉ active bodies, active degrees of freedom: m columns of a sweep in lanes
    row_links,                    ///< ⌈m/8⌉ link_rows
    row_packets, row_singles,     ///< m ⌊m/8⌋, m (m mod 8): a column of the matrix in vectors, and what is left of it
    rows_squared, rows_cubed,     ///< m², m³
    tiles, tile_pairs,            ///< 8×8 tiles of the factor of A, t_p + 1 in column p of them; Σ t_p (t_p + 1)/2   (coupled_rows.h)
    count
  };
  std::array<double, count> of{};
};
[[nodiscard]] Quantities count(const Structure& structure);

enum class Phase : std::uint8_t { update, damping, product, solve, product_of_eight, solve_of_eight };
inline constexpr std::size_t phase_count = 6;

/// Time of each phase, as Phase counts them; NaN: the row has none.
using PhaseTimes = std::array<double, phase_count>;
/// Of one call of each phase of a row, predicted [ns].
[[nodiscard]] PhaseTimes predicted(std::string_view op, const Quantities& q);
/// Of an update and all that is asked, in the unit of `of`; NaN where a phase is asked that the row does not have.
[[nodiscard]] double cost(const PhaseTimes& of, const Demand& use);

/// The cheapest; an explicit row only where it is predicted to save more than `explicit_saves` of the time, since it holds m² numbers.
/// @throws std::logic_error where nothing is asked, a number is negative, or columns are not positive.
inline constexpr double explicit_saves = 0.05;
[[nodiscard]] Choice choose(const Quantities& q, const Demand& use);
[[nodiscard]] inline Choice choose(const Structure& structure, const Demand& use) { return choose(count(structure), use); }

/// From how many products (or solves, with use.solves > 0) on the choice is an explicit row; NaN: at no number up to 10⁹.
[[nodiscard]] double crossover(const Quantities& q, Demand use);

}  // namespace delassus
