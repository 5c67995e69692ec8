// How velocities follow from forces: by what rows there are.
//
//   free        δ = M̂⁻¹ h f, or M⁻¹ f where accelerations are asked for        articulated-body factor
//   equations   M̂ δ − Jᵀλ = h f,  J δ + R⁻¹λ = −J ν                            one solve_kkt of an operator
// for the change δ = ν⁺ − ν of the velocities and the impulses λ of the rows. Solved for the change, not for ν⁺: what is rounded is of
// order h.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "algorithms/dynamics/tree_operators.h"
#include "algorithms/factors/factor.h"
#include "algorithms/operators/operators.h"
#include "simulation/contact_problem.h"
#include "simulation/terms.h"
#include "simulation/yielding.h"

namespace delassus::simulation {

/// What a step came to.
struct StepReport {
  Report report;             ///< of the factor, or of the operator of equations
  std::string_view path;     ///< the path taken
  Index rows = 0;            ///< rows of this step
  Index islands = 0;         ///< mechanisms with rows that were solved apart
  int iterations = 0;        ///< of a solver, or of implicit stages
  double residual = 0;       ///< of a solver [m/s]; of implicit stages what the last change was of the largest velocity, at least of 1 m/s or rad/s
  int taken = 0, rejected = 0; ///< steps of error control within h
  double error = 0;            ///< largest of those taken, of a second [m, rad, m/s, rad/s]
  double drift = 0, left = 0;  ///< largest |φ| that the step made, and that closing left [m or rad]
  std::string message;       ///< what is wrong, in words, where it is not ok
  [[nodiscard]] bool ok() const { return report.ok() && message.empty(); }
};

template <class T> class Path {
 public:
  virtual ~Path() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// δ (n) and λ of the step's rows, equations first.
  virtual StepReport velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) = 0;
  /// What of the last step the next one starts from.
  virtual void remember(const Moment<T>& now, State<T>& next) { next.impulses = now.state->impulses; }
  /// The contact problems of the last step, in the order of their islands; a step that failed ends with the one that was not solved.
  using Visit = std::function<void(const ContactProblem<double>& problem, bool solved)>;
  virtual void problems(const Visit&) const {}
  [[nodiscard]] virtual Index bytes() const = 0;
};

template <class T> class FreePath final : public Path<T> {
 public:
  explicit FreePath(std::shared_ptr<const Structure> structure);
  [[nodiscard]] std::string_view name() const override { return "free"; }
  StepReport velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) override;
  [[nodiscard]] Index bytes() const override { return factor_.bytes() + work_.size() * static_cast<Index>(sizeof(T)); }

 private:
  std::shared_ptr<const Structure> structure_;  // without rows
  delassus::Plan plan_;
  Factor<T> factor_;
  Workspace<T> work_;
  VectorX<T> push_;
};

template <class T> class EquationsPath final : public Path<T> {
 public:
  static constexpr double of_correction = 1e-6;  ///< accuracy asked of a correction where rows give way: relative, in the energy norm
  EquationsPath(std::shared_ptr<const Structure> structure, Damping<T> damping, const std::string& op, double accuracy);
  [[nodiscard]] std::string_view name() const override { return "equations"; }
  StepReport velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) override;
  [[nodiscard]] Index bytes() const override { return operator_->bytes() + (yielding_ ? yielding_->bytes() : 0) + work_.size() * static_cast<Index>(sizeof(T)); }

  /// Numbers for `correct`, after a step that was solved by others.
  void take(const Problem<T>& problem) { taken_ = operator_->update(problem, damping_), numbers_ = &problem, yields_ = yielding_is_current_ = false; }
  /// The shortest change d of the joints, in the norm of M̂, with J d + R⁻¹μ = −gap, by the factor of the last step; rows that
  /// contradict each other give way (yielding.h). A step of Newton: what is bent leaves more than of_correction of a gap of 10⁻⁶. Of hard
  /// rows one evaluation, that of the independent ones: what it leaves is seen in φ. The problem of `take` must live until then.
  Report correct(const VectorX<T>& gap, VectorX<T>& d);
  /// Rows that depend on each other give way in further corrections; false: they do already, or there are none.
  bool yield();

 private:
  bool is_rounding(const Report& report, const VectorX<T>& change);
  std::unique_ptr<Operator<T>> operator_;
  Damping<T> damping_;
  Report taken_;
  const Problem<T>* numbers_ = nullptr;
  std::unique_ptr<Yielding<T>> yielding_;
  bool yields_ = false, yielding_is_current_ = false;  // since the last take
  double accuracy_, accuracy_of_correction_;
  Workspace<T> work_;
  TreeOperators<T> tree_;
  MatrixX<T> push_, wanted_, motion_, rows_, nu_;
};

}  // namespace delassus::simulation
