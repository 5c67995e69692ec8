// proximal: hard rows, redundant ones too, and exact Coulomb, by proximal points with Newton inside.
//
// What     every cone, the convex relaxation and exact Coulomb; R⁻¹ ≥ 0; a mechanism.
// Formula  λ ← argmin over K of ½ λᵀ(G + R⁻¹)λ + λᵀ(g − target + Γ e_n) + ½ ‖λ − λ before‖²_E,   E = diag(ε γ_c) where R⁻¹ < ε γ_c
//            = the problem of primal_newton.h with R⁻¹ + E and λ₀ = λ before, b = u(λ before) + Γ e_n − (R⁻¹ + E) λ before: what a
//          point rounds is of the size of its change
//          Γ ← ‖(μ_i u_i)‖ at the last motion (exact; relaxed 0)
// ε        begins at 1e-4. Where the residual falls by less than a half it becomes a tenth, down to 1e-8: a direction that weighs σ falls by
//          ε/(ε + σ) a point. Where it falls no more it grows tenfold again, and where a pivot is lost beside 1/E, up to 1.
// End      natural residual. Γ is a fixed point that need not converge: not_converged says so.
// Cost     Newton's iterations, O(n + m) each; the report counts them.
// Source   R. T. Rockafellar 1976; V. Acary, F. Cadoux 2013 (the fixed point on Γ).
#pragma once

#include "simulation/solver.h"
#include "simulation/solvers/primal_newton.h"

namespace delassus::simulation {

template <class T> class ProximalNewton : public ContactSolver<T> {
 public:
  static constexpr double first_epsilon = 1e-4, least_epsilon = 1e-8;
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override { return PrimalNewton<T>::refusal(p); }

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  void shift(const ContactProblem<T>& p, double epsilon);
  void expand(const ContactProblem<T>& p, const VectorX<T>& lambda);
  PrimalNewton<T> newton_;
  VectorX<T> R_inverse_, b_, before_;
};

}  // namespace delassus::simulation
