// M of a tree as Lᵀ D L, nothing stored and nothing computed where branches do not meet.
//
// What     row k of L: the degrees of freedom above k on the way to the root, from the root on, then D_k in place of 1. A row is so laid as the
//          beginning of the row of every degree of freedom below it: all steps are products of contiguous numbers.
// Formula  M_kl = S_kᵀ H^c_j S_l for l of joint j and k of j or above (composite inertias H^c); then from the leaves,
//            D_k = M_kk,   L_ki = M_ki / D_k,   M_ij −= L_ki M_kj      for i and j above k.
//          No fill: what k couples stands on one way to the root already.
// Singular a pivot D_k that is not positive; reported at its joint's first degree of freedom.
// Cost     Σ d_k² operations for d_k degrees of freedom above k, 24 per entry of M; solve 4 Σ d_k. Memory Σ d_k.
// Error    normwise, relative to √(M_ii M_jj): the rounding of its own diagonal, and so within what the data's rounding is to M.
// Source   R. Featherstone 2005 (Efficient factorization of the joint-space inertia matrix for branched kinematic trees);
//          Rigid Body Dynamics Algorithms, table 6.2 (M) and section 6.5.
#pragma once

#include <vector>

#include "algorithms/errors/status.h"
#include "algorithms/problem/problem.h"

namespace delassus {

template <class T> class BranchFactor {
 public:
  void analyze(const Structure& structure);
  /// M, then its factor.
  [[nodiscard]] Report update(const Problem<T>& problem);

  /// z ← L⁻ᵀ z. Shape n.
  void solve_transposed(T* z) const;
  /// z ← L⁻¹ D⁻¹ z.
  void solve_scaled(T* z) const;

  [[nodiscard]] Index dofs() const { return static_cast<Index>(above_.size()); }
  /// The degree of freedom next above k, −1 at the root.
  [[nodiscard]] Index above(Index k) const { return above_[k]; }
  /// The number of degrees of freedom above k; that of k itself in its row.
  [[nodiscard]] Index depth(Index k) const { return depth_[k]; }
  /// The last degree of freedom on the way from the root to body i, its own included; −1: none.
  [[nodiscard]] Index last_dof(Index i) const { return last_dof_[i]; }
  /// L_ki for i of depth t at place t.
  [[nodiscard]] const T* row(Index k) const { return rows_.data() + first_[k]; }
  [[nodiscard]] const T& inverse_pivot(Index k) const { return inverse_[k]; }
  [[nodiscard]] Index bytes() const;

 private:
  void assemble(const Problem<T>& problem);
  [[nodiscard]] T* row(Index k) { return rows_.data() + first_[k]; }

  const Structure* structure_ = nullptr;
  std::vector<Index> above_, depth_, last_dof_, first_;
  std::vector<Matrix6<T>> composite_;
  std::vector<T> rows_, inverse_;
};

}  // namespace delassus
