// Nested dissection of a square lattice of free bodies: the order of elimination that the library does not have, to compare with.
//
// What     The middle line of the longer side comes last, the two halves before it, each in the same way, down to four bodies.
// Cost     of eliminating an s × s lattice so: O(s³) (A. George, Nested dissection of a regular finite element mesh, 1973).
#pragma once

#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus::bench {

/// Bodies of the lattice in the order of their elimination.
[[nodiscard]] std::vector<Index> dissection(Index side);

/// Σ_i 6 (|Q_i| + 1)² of eliminating the lattice in an order: Term::front_pairs of that order.
[[nodiscard]] double lattice_front_pairs(Index side, const std::vector<Index>& order);

}  // namespace delassus::bench
