// How far an impulse is from solving a contact problem: the definition, written out, from dense matrices. Shares nothing with the
// solvers and their own residuals but the value they are given (simulation/contact_problem.h).
//
//   u          = Σ_s (J M⁻¹Jᵀ)_rs λ_s + R⁻¹_r λ_r + g_r − target_r, summed in T
//   natural    γ ‖λ − the nearest point of K to λ − ũ/γ‖                           [m/s]   γ: mean diagonal of the cone's block
//   approach   how much ũ lacks to be in K*: ‖(μ_i u_i)‖ − ũ_n, −u, |u|             [m/s]
//   cone       how far λ is outside K                                               [N s]
//   work       |λ·ũ|; of boxes |u| times the way to the bound that u asks for       [J]
//   shift      Γ = ‖(μ_i u_i)‖ where λ_n > 0: what a relaxed contact separates with while it slides   [m/s]
//   momentum   largest entry of M Δv − Jᵀλ                                          [N s, N m s]
// each the largest over the groups. ũ = u + Γ e_n by the exact law.
// How      The nearest point of a cone of equal coefficients is its projection on the ray in the plane of normal and tangent; of unequal ones
//          by bisection on the multiplier. Cost O(n³ + m²). T: double, Quad.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"
#include "simulation/contact_problem.h"

namespace delassus::reference {

struct ContactResidual {
  double natural = 0, approach = 0, cone = 0, work = 0, shift = 0;
};

/// The dense numbers of a problem in T: G, and M and J where it has a mechanism.
template <class T> struct DenseContact {
  explicit DenseContact(const simulation::ContactProblem<double>& p);
  MatrixX<T> G, M, J;
};

template <class T>
[[nodiscard]] ContactResidual contact_residual(const simulation::ContactProblem<double>& p, const DenseContact<T>& numbers,
                                               const VectorX<double>& lambda, simulation::FrictionLaw law);
/// u of every row, 0 where a group is off. Shape m.
template <class T>
[[nodiscard]] VectorX<T> contact_velocity(const simulation::ContactProblem<double>& p, const DenseContact<T>& numbers, const VectorX<double>& lambda);
/// Largest entry of M Δv − Jᵀλ.
template <class T> [[nodiscard]] double contact_momentum(const DenseContact<T>& numbers, const VectorX<double>& dv, const VectorX<double>& lambda);

}  // namespace delassus::reference
