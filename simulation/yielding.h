// Rows that contradict each other a little: hard rows of which some depend on the others, but for the last digits of a file or for what
// a step has left open.
//
//   M̂ ν − Jᵀλ = r₁,  J ν + E λ = r₂ + (E − R⁻¹) λ before: proximal points, λ = 0 before the first
//   of one point: min over ν  ½ νᵀM̂ ν − r₁ᵀν + ½ (J ν − r₂)ᵀ E⁻¹ (J ν − r₂),   E = R⁻¹, or ε times the diagonal of J M̂⁻¹Jᵀ (its mean, where a row is hardly moved) where that is larger
// What   the operator of equations refuses (`inconsistent`): no ν has J ν = r₂. This one has always an answer; what weighs σ in J M̂⁻¹Jᵀ falls
//        to ε/(ε + σ) of what it was with every point, so that a few close what can be closed, and nothing goes far for what cannot.
// Cost   an update of lcaba_qr and the diagonal, O(n + m) with local loops; only where it is called for.
#pragma once

#include <memory>

#include "algorithms/dynamics/delassus_blocks.h"
#include "algorithms/operators/operators.h"

namespace delassus::simulation {

template <class T> class Yielding {
 public:
  static constexpr double epsilon = 1e-6;
  explicit Yielding(const std::shared_ptr<const Structure>& structure);
  /// @throws nothing; Report: that of the diagonal, or of the operator.
  [[nodiscard]] Report update(const Problem<T>& problem, const Damping<T>& damping);
  /// ν (n × 1) and λ (m × 1) after some points.
  [[nodiscard]] Report solve(const MatrixX<T>& r1, const MatrixX<T>& r2, int points, Accuracy accuracy, MatrixX<T>& nu, MatrixX<T>& lambda);
  [[nodiscard]] Index bytes() const { return operator_->bytes(); }

 private:
  DelassusBlocks<T> blocks_;
  std::unique_ptr<Operator<T>> operator_;
  Workspace<T> work_;
  MatrixX<T> r2_;
  VectorX<T> diagonal_, added_;  // E − R⁻¹
};

}  // namespace delassus::simulation
