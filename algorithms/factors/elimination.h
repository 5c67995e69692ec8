// In which order bodies are eliminated, and what each is coupled to at that moment: what a plan (plan.h) is written from.
//
// What     Minimum degree among the bodies whose children are all gone (a joint must be eliminated before its parent),
//          ties: deepest first, then by number of degrees of freedom, so that equal steps stand together. Bodies whose subtree carries no
//          row come first.
// Many     coupled trees – boxes, bricks, robots in a crowd – are dissected besides (dissection.h), a tree as one node, and minimum degree
//          keeps to the stages. Of both orders the one with less work, as counted, is taken.
// Cost     O(N) where nothing couples bodies, else O((N + fill) log N): twice where trees are dissected, the second one up to the work of the first.
#pragma once

#include <vector>

#include "algorithms/factors/plan.h"

namespace delassus {

/// Q_i = N_i ∪ {π(i)} of every body at its elimination, in elimination order; one list after the other. Nothing couples bodies: no lists, {π(i)}.
struct Elimination {
  std::vector<int> body, first, members;
  int actives = 0;       ///< the last of them have rows in their subtree
  bool coupled = false;  ///< there are lists
  double work = 0;       ///< of lists: Σ n_i (|Q_i| + 1)²
};

enum class Ordering : std::uint8_t { cheapest, minimum_degree, dissected };
[[nodiscard]] Elimination eliminate(const Structure& structure, Matrix matrix, Branches branches, Ordering ordering = Ordering::cheapest);

}  // namespace delassus
