// per_contact: Gauss–Seidel with every contact solved exactly, given the others.
//
// What     every cone; exact Coulomb, contacts of one tangent or two.
// Formula  with A = G + R⁻¹ and b_c = u_c − A_cc λ_c, in tangents scaled by their μ_i (then μ = 1):
//            open   b_n ≥ 0: λ_c = 0
//            stick  λ_c = −A_cc⁻¹ b_c where that is in K
//            slip   λ_n(θ) = −b_n / (A_nn − A_nt d), λ_t = −λ_n d, d = (cos θ, sin θ): d × u_t = 0 and d·u_t > 0, λ_n > 0
//          the zeros of d × u_t over θ by 32 samples from the direction of last time and bisection; one tangent: both sides.
// End      natural residual. Where no mode is found (A_cc too coupled for the samples) the projected step of pgs is taken.
// Cost     A once, O(m (n + m)); m² and about 100 evaluations of a contact a sweep.
// Source   J. Hwangbo, J. Lee, M. Hutter 2018 (bisection per contact; there λ_t minimises the energy on u_n = 0, here it opposes u_t).
#pragma once

#include "algorithms/kit/ldlt.h"
#include "simulation/solver.h"

namespace delassus::simulation {

template <class T> class PerContact : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override;

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  void row(const ContactProblem<T>& p, const ConeRows& c, Index r, VectorX<T>& lambda);
  void contact(const ContactProblem<T>& p, const ConeRows& c, VectorX<T>& lambda);
  void move(Index r, const T& step, VectorX<T>& lambda);
  MatrixX<T> A_;
  std::vector<T> angle_;  // per group: the direction of slip last time
};

}  // namespace delassus::simulation
