// L D Lᵀ of a dense positive semidefinite matrix with diagonal pivoting: finds the rank.
//
// What     P A Pᵀ = L D Lᵀ, A (n × n, column-major, lower triangle read) overwritten by L and D of the first `rank` rows.
// Pivots   the largest remaining diagonal first. `accept(row, pivot, steps)` decides on it and may replace it by what is known
//          of it better; false ends the factorisation: the rows left depend on those before.
// Cost     n rank² operations. Scalars must be ordered. No allocation.
// Source   N. Higham, Accuracy and Stability of Numerical Algorithms, section 10.3.
#pragma once

#include <utility>

#include "algorithms/kit/ldlt.h"

namespace delassus {

/// order[k] becomes the row of A in place k. Returns the rank.
template <class T, class Accept> [[nodiscard]] Index ldlt_pivoted(T* a, Index n, Index* order, const Accept& accept) {
  const auto at = [a, n](Index r, Index c) -> T& { return a[c * n + r]; };
  for (Index k = 0; k < n; ++k) order[k] = k;
  for (Index k = 0; k < n; ++k) {
    Index p = k;
    for (Index r = k + 1; r < n; ++r)
      if (at(r, r) > at(p, p)) p = r;
    if (p != k) {  // rows and columns k < p of the lower triangle
      std::swap(order[k], order[p]);
      for (Index c = 0; c < k; ++c) std::swap(at(k, c), at(p, c));
      for (Index c = k + 1; c < p; ++c) std::swap(at(c, k), at(p, c));
      for (Index r = p + 1; r < n; ++r) std::swap(at(r, k), at(r, p));
      std::swap(at(k, k), at(p, p));
    }
    if (!accept(order[k], at(k, k), k + 1)) return k;
    const T d = at(k, k);
    for (Index c = k + 1; c < n; ++c) {
      const T l = at(c, k) / d;
      Eigen::Map<VectorX<T>>(&at(c, c), n - c) -= Eigen::Map<const VectorX<T>>(&at(c, k), n - c) * l;
    }
    for (Index r = k + 1; r < n; ++r) at(r, k) = at(r, k) / d;
  }
  return n;
}

}  // namespace delassus
