// proximal: the damping removed, or the arithmetic narrowed, by iterating with an inverse of capped stiffness.
//
// What     f = (J M⁻¹Jᵀ + R⁻¹)⁻¹ a for any R⁻¹ ≥ 0, hard rows (R⁻¹ = 0) included.
// Formula  refinement.h on (K) with CappedInverse: R₀⁻¹ = R⁻¹ + diag(s).
// Singular A must be regular; with dependent hard rows and a in the range of A it converges to one of the solutions, slowly
//          where a direction of J M⁻¹Jᵀ is weak; not_converged otherwise.
// Rows     proximal      F = T, g = 2²⁰: hard constraints to round-off in a few steps when the rows are independent.
//          lcaba_float   F = float for T = double, g = 2¹³: factor and sweeps in half the memory and time.
// Cost     update: factors of M and M_R₀; per step one residual and one sweep pair; the steps are the report's iterations.
// Workspace  refinement's + that of lcaba in F.
// Error    refined.
// Source   refinement.h, capped_inverse.h.
#pragma once

#include "algorithms/factors/capped_inverse.h"
#include "algorithms/operators/refined.h"

namespace delassus {

template <class T, class F> class ProximalWith : public Refined<T> {
 public:
  static constexpr int max_steps = 64;
  bool solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const override;
  ProximalWith() : inverse_(std::is_same_v<F, float> ? 0x1p13 : 0x1p20) {}

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  Report take_rows(const Problem<T>& problem, const Damping<T>& damping);
  Refinement<T> refinement_;
  CappedInverse<T, F> inverse_;
  Report undamped_, factored_;
};

template <class T> using Proximal = ProximalWith<T, T>;
template <class T> using LcabaFloat = ProximalWith<T, float>;

}  // namespace delassus
