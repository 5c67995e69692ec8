// A scene that moves: semi-implicit Euler on the manifold, at velocity level (or another row of integrators.h).
//
//   M̂ = M + h d + h² k                              inertia terms
//   M̂ (ν⁺ − ν) − Jᵀλ = h f(q, ν)                    force terms
//   J ν⁺ + R⁻¹λ = 0, or (u, λ) in the cones          rows
//   q⁺ = q ⊕ h ν⁺                                   state.h
// Order    1 in h. Neither energy nor angular momentum is conserved to more than that: a free top drifts with h. Free fall is exact in
//          the velocities and off by g t h/2 in the position.
// Bits     depend on the state, the scene, h and the plan: not on what ran before, nor on what is not in the plan.
// Cost     that of the terms in the plan, an articulated-body factor and two sweeps; with equations, an update and a solve of the operator.
// Threads  one each. Nothing allocates in a step of the free path after the first.
#pragma once

#include "simulation/integrators.h"
#include "simulation/plan.h"
#include "simulation/constrained.h"
#include "simulation/error_control.h"

namespace delassus::simulation {

template <class T> class Simulation {
 public:
  /// At the scene's q and ν. @throws ModelError as Plan; for a step that is not positive and finite, for rows or an accuracy that the
  /// integrator does not take.
  explicit Simulation(const Scene& scene, const Settings& settings = {});
  Simulation(const Simulation&) = delete;  // its parts point at each other
  Simulation& operator=(const Simulation&) = delete;

  /// One step of h, or as many as its error asks for to get as far. When the report is not ok the state is that before the step.
  [[nodiscard]] const StepReport& step() { return (this->*take_)(); }

  [[nodiscard]] const State<T>& state() const { return state_; }
  /// Goes on from a state that was saved. @throws std::logic_error when it is another model's.
  void restore(const State<T>& state);
  [[nodiscard]] double time() const { return static_cast<double>(state_.steps) * settings_.step; }  ///< [s]
  [[nodiscard]] const Plan<T>& plan() const { return plan_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  [[nodiscard]] const StepReport& last() const { return report_; }
  [[nodiscard]] const VectorX<T>& impulses() const { return impulses_; }  ///< of the rows of the last step, equations first [N s, N m s]
  [[nodiscard]] const VectorX<T>& change() const { return change_; }      ///< ν⁺ − ν of the last step, in the axes at its start
  [[nodiscard]] const VectorX<T>& force() const { return force_; }        ///< of the last step, without rows, what is implicit at its end [N, N m]
  /// The numbers of the last step: S, H, M̂'s diagonal, rows that always hold.
  [[nodiscard]] const Problem<T>& problem() const { return problem_; }
  [[nodiscard]] const std::vector<RowSet<T>>& rows() const { return rows_; }

 private:
  void gather();  // numbers and terms at now_.state
  const StepReport& euler();
  const StepReport& still();
  const StepReport& runge_kutta();
  const StepReport& controlled();
  using Stage = typename RungeKutta<T>::Stage;
  bool accelerations(const State<T>& at, const Stage&, VectorX<T>& out);
  bool implicit_accelerations(const State<T>& at, const Stage& stage, VectorX<T>& a);
  bool solve_accelerations(VectorX<T>& out);
  bool end_at(State<T>& next);
  const StepReport& ended_at_stage();

  Settings settings_;
  Plan<T> plan_;
  Advance<T> advance_;
  State<T> state_, next_;
  Problem<T> problem_;
  std::vector<RowSet<T>> rows_;
  VectorX<T> force_, change_, impulses_;
  typename RungeKutta<T>::Acceleration acceleration_;  // of methods with stages
  std::vector<T> armature_;                            // of M, without what is implicit; where stages are
  Moment<T> now_;
  StepReport report_;
  std::unique_ptr<RungeKutta<T>> stages_;
  std::unique_ptr<ErrorControl<T>> control_;
  std::unique_ptr<Constrained<T>> constrained_;
  const StepReport& (Simulation::*take_)() = &Simulation::euler;
};

}  // namespace delassus::simulation
