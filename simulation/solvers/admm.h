// admm: alternating directions between the damped inverse and the cones.
//
// What     every cone; the convex relaxation and exact Coulomb.
// Formula  with A = G + R⁻¹, b = g − target, P = diag(ρ γ_c) (γ_c: mean diagonal of A over the cone), y the multipliers of x = z:
//            x ← (A + P)⁻¹ (P z − y − b − Γ e_n)            Λ_R at the damping R⁻¹ + P: update_damping when ρ changes
//            z ← Π(x + P⁻¹y),   y ← y + P (x − z)           now z ∈ K, −y ∈ K*, z ⊥ y
//            Γ ← ‖(μ_i y_i)‖ (exact; relaxed: 0)             −y is the shifted velocity, tangents are not shifted
// ρ        √κ⁻¹ κᵗ of the scaled matrix P^(-½)A P^(-½) with spectrum in [L/κ, L]: L by power iteration, L/κ = 1e-6 L or the damping
//          below which nothing can be told; t moves by 0.05 where one of |x − z| and |z − z before| is ten times the other.
// End      cheap while the two differences are above the target; then the natural residual of z.
// Cost     one solve of lcaba_refined (matrix: of the dense factor) an iteration, a factor for each ρ.
// Source   J. Carpentier, Q. Le Lidec, L. Montaut 2024 (From compliant to rigid contact simulation); S. Boyd et al. 2011.
#pragma once

#include "simulation/solver.h"

namespace delassus::simulation {

template <class T> class Admm : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>&) const override { return ""; }

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  struct Differences {
    double primal = 0, dual = 0;  // [m/s]
  };
  void scale(const ContactProblem<T>& p);
  [[nodiscard]] double largest_eigenvalue();
  [[nodiscard]] Report factored(double rho);
  Report step(const ContactProblem<T>& p, VectorX<T>& z, Differences& d);
  VectorX<T> gamma_, P_, x_, y_, b_, before_, right_;
};

}  // namespace delassus::simulation
