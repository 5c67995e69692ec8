// W with Wᵀ W = R, from R⁻¹: what turns the damping into rows of a least-squares problem.
//
// Formula  R⁻¹ = L D Lᵀ per constraint (L = 1 where the damping is diagonal);  W = D^-½ L⁻¹.
// Off      a row with R⁻¹ = ∞ is a zero row of W.
// Singular zero_damping names the first row whose damping, or whose pivot within a block, is not positive.
// Cost     one square root per row, m_e³/3 per block; no allocation after analyze.
#pragma once

#include <type_traits>

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/kit/six.h"

namespace delassus {

template <class T> class WeightRoot {
 public:
  void analyze(const Structure& structure);
  [[nodiscard]] Report assign(const Damping<T>& damping);

  /// y = W x and y = Wᵀ x, shapes m; x and y must not overlap.
  void multiply(const T* x, T* y) const;
  void multiply_transposed(const T* x, T* y) const;

  /// The rows of constraint e (link constraints first, then joint constraints) from X to W_e X; V is T or Six<T>.
  template <class V> void multiply_rows(std::size_t e, V* rows) const {
    const auto [first, count, lower] = constraints_[e];
    for (Index r = 0; has_lower_[e] && r < count; ++r)
      for (Index s = 0; s < r; ++s) subtract(rows[r], rows[s], lower_[lower + s * count + r]);
    for (Index r = 0; r < count; ++r) {
      if constexpr (std::is_same_v<V, T>) rows[r] *= root_[first + r];
      else scale(rows[r], root_[first + r]);
    }
  }
  [[nodiscard]] Index bytes() const;

 private:
  struct Constraint {
    Index first, count, lower;  // rows; its block in lower_
  };
  template <class V> static void subtract(V& y, const V& x, const T& s) {
    if constexpr (std::is_same_v<V, T>) y -= x * s;
    else subtract_scaled(y, x, s);
  }
  std::vector<Constraint> constraints_;
  std::vector<char> has_lower_;
  std::vector<T> root_;   // D^-½, per row
  std::vector<T> lower_;  // L below its diagonal, column-major
  BlockDiagonal<T> damping_;
};

}  // namespace delassus
