// lcaba_refined: lcaba with adaptive refinement on the KKT residual, and a certificate. The default inverse.
//
// What     f = Λ_R a to full accuracy wherever eps · R λmax(Λ⁻¹) < 1, with a rigorous error bound.
// Formula  with r₁, r₂ of kkt_residual.h:  M_R δν = r₁ + JᵀR r₂,  δλ = R (r₂ − J δν),  ν += δν, λ += δλ.
// Singular as lcaba. Refinement that stops contracting above its target is reported as not_converged.
// How      same factor as lcaba; ν and λ are carried as Wide<T>. After step k the size d_k of the correction estimates the
//          error before it; the error after it is about d_k · d_k/d_{k−1} (d_0 = 1), and steps end when that is below eps.
// Certificate  B² = r₁ᵀM⁻¹r₁ + r₂ᵀR r₂ ≥ ‖δν‖²_M + ‖δλ‖²_{R⁻¹} at the final iterate, by one backward sweep of the factor
//          of M; hence |δλ_i| ≤ √R_i B. error_bound is B relative to the energy norm of the solution.
// Cost     update: lcaba + the factor of M; solve: lcaba + (k + 1) residuals + k sweeps; k = 1 mostly.
// Workspace  that of lcaba + the residual's + 4 n + 6 m.
// Error    componentwise: within the data's own sensitivity, when it reports ok.
// Source   N. Higham, Accuracy and Stability, chapter 12, for refinement.
#pragma once

#include "algorithms/delassus.h"
#include "algorithms/factor.h"
#include "algorithms/kkt_residual.h"

namespace delassus {

template <class T> class LcabaRefined : public Operator<T> {
 public:
  static constexpr int max_steps = 5;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  using W = Wide<T>;
  struct Buffers;  // one column's vectors in the workspace
  Report solve_column(const T* a, T* f, T* workspace) const;
  /// One correction; returns its size: the larger of max|δλ| / max|λ| and ‖δν‖_{M_R} / √(λᵀa).
  double correct(Buffers& b, T* workspace) const;
  double energy_norm(const Buffers& b) const;
  /// B relative to the energy norm of (ν, λ).
  double certify(Buffers& b, T* workspace) const;

  Plan plan_, plan_M_;
  Factor<T> factor_, factor_M_;
  BlockDiagonal<T> weights_;  // R
  KktResidual<T> residual_;
  Report undamped_, factored_M_, factored_;
};

}  // namespace delassus
