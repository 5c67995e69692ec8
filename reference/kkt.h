// The equations of motion in maximal coordinates: every joint is a constraint, nothing is eliminated.
//
//   minimise ½ Σ a_iᵀ H_i a_i + ½ νᵀ diag(armature) ν   over all body motions a_i and joint rates ν,
//   subject to  a_i − a_π(i) − S_i ν_i = 0 (multiplier φ_i) and  K a + 𝒦 ν − R⁻¹ μ = a (multiplier μ = −λ)
//
//       [ H    ·    Gᵀ    Kᵀ  ] (a)   (g)
//       [ ·    arm  −Sᵀ   𝒦ᵀ  ] (ν) = (τ)        G, −S: the joint equations; symmetric, indefinite
//       [ G   −S    ·     ·   ] (φ)   (0)
//       [ K    𝒦    ·    −R⁻¹ ] (μ)   (a)
//
//   solve  λ = A⁻¹ a:  g = τ = 0, right-hand side a, λ = −μ.
//   apply  A f = K a + 𝒦 ν + R⁻¹ f from the first three rows with g = Kᵀ f, τ = 𝒦ᵀ f.
#pragma once

#include "algorithms/kit/scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::reference {

/// Where the unknowns are: a_i at 6i, φ_i at 6N + 6i, ν at 12N, μ at 12N + n.
struct KktLayout {
  Index bodies, dofs, rows;
  [[nodiscard]] Index a(Index body) const { return 6 * body; }
  [[nodiscard]] Index phi(Index body) const { return 6 * bodies + 6 * body; }
  [[nodiscard]] Index nu(Index dof) const { return 12 * bodies + dof; }
  [[nodiscard]] Index mu(Index row) const { return 12 * bodies + dofs + row; }
  [[nodiscard]] Index motion_size() const { return 12 * bodies + dofs; }   ///< without μ
  [[nodiscard]] Index size() const { return motion_size() + rows; }
};

/// One non-zero of the lower triangle: row ≥ column.
template <class T> struct KktEntry {
  Index row, column;
  T value;
};

template <class T> struct Kkt {
  KktLayout layout;
  std::vector<KktEntry<T>> motion;       ///< H, armature, G, S
  std::vector<KktEntry<T>> constraints;  ///< K, 𝒦: rows mu(r), columns a or ν
  std::vector<KktEntry<T>> damping;      ///< R⁻¹ itself (not its negative), rows and columns 0…m−1, lower triangle

  /// (g; 0; τ) = [K 𝒦]ᵀ f over the unknowns without μ. Shapes m×k → motion_size×k.
  [[nodiscard]] MatrixX<T> forces(const MatrixX<T>& f) const;
  /// K a + 𝒦 ν + R⁻¹ f. Shapes motion_size×k, m×k → m×k.
  [[nodiscard]] MatrixX<T> accelerations(const MatrixX<T>& motion_unknowns, const MatrixX<T>& f) const;
  /// All entries of the matrix above, −R⁻¹ included; without μ when `with_rows` is false.
  [[nodiscard]] std::vector<KktEntry<T>> entries(bool with_rows) const;
};

/// Cost O(N + n + K_rows). Zero numbers are left out. Instantiated for Quad, double and Rational.
template <class T> [[nodiscard]] Kkt<T> kkt(const Problem<T>& problem, const Damping<T>& damping);

}  // namespace delassus::reference
