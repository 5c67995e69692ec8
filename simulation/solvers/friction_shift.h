// The shift Γ of exact Coulomb friction, and a step of Newton on it.
//
//   With Γ given the problem is convex; Φ_c(Γ) = ‖(μ_i u_i)‖ is what its velocities make of it. Wanted is Γ = Φ(Γ).
//   plain    Γ ← Φ(Γ): converges where Φ contracts, and slowly where it hardly does
//   Newton   Γ ← max(0, Γ + s δ + (1 − s)(Φ(Γ) − Γ)),  (1 − Φ') δ = Φ(Γ) − Γ,  by GMRES. With t = (μ_i² u_i)/‖(μ_i u_i)‖:
//              Φ' v = tᵀ(J d + R⁻¹ dλ),   (M + JᵀHJ) d = −JᵀH e_n v,   dλ = −H (J d + e_n v)
//            0 of what sticks: its velocity is 0, whatever Γ is
// Cost     Newton: a factor, and a solve with it per direction of Krylov's space, at most `directions`. O(n + m) each.
// Nothing allocates after analyze.
// Source   V. Acary, F. Cadoux 2013 (the fixed point); Y. Saad, M. Schultz 1986 (GMRES).
#pragma once

#include "simulation/solvers/primal_newton.h"

namespace delassus::simulation {

template <class T> class FrictionShift {
 public:
  static constexpr Index directions = 20;
  void analyze(const ContactProblem<T>& p);
  /// Γ ← Φ of the velocity u (m).
  void plain(const ContactProblem<T>& p, const VectorX<T>& u);
  /// Γ ← s = share of the step of Newton from the Γ of the last point, whose answer λ (m) has the velocity u (m); R_inverse (m) is what that point had.
  [[nodiscard]] Report newton(const ContactProblem<T>& p, PrimalNewton<T>& point, const VectorX<T>& R_inverse, const VectorX<T>& lambda, const VectorX<T>& u, double share);
  /// Contacts that slide at the λ of the last point.
  [[nodiscard]] Index sliding(const ContactProblem<T>& p, const PrimalNewton<T>& point) const;
  /// Γ of a group [m/s], 0 where it has none.
  [[nodiscard]] const T& operator[](std::size_t group) const { return gamma_[static_cast<Index>(group)]; }

 private:
  void multiply(const ContactProblem<T>& p, PrimalNewton<T>& point, const T* v, T* out);
  VectorX<T> gamma_, left_;          // per group: Γ, Φ(Γ) − Γ
  VectorX<T> slope_, turned_, moved_, pushed_;  // per row: t, H e_n v, J d, dλ
  MatrixX<T> basis_, small_;         // Krylov's space; the triangle, with its right-hand side as the last column
  VectorX<T> cosine_, sine_, answer_;
};

}  // namespace delassus::simulation
