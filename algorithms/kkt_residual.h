// The residual of the constrained dynamics at (ν, λ), in twice the working precision and without any inverse.
//
// What     r₁ = Jᵀλ − M ν,   r₂ = a − J ν − R⁻¹ λ.       Both vanish exactly when λ = Λ_R a and ν = M⁻¹Jᵀλ.
// How      forward: a_i = a_π + S_i ν_i;  F_i = Σ K_eᵀλ_e − H_i a_i;  backward: F_π += F_i, r₁ = S_iᵀF_i + 𝒦ᵢᵀλ − A_i ν_i.
//          (recursive Newton–Euler without bias terms). Sums are carried in Wide<T>, since r₁ and r₂ are small
//          differences of large numbers; inputs are Wide<T> too.
// Cost     about 60 n + 72 N + 24 per K row operations in Wide<T>; O(n + m).
// Error    eps² of the magnitudes that cancel, then one rounding to T.
// Source   the equations (2) of the paper; J. Luh, M. Walker, R. Paul 1980 (paper's [33]) for the recursion.
#pragma once

#include "algorithms/block_diagonal.h"
#include "algorithms/wide.h"

namespace delassus {

template <class T> class KktResidual {
 public:
  using W = Wide<T>;

  void analyze(std::shared_ptr<const Structure> structure);
  void update(const Problem<T>& problem);
  void update_damping(const Damping<T>& damping) { damping_.assign(damping); }

  /// r1 (n, in the problem's order of degrees of freedom) and r2 (m). `work` needs workspace() scalars T.
  void evaluate(const W* nu, const W* lambda, const T* a, T* r1, T* r2, T* work) const;

  [[nodiscard]] Index workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  std::shared_ptr<const Structure> structure_;
  std::vector<Six<T>> s_, k_;
  std::vector<SixBySix<T>> h_;
  std::vector<T> armature_, joint_k_;
  BlockDiagonal<T> damping_;  // R⁻¹
};

}  // namespace delassus
