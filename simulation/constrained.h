// Accelerations under rows that always hold, and the way back onto them: what methods with stages need for loops.
//
//   M ν̇ − Jᵀλ = f,   J ν̇ = −J̇ν                          hard rows (paper, equations 2 and 5 with a_des = −J̇ν)
//   q ← q ⊕ d,   min ‖d‖_M   with  J d = −φ(q)            after a step: chord steps, as closing.h
//   ν ← ν + δ,   min ‖δ‖_M   with  J δ = −J ν             at that q
// The way back is shorter than the error of a step, so the order of the method is kept. M is M̂ where stages are implicit (runge_kutta.h).
// Axes     ν̇ of floating joints is asked for with ω × v left to the axes (runge_kutta.h): J ν̇ = −(J̇ν − J (0; ω × v)).
// Cost     an update and a solve of the operator for accelerations; to go back up to two updates and four solves.
// Source   paper, section II; E. Hairer, C. Lubich, G. Wanner 2006, IV.4 (projection).
#pragma once

#include "algorithms/dynamics/tree_operators.h"
#include "algorithms/mechanism/motion.h"
#include "algorithms/operators/operators.h"
#include "simulation/terms.h"
#include "simulation/yielding.h"

namespace delassus::simulation {

template <class T> class Constrained {
 public:
  static constexpr double closed = 1e-12;  ///< [m, rad]
  static constexpr int yielding_points = 4;  ///< rows that are held to 1e-3 of their diagonal by one are held to rounding

  /// `model` and `mechanism` with the rows; they must outlive this. @throws ModelError for an operator that does not exist.
  Constrained(const Model& model, Mechanism<T>& mechanism, const std::string& op, double accuracy);
  /// ν̇ (n) and λ (m) [N, N m] at now.state, of the numbers and forces that are gathered there.
  Report accelerations(Moment<T>& now, VectorX<T>& out, VectorX<T>& lambda);
  /// Back onto the rows, of numbers gathered at `next`; sets now.drift and now.left.
  Report project(Moment<T>& now, State<T>& next);

 private:
  T gap_at(const VectorX<T>& q, MatrixX<T>& gap);
  Report solve(const Problem<T>& problem, const MatrixX<T>& push, const MatrixX<T>& wanted);
  Report solve_yielding(const Problem<T>& problem, const MatrixX<T>& push, const MatrixX<T>& wanted);

  const Model* model_;
  Mechanism<T>* mechanism_;
  Advance<T> advance_;
  Motion<T> motion_;
  std::unique_ptr<Operator<T>> operator_;
  std::unique_ptr<Yielding<T>> yielding_;  // where rows contradict each other
  Damping<T> hard_;
  double accuracy_;
  Workspace<T> work_;
  TreeOperators<T> tree_;
  std::vector<Index> floating_;  // first degree of freedom
  Poses<T> poses_;
  VectorX<T> bias_, d_, q_;
  MatrixX<T> push_, wanted_, change_, lambda_, nu_, gap_, gap_then_;
};

}  // namespace delassus::simulation
