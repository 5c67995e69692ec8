// The residual of the constrained dynamics at (ν, λ), in twice the working precision and without any inverse.
//
// What     r₁ = r₁⁰ + Jᵀλ − M ν,   r₂ = r₂⁰ − J ν − R⁻¹ λ.
//          From (0, a), both vanish exactly when λ = Λ_R a and ν = M⁻¹Jᵀλ; from a residual, what a correction leaves of it.
// How      forward: a_i = a_π + S_i ν_i;  F_i = Σ K_eᵀλ_e − H_i a_i;  backward: F_π += F_i, r₁ = S_iᵀF_i + 𝒦ᵢᵀλ − A_i ν_i.
//          (recursive Newton–Euler without bias terms). Everything is carried in V: in Wide<T> where r₁ and r₂ are small
//          differences of large numbers, in T where ν and λ are small themselves.
// Cost     about 24 n + 72 N + 24 per K row operations in V; O(n + m).
// Error    eps² (V = Wide<T>) or eps (V = T) of the magnitudes that are added, then one rounding to T.
// Source   the equations (2) of the paper; J. Luh, M. Walker, R. Paul 1980 (paper's [33]) for the recursion.
#pragma once

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/kit/wide.h"

namespace delassus {

template <class T> class KktResidual {
 public:
  void analyze(std::shared_ptr<const Structure> structure);
  void update(const Problem<T>& problem);
  /// K and 𝒦 alone.
  void update_rows(const Problem<T>& problem);
  /// What update was given; `to` has the structure and the sizes.
  void numbers(Problem<T>& to) const;
  void update_damping(const Damping<T>& damping) { damping_.assign(damping); }
  /// R⁻¹; rows that are off have no residual.
  [[nodiscard]] const BlockDiagonal<T>& damping() const { return damping_; }

  /// r1 (n, in the problem's order of degrees of freedom) and r2 (m), from r1_0 (nullptr: 0) and r2_0, which they may
  /// replace. X is T, or lanes of T for as many columns; V is Wide<X> or X. `work` needs workspace() values X.
  template <class V, class X>
  void evaluate(const V* nu, const V* lambda, const X* r1_0, const X* r2_0, X* r1, X* r2, X* work) const;

  [[nodiscard]] Index workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  template <class V> struct Buffers;
  template <class V> void outward(const V* nu, Buffers<V>& b) const;
  template <class V, class X> void link_rows(const V* lambda, const X* r2_0, X* r2, Buffers<V>& b) const;
  template <class V, class X> void joint_rows(const V* nu, const V* lambda, const X* r2_0, X* r2, Buffers<V>& b) const;
  template <class V, class X> void inward(X* r1, Buffers<V>& b) const;

  std::shared_ptr<const Structure> structure_;
  std::vector<int> body_of_;  // per degree of freedom
  std::span<Six<T>> s_, k_;
  std::vector<SixBySix<T>> h_;
  std::span<T> armature_, joint_k_;
  Slab<Six<T>> sixes_;
  Slab<T> scalars_;
  BlockDiagonal<T> damping_;  // R⁻¹
};

}  // namespace delassus
