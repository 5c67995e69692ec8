// pgs: projected Gauss–Seidel, cone after cone.
//
// What     every cone; the convex relaxation and exact Coulomb.
// Formula  row      λ_r ← clamp(λ_r − u_r / A_rr)
//          contact  λ_c ← Π(λ_c − (u_c + Γ(u_c) e_n) / γ_c),  γ_c = ‖A_cc‖_∞ ≥ its largest eigenvalue    (relaxed: Γ = 0)
//          after each   u += A e_c δλ_c;   A = G + R⁻¹
// End      a fixed point is a solution. Relaxed: the sum ½λᵀAλ + λᵀ(g − target) falls at every step. Exact: nothing is promised.
// Cost     A once, O(m (n + m)); m² a sweep. Slow where A is ill conditioned: the error falls by about 1 − 1/κ a sweep.
// Source   J.-J. Moreau 1988; M. Jourdan, P. Alart, M. Jean 1998.
#pragma once

#include "simulation/solver.h"

namespace delassus::simulation {

template <class T> class Pgs : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>&) const override { return ""; }

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  void row(const ContactProblem<T>& p, const ConeRows& c, Index r, VectorX<T>& lambda);
  void contact(const ContactProblem<T>& p, const ConeRows& c, VectorX<T>& lambda);
  void move(Index r, const T& step, VectorX<T>& lambda);
  MatrixX<T> A_;
  std::vector<T> gamma_;  // per group
};

}  // namespace delassus::simulation
