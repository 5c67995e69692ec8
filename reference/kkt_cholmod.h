// Maximal coordinates, sparse: the system of kkt.h by CHOLMOD's simplicial LDLᵀ in double, refined with residuals in
// Quad. For sizes the dense references cannot reach: 10⁴ bodies and more.
//
// CHOLMOD does not exchange pivots, so the order decides whether they exist. With H_i > 0:
//   1. Each body is one group, eliminated a_i, φ_i, ν_i. The pivots are H_i > 0 (and what others added to it), then
//      −H_i⁻¹ < 0, then S_iᵀ(…)⁻¹S_i > 0: armature may be zero. Signs of later groups are unchanged by earlier ones
//      (a Schur complement of [P Bᵀ; B −D] with P, D ⪰ 0 has that form again), so groups may come in any order.
//   2. A constraint with enough damping (R⁻¹ > 2⁻³⁰ · Σ K_i H_i⁻¹ K_iᵀ) has the pivot −R⁻¹ − … < 0: any place.
//   3. Other constraints come after all bodies; their pivots are then those of −A, regular exactly when A is.
// Within these rules CAMD orders the graph of bodies and constraints for small fill.
//
// Afterwards every pivot is examined: its sign must be the expected one, and |d| / (eps · bound) ≥ 30 with bound the
// diagonal of |L||D||Lᵀ|. A singular H_i, redundant undamped rows and hopeless ratios of masses show there.
// Refinement ends when corrections stop to halve. Its result is rejected unless the last correction was below
// 2⁻⁶⁰ of the answer. Cost: fill dependent; O(N) for trees with local constraints.
#pragma once

#include <memory>

#include "algorithms/kit/test_scalars.h"
#include "reference/kkt.h"

namespace delassus::reference {

/// a = A f, shapes m×k. @throws std::runtime_error when a pivot is lost or refinement does not converge.
[[nodiscard]] MatrixX<Quad> kkt_cholmod_apply(const Problem<double>& problem, const Damping<double>& damping,
                                              const MatrixX<double>& f);
/// f = A⁻¹ a, shapes m×k. @throws as above.
[[nodiscard]] MatrixX<Quad> kkt_cholmod_solve(const Problem<double>& problem, const Damping<double>& damping,
                                              const MatrixX<double>& a);
/// L has at most 5·10⁷ numbers and takes at most 10¹⁰ operations, and no pivot is lost. Cost: one factorisation.
[[nodiscard]] bool kkt_cholmod_trusts(const Problem<double>& problem, const Damping<double>& damping);

/// The factorisation by itself: one solve in double, nothing refined. What is measured, not what is trusted.
class SparseKkt {
 public:
  /// Order and fill. @throws std::runtime_error when CHOLMOD cannot.
  SparseKkt(const Problem<double>& problem, const Damping<double>& damping);
  ~SparseKkt();
  /// The numbers, of the same structure and with the same zeros. False: a pivot is lost.
  [[nodiscard]] bool update(const Problem<double>& problem, const Damping<double>& damping);
  /// A⁻¹ a after an update that was not refused. Shapes m, m.
  [[nodiscard]] VectorX<double> solve(const VectorX<double>& a) const;
  /// Of factorisation and one solve, by CHOLMOD's count.
  [[nodiscard]] double operations() const;

  class Factor;  ///< CHOLMOD's objects

 private:
  std::unique_ptr<Factor> factor_;
  KktLayout layout_;
};

}  // namespace delassus::reference
