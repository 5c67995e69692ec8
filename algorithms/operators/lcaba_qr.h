// lcaba_qr: the damped inverse by square-root (QR) elimination, refined. For where lcaba_refined gives up.
//
// What     f = Λ_R a = (R⁻¹ + J M⁻¹ Jᵀ)⁻¹ a for any R > 0, however large R λmax(Λ⁻¹) is and however redundant the rows.
// Formula  ν minimises ‖ν‖²_M + ‖a − J ν‖²_R;  λ = Wᵀ ρ, ρ the weighted residual of the fit, WᵀW = R.
// Singular when M is (lost_pivot); R⁻¹ must be positive (zero_damping names the row).
// How      SquareRootFactor in the order of lcaba; refinement.h with the same factor, which mostly takes one step.
// Cost     update: that of SquareRootFactor; solve: (k + 1) solves and residuals for k steps; O(n + m)
//          with local loops. About 3.5 times the operations of lcaba, 6 where many bodies couple (bench, update + solve).
// Workspace  refinement.h's with that of SquareRootFactor.
// Error    as lcaba_refined, but at any R: the first evaluation is accurate in ν, its λ is off only by forces that
//          move nothing (redundant rows), and so is every correction relative to its own size.
// Source   square_root_factor.h; refinement: Å. Björck, 1967, on the augmented system.
#pragma once

#include "algorithms/factors/square_root_factor.h"
#include "algorithms/operators/refined.h"

namespace delassus {

template <class T> class LcabaQr : public Refined<T> {
 public:
  static constexpr int max_steps = 8;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  SquareRootFactor<T> factor_;
  Refinement<T> refinement_;
  Report factored_;
};

}  // namespace delassus
