// newton_convex: the convex relaxation by Newton's method on the motion.
//
// What     every cone, relaxed; R⁻¹ > 0 in every row; a mechanism.
// How      primal_newton.h from the motion of the warm start; its λ is judged as every solver's.
// Gap      ½ ‖w − M⁻¹Jᵀλ‖²_M [J]: bounds the distance of the motion w and of λ (in A) from the solution.
// Cost     O(n + m) an iteration with local loops; about ten iterations, whatever the mass ratio.
// Limit    λ = −R u cancels where R G is large: digits log10(R G) of the natural residual are lost; then not_converged says so.
// Source   see primal_newton.h.
#pragma once

#include "simulation/solver.h"
#include "simulation/solvers/primal_newton.h"

namespace delassus::simulation {

template <class T> class NewtonConvex : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override;

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  PrimalNewton<T> newton_;
  VectorX<T> R_inverse_, b_;
};

}  // namespace delassus::simulation
