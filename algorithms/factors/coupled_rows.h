// Which entries of A = J M⁻¹Jᵀ + R⁻¹ = L D Lᵀ can be other than zero, rows eliminated in their order: the symbolic part.
//
// What     A_rs ≠ 0 only for rows of one constraint, or of constraints on one tree: bodies that share a joint which moves. The rows of a
//          tree, and those of a constraint, are cliques; A is a sum of them, and so is what elimination leaves (fill).
// How      In the elimination tree (parent of r: the first row below the diagonal of column r of L) column s of L holds row r when s
//          is on the way from the first row of one of r's cliques to r.
// Units    rows are taken together, by what `unit` says: tiles, or constraints.
// Cost     O(Σ sizes of cliques) for the tree; the entries of L, in units.
// Source   J. W. H. Liu, The role of elimination trees in sparse factorization, 1990.
#pragma once

#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// The columns of L by units, one behind the other: the rows of each from the diagonal on, ascending.
struct Fill {
  std::vector<Index> first{0}, row;
};

/// Every unit in one clique.
[[nodiscard]] Fill full(Index units);
/// Of A of a structure; units of rows follow each other.
[[nodiscard]] Fill coupled_rows(const Structure& structure, const std::vector<Index>& unit);
/// The rows of A, `width` to a unit.
[[nodiscard]] Fill coupled_rows(const Structure& structure, Index width);
/// Σ over the rows of A of the entries of L's column, and of their squares.
struct FillSums {
  double entries = 0, squares = 0;
};
[[nodiscard]] FillSums fill_sums(const Structure& structure);
/// The same over the columns of L by units of `width` rows.
[[nodiscard]] FillSums tile_sums(const Structure& structure, Index width);

}  // namespace delassus
