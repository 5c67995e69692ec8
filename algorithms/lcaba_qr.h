// lcaba_qr: the damped inverse by square-root elimination, with one refinement step. For where lcaba_refined gives up.
//
// What     f = Λ_R a = (R⁻¹ + J M⁻¹ Jᵀ)⁻¹ a for any R > 0, however large R λmax(Λ⁻¹) is.
// Formula  ν minimises ‖ν‖²_M + ‖a − J ν‖²_R;  λ = Wᵀ ρ, ρ the weighted residual of the fit, WᵀW = R.
// Singular when M is (lost_pivot); R⁻¹ must be positive (zero_damping names the row).
// How      SquareRootFactor in the order of lcaba; then one step on the residual of kkt_residual.h with the same factor.
// Cost     update and solve are those of SquareRootFactor, solved twice, and one residual; O(n + m) with local loops.
// Workspace  that of SquareRootFactor or of the residual, + 6 n + 6 m.
// Error    componentwise: Q is read, never inverted, so that no digits are lost to the size of R (tested, not proven).
// Source   square_root_factor.h; refinement: Å. Björck, 1967, on the augmented system.
#pragma once

#include "algorithms/delassus.h"
#include "algorithms/kkt_residual.h"
#include "algorithms/square_root_factor.h"

namespace delassus {

template <class T> class LcabaQr : public Operator<T> {
 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  void solve_column(const T* a, T* f, T* workspace) const;

  SquareRootFactor<T> factor_;
  KktResidual<T> residual_;
  Report factored_;
};

}  // namespace delassus
