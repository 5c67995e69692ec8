// Which rows of A f and of A⁻¹ a are zero because nothing that is not zero reaches them.
//
// The maximal-coordinate references compute body motions by elimination and leave rounding errors in components that
// no joint can move; where the bound of the verdict is zero an exact zero is demanded. So their zeros are taken from the
// pattern of the numbers alone:
//   degrees of freedom k, l are coupled when |S_k|ᵀ|H_i||S_l| ≠ 0 for a body i below both;
//   row r touches k when |K_r||S_k| ≠ 0 (or |𝒦_r| ≠ 0); rows of one block of R⁻¹ are coupled.
// Coupling is made transitive, which can only miss zeros, never invent them.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::reference {

class Zeros {
 public:
  /// Cost O(N + m), times the depth where bodies without inertia follow one another.
  Zeros(const Problem<double>& problem, const Damping<double>& damping);
  /// Sets to zero what A f cannot reach. Shapes m×k.
  void clear_apply(const MatrixX<double>& f, MatrixX<Quad>& a) const;
  /// Sets to zero what A⁻¹ a cannot reach. Shapes m×k.
  void clear_solve(const MatrixX<double>& a, MatrixX<Quad>& f) const;

 private:
  std::vector<std::vector<Index>> touched_;          // per row: classes of the degrees of freedom it touches
  std::vector<std::vector<Index>> damping_;          // per row: rows s with (R⁻¹)_rs ≠ 0
  std::vector<Index> row_class_;                     // per row: its class under solve
  Index dof_classes_ = 0;                            // classes are numbers below this
};

}  // namespace delassus::reference
