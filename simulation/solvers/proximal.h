// proximal: hard rows, redundant ones too, and exact Coulomb, by proximal points with Newton inside.
//
// What     every cone, the convex relaxation and exact Coulomb; R⁻¹ ≥ 0; a mechanism.
// Formula  λ ← argmin over K of ½ λᵀ(G + R⁻¹)λ + λᵀ(g − target + Γ e_n) + ½ ‖λ − λ before‖²_E,   E = diag(ε γ_c) where R⁻¹ < ε γ_c
//            = the problem of primal_newton.h with R⁻¹ + E and λ₀ = λ before, b = u(λ before) + Γ e_n − (R⁻¹ + E) λ before: what a
//          point rounds is of the size of its change
//          Γ ← ‖(μ_i u_i)‖ at the last motion (exact; relaxed 0), or a step of Newton on it: friction_shift.h
// Start    of each point: one step of Newton from the cones that λ − ũ/γ is in, as the natural residual sees them. Where they are those
//          of the answer it is the answer: an iteration a point, and no other where λ is what it expects.
// ε        begins at 1e-3: a direction that weighs σ falls by ε/(ε + σ) a point. Where the residual falls by less than a half it becomes a
//          tenth, down to 1e-8; a hundredth, and where it falls by less than fifty, as long as points take two iterations more and less:
//          a small ε makes cones hard to find. Where the residual grows, or stays as it is at the least ε, ε grows tenfold: Γ
//          goes in circles; the fourth time it does not come down again, until it stays as it is there, too: λ creeps along rows
//          that depend on each other. Where a pivot is lost beside 1/E it grows up to 1.
// Γ        is taken from the last motion or goes by a step of Newton: where nothing slides the two are the same. Newton where the residual does
//          not fall by half, and where it is cheaper: once a point ends within two iterations, with the cones it began with, a step of
//          Newton is expected to leave a hundredth, for a point and a quarter more for every contact that slides. Steps of Newton change
//          who slides: four may pass before one is below where they began, or all are taken back. What is left out of the next ones then,
//          three quarters of their way beyond the plain step, comes back by half with each that helps.
// Inside   minimised until λ is what is expected to a tenth of the residual: the next point mends more.
// End      natural residual. Γ need not converge: not_converged says so.
// Cost     Newton's iterations, O(n + m) each; the report counts them.
// Source   R. T. Rockafellar 1976; V. Acary, F. Cadoux 2013 (the fixed point on Γ).
#pragma once

#include <limits>

#include "simulation/solver.h"
#include "simulation/solvers/friction_shift.h"

namespace delassus::simulation {

template <class T> class ProximalNewton : public ContactSolver<T> {
 public:
  static constexpr double first_epsilon = 1e-3, least_epsilon = 1e-8, inexact = 0.1;
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override { return PrimalNewton<T>::refusal(p); }

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  /// ε, point by point.
  class Weight {
   public:
    double epsilon = first_epsilon;
    /// After a point with this residual, which took so many iterations after its start.
    void follow(double reached, int inner);
    /// A pivot was lost: not as small again.
    void rise() { possible_ = least_ = epsilon = 10 * epsilon; }

   private:
    double possible_ = least_epsilon, least_ = least_epsilon, before_ = std::numeric_limits<double>::infinity();
    int risen_ = 0;
  };
  /// How Γ goes on, point by point.
  class Steps {
   public:
    enum class Next { plain, first, newton, back };  ///< first: of a row of Newton's steps; back: to where it began, and plain
    double share = 1;  ///< of a step of Newton
    /// After a point with this residual, at which so many contacts slide; settled: it ended within two iterations.
    Next after(double reached, Index sliding, bool settled);
    void stop() { made_ = 0; }

   private:
    static constexpr int watched = 4;
    static constexpr double least_share = 1.0 / 256, solve_of_a_point = 0.25, gained = 0.01;
    double before_ = std::numeric_limits<double>::infinity();  // residual where the row began, or of the last point
    int made_ = 0;
  };
  void shift(const ContactProblem<T>& p, double epsilon);
  void expand(const ContactProblem<T>& p, const VectorX<T>& lambda);
  PrimalNewton<T> newton_;
  FrictionShift<T> gamma_;
  VectorX<T> R_inverse_, b_, x_, before_, saved_;
};

}  // namespace delassus::simulation
