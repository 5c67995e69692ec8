// The shortest way onto rows that contradict each other a little: hard rows of which some depend on the others, but for the last digits
// of a file or for what a step has left open.
//
//   min over d  ½ dᵀM̂ d + ½ (J d + gap)ᵀ E⁻¹ (J d + gap),   E = R⁻¹, or ε times the diagonal of J M̂⁻¹Jᵀ (its mean, where a row is hardly moved) where that is larger
// What   the operator of equations refuses (`inconsistent`): no d has J d = −gap. This one has always an answer; what weighs σ in J M̂⁻¹Jᵀ falls
//        to ε/(ε + σ) of what it was, so that a few displacements close what can be closed, and nothing goes far for what cannot.
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
  [[nodiscard]] Report displacement(const VectorX<T>& gap, VectorX<T>& d);
  [[nodiscard]] Index bytes() const { return operator_->bytes(); }

 private:
  DelassusBlocks<T> blocks_;
  std::unique_ptr<Operator<T>> operator_;
  Workspace<T> work_;
  MatrixX<T> push_, wanted_, motion_, rows_;
  VectorX<T> diagonal_;
  Damping<T> E_;
};

}  // namespace delassus::simulation
