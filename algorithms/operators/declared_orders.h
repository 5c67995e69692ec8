// What the work of an operator is declared to be made of, phase by phase: sums over a structure, whose growth is the declared order.
//
// What     the O(…) of the table of operators, made exact enough to be held: `n d²` is Σ_i n_i d_i², `m² d` is Σ_i n_i r_i², so that a
//          tree that branches is not charged for one that does not.
// Held     bench/scaling/scaling.h: counted operations grow as these sums on every ladder (docs/ladders.md), ± 0.02 in the order.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// n_i degrees of freedom of joint i, d_i of all joints from i to its root, r_i rows beyond it; t a tree, n_t and m_t its own.
enum class Term : std::uint8_t {
  dofs,               ///< n, bodies included
  active_dofs,        ///< n of the bodies with rows beyond them
  rows,               ///< m
  link_rows,          ///< rows of K: one per row and body it acts on
  rows_squared,       ///< m²
  rows_cubed,         ///< m³
  fill,               ///< Σ_r l_r entries of column r of the factor of A (coupled_rows.h): m²/2 where all rows couple
  fill_squares,       ///< Σ_r l_r²: m³/3 there
  dofs_rows,          ///< n m
  dofs_squared_rows,  ///< n² m
  dofs_rows_squared,  ///< n m²
  dofs_cubed,         ///< n³
  depth,              ///< Σ_i n_i d_i                        (n d)
  depth_squared,      ///< Σ_i n_i d_i²                      (n d²)
  row_depth,          ///< Σ_i n_i r_i                       (m d)
  row_depth_squared,  ///< Σ_r Σ n_i d_i of the way to the root (m d²)
  row_pairs,          ///< Σ_i n_i r_i²                      (m² d)
  path_pairs,         ///< Σ_i n_i r_i (m_t − r_i): joints between two rows of a tree
  tree_rows,          ///< Σ_t n_t m_t
  tree_pairs,         ///< Σ_t m_t²
  fronts,             ///< Σ_i n_i |Q_i| of M + JᵀRJ         (plan.h)
  front_pairs,        ///< Σ_i n_i (|Q_i| + 1)²
  front_rows,         ///< Σ_i n_i (|Q_i| + 1) r̂_i, r̂_i rows that have reached i in the order of elimination of M + JᵀRJ
  front_row_pairs,    ///< Σ_i n_i r̂_i²
  coupled_rows,       ///< Σ_i n_i (|Q_i| + 1) r̂_i of the joints that rows couple to others
  coupled_row_pairs,  ///< Σ_i n_i r̂_i² of these
  panels,             ///< Σ of a front's reflections: rows it meets times blocks behind it (front_plan.h)
  reflections,        ///< Σ of these rows, of reflections of its own degrees of freedom
  reduced,            ///< Σ of these rows, of the others
  count
};
[[nodiscard]] std::string_view name(Term term);

/// Every term of a structure, as a whole number. Cost O(N + m) and one symbolic elimination.
[[nodiscard]] std::array<double, static_cast<std::size_t>(Term::count)> terms(const Structure& structure);

/// What is asked of an operator: the phases whose work is declared.
enum class Asks : std::uint8_t {
  product,      ///< update and one product, without what a new damping repeats where the row also solves
  first_solve,  ///< update and one solve
  apply,        ///< one product more
  solve,        ///< one solve more, of one step at most: iterative rows take as many as they need
  new_damping,  ///< another R⁻¹
  count
};
inline constexpr std::size_t asks_count = static_cast<std::size_t>(Asks::count);
[[nodiscard]] std::string_view name(Asks what);

/// Empty: has no such phase, or no work in it.
using Declared = std::array<std::vector<Term>, asks_count>;
/// @throws std::logic_error for a row of the table of operators that declares nothing.
[[nodiscard]] const Declared& declared_orders(std::string_view op);

}  // namespace delassus
