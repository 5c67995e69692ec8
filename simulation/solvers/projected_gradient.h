// apgd and ccp: projected gradients on ½ λᵀAλ + λᵀb over the cones, A = G + R⁻¹, b = g − target. Products with A only.
//
// What     every cone, relaxed.
// apgd     Nesterov's acceleration, the step 1/L found by backtracking (f(λ⁺) ≤ f(y) + ∇f(y)ᵀ(λ⁺ − y) + ½ L ‖λ⁺ − y‖²_γ), restarted
//          where it goes uphill; L shrinks by 0.9 an iteration. f falls as 1/k².
// ccp      the fixed point λ ← Π(λ − ω (Aλ + b)/γ), all cones at once, ω = 1.5 / the largest eigenvalue of γ^-½ A γ^-½: f falls at
//          every step, the error by 1 − 1/κ.
// Metric   γ_c, the mean diagonal of A over a cone, in the place of the identity.
// Cost     one product with A an iteration (apgd: two and a half or so), O(n + m).
// Source   H. Mazhar, T. Heyn, D. Negrut, A. Tasora 2015; A. Tasora, M. Anitescu 2011 (there contact after contact).
#pragma once

#include "simulation/solver.h"

namespace delassus::simulation {

template <class T> class ProjectedGradient : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override;

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  /// γ of the problem, and the largest eigenvalue of γ^-½ A γ^-½ within a few per cent.
  T scale(const ContactProblem<T>& p);
  /// to = Π(from − step (gradient/γ))
  void step(const ContactProblem<T>& p, const VectorX<T>& from, const VectorX<T>& gradient, const T& length, VectorX<T>& to);
  VectorX<T> gamma_, b_, gradient_, y_, next_, work_;
};

template <class T> class Apgd : public ProjectedGradient<T> {
 protected:
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;
};

template <class T> class Ccp : public ProjectedGradient<T> {
 protected:
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;
};

}  // namespace delassus::simulation
