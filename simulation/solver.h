// A contact solver, and its phases: analyze (allocates, once per structure) → solve (a problem of that structure, any numbers).
//
// The end is judged by the base class: whatever an algorithm thinks, the status is ok only where the natural residual of its λ
// (residual.h) is at most what was wanted. A problem that is not taken is refused by name: refusal(), and not_supported.
// Warm start: the problem's. Nothing allocates in solve but what ContactOperator does the first time, and what the row of the table says.
#pragma once

#include <string>
#include <string_view>

#include "simulation/contact_operator.h"
#include "simulation/residual.h"

namespace delassus::simulation {

struct Wanted {
  double velocity = 1e-10;  ///< natural residual [m/s]
  int iterations = 10000;   ///< at most
};

/// What a solver came to. The residuals are those of the λ returned, whatever the status.
struct SolverReport {
  Status status = Status::ok;
  Index where = -1;               ///< the row or degree of freedom of lost_pivot and zero_damping
  int iterations = 0;
  Residuals residuals;
  double gap = -1;                ///< duality gap [J], a bound on the distance in energy; −1: not computed
  [[nodiscard]] bool ok() const { return status == Status::ok; }
};

template <class T> class ContactSolver {
 public:
  ContactSolver() = default;
  ContactSolver(const ContactSolver&) = delete;
  ContactSolver& operator=(const ContactSolver&) = delete;
  virtual ~ContactSolver() = default;

  /// Why this problem is not taken, naming the group or row; "" where it is.
  [[nodiscard]] virtual std::string refusal(const ContactProblem<T>& p) const = 0;
  [[nodiscard]] bool supports(const ContactProblem<T>& p) const { return refusal(p).empty(); }

  /// Allocates for problems of this structure, size and groups. @throws ModelError where the problem cannot be right (validate).
  void analyze(const ContactProblem<T>& p);
  /// λ (m) of the problem. lambda is resized where it must be. not_supported leaves it zero; not_converged: the best iterate;
  /// not_finite, lost_pivot: NaN. @throws std::logic_error before analyze, or with another structure.
  /// `tree`: has taken the numbers of the problem's mechanism, and lends its factor.
  [[nodiscard]] SolverReport solve(const ContactProblem<T>& p, Wanted wanted, VectorX<T>& lambda, TreeOperators<T>* tree = nullptr);
  /// u = (G + R⁻¹) λ + g − target of the last answer. Shape m.
  [[nodiscard]] const VectorX<T>& velocity() const { return u_; }

 protected:
  virtual void do_analyze(const ContactProblem<T>& p) = 0;
  /// lambda holds the projected warm start. Returns what stopped it: ok (it believes it is there), not_converged, lost_pivot, …;
  /// sets iterations, and what else it knows. op_ has the problem's numbers.
  virtual SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) = 0;

  /// Residuals of λ; leaves its velocity in u_.
  [[nodiscard]] const Residuals& judged(const ContactProblem<T>& p, const VectorX<T>& lambda) {
    op_.velocity(lambda.data(), u_.data());
    judged_ = lambda;
    return residuals_ = residuals(p, lambda.data(), u_.data(), op_.diagonal().data());
  }

  ContactOperator<T> op_;
  VectorX<T> u_;

 private:
  VectorX<T> judged_;  // the last λ that was judged, and
  Residuals residuals_;
};

/// The first Coulomb group that is on, or −1; likewise the first box.
template <class T> [[nodiscard]] Index first_group(const ContactProblem<T>& p, Cone cone);

}  // namespace delassus::simulation
