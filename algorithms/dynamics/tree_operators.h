// The matrices of a mechanism as functions of vectors: none of them is formed.
//
//   J             a = J ν            motions of the joints to rates of the rows
//   J_transposed  τ = Jᵀ λ           forces at the rows to forces at the joints
//   M             τ = M ν
//   M_inverse     ν = M⁻¹ τ          (articulated-body algorithm)
//   delassus      a = J M⁻¹Jᵀ λ      the chain of three of them in two sweeps, as aba_sweep
//
// How      a_i = a_π + S_i ν_i outwards, f_i = H_i a_i + Σ f_children inwards, S_iᵀ f_i + A_i ν_i; rows K a_i + 𝒦ν_i. M⁻¹ by factor.h.
// Cost     O(N + m) a column: J and Jᵀ about 24 operations per degree of freedom and 12 per K row, M 120 per body; update about 330
//          per body for the factor of M, without which the other three do.
// Error    componentwise: eps of the terms that are added; what has M⁻¹ in it within the sensitivity of the data.
// Source   paper, Algorithms 1–3; M ν: J. Luh, M. Walker, R. Paul 1980 (RNEA at rest).
#pragma once

#include <memory>
#include <utility>

#include "algorithms/factors/factor.h"
#include "algorithms/problem/problem.h"

namespace delassus {

/// Serves every scalar. Threads: one each. Nothing allocates after the first update. Shapes: n×k on the side of joints, m×k on that
/// of rows, in the orders of the structure [rad/s and m/s, N m and N, or their derivatives]; in- and output must not overlap.
/// @throws std::logic_error where they do not fit, or before the first update.
template <class T> class TreeOperators {
 public:
  /// @throws ModelError for a bad structure.
  explicit TreeOperators(std::shared_ptr<const Structure> structure);
  TreeOperators(TreeOperators&&) noexcept;
  ~TreeOperators();

  /// Numbers at a configuration. Report: lost_pivot with the degree of freedom where M is singular; J, Jᵀ and M are defined all the same.
  [[nodiscard]] Report update(const Problem<T>& problem);
  /// The same without a copy, and without a factor until one is asked for: the problem must live, and stay as it is, until the last call.
  void take(const Problem<T>& problem);

  void J(ConstRef<T> nu, Ref<T> a);
  void J_transposed(ConstRef<T> lambda, Ref<T> tau);
  void M(ConstRef<T> nu, Ref<T> tau);
  /// Report: as that of update; ν is NaN where it is not ok.
  [[nodiscard]] Report M_inverse(ConstRef<T> tau, Ref<T> nu);
  /// Likewise.
  [[nodiscard]] Report delassus(ConstRef<T> lambda, Ref<T> a);

  /// The factor of M in the order of plan(), with the report of its update; for what reads its joints.
  [[nodiscard]] std::pair<const Factor<T>*, Report> factor();
  [[nodiscard]] const Plan& plan() const;
  [[nodiscard]] const Problem<T>& problem() const;  ///< @throws std::logic_error before the first update

 private:
  struct Numbers;
  std::unique_ptr<Numbers> own_;
};

}  // namespace delassus
