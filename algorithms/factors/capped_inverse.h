// The damped inverse at a damping that the scalar F can carry, as approximate solve of the KKT system: what proximal
// iterations, refinement from float and preconditioning are made of.
//
// What     (K)  M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂   with R⁻¹ replaced by   R₀⁻¹ = R⁻¹ + diag(s),
//          s_r = max(0, d_r/g − R⁻¹_rr), d_r/g within blocks of R⁻¹ (they may be singular),  d_r ≥ (J M⁻¹Jᵀ)_rr, so that
//          R₀ (J M⁻¹Jᵀ)_rr ≤ g whatever R is, hard rows included.
// Formula  M_R₀ δν = r₁ + JᵀR₀ r₂,  δλ = R₀ (r₂ − J δν).
// As iteration  λ ← λ + δλ on the residual of (K) contracts the error along an eigenvector of A (scaled by s) of
//          eigenvalue μ by 1 / (1 + μ): the proximal method of multipliers. Slow in directions that only a small R⁻¹ holds.
// Singular M is (lost_pivot), or a row touches nothing and is hard (zero_damping).
// Cost     update: the factor of M_R in F + 300 N; solve: that of lcaba in F.
// Source   R. T. Rockafellar 1976 for the proximal point algorithm; paper, Algorithm 4, for the inverse.
#pragma once

#include "algorithms/factors/factor.h"

namespace delassus {

template <class T, class F> class CappedInverse {
 public:
  explicit CappedInverse(double g) : g_(g) {}
  void analyze(const Structure& structure);
  /// `M` is the factor of M at the same configuration.
  [[nodiscard]] Report update(const Problem<T>& problem, const Factor<T>& M);
  [[nodiscard]] Report update_damping(const Damping<T>& damping);
  /// Shapes n, m, n, m of X, which is T or lanes of T; `work` needs workspace() values X. r1 may be nullptr (zero) and d_nu nullptr
  /// (not wanted).
  template <class X> void solve_kkt(const X* r1, const X* r2, X* d_nu, X* d_lambda, X* work) const;

  [[nodiscard]] Index workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  [[nodiscard]] T unit_of_mass(const Problem<T>& problem) const;
  double g_;
  T unit_{1};                     // of mass: the power of two that F's numbers of H, armature and R are divided by
  std::shared_ptr<const Structure> structure_;  // of narrow_
  Plan plan_;
  Factor<F> factor_;
  Problem<F> narrow_;             // the problem rounded to F
  BlockDiagonal<T> damping_, weights_;  // R⁻¹ and R₀
  BlockDiagonal<F> narrow_weights_;
  std::vector<T> least_, shift_;  // d / g and s
  std::vector<SixBySix<T>> omega_;
  Report undamped_;
};

}  // namespace delassus
