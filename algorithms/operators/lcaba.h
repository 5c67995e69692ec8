// lcaba: the damped inverse by the loop-constrained articulated-body algorithm and the matrix inversion lemma.
//
// What     f = Λ_R a = (R⁻¹ + J M⁻¹ Jᵀ)⁻¹ a, no m × m matrix formed.
// Formula  f = R a − R J M_R⁻¹ Jᵀ R a,   M_R = M + Jᵀ R J      (paper, equation 9)
// Singular when M_R is (lost_pivot); R⁻¹ must be positive (zero_damping names the row).
// How      Factor of M_R in minimum-degree order, children before parents (elimination.h); the compliant force R a starts
//          the backward sweep, the link accelerations of the forward sweep give J ν. On trees with unary constraints no
//          coupling exists and this is the constrained articulated-body algorithm.
// Cost     O(n + m) with localised loops; update adds 72 operations per K row and pair of links, 72 n_i (|Q_i|+1)²/2 per step.
// Workspace  8 per active body + 1 per active degree of freedom + 2 m, per column.
// Error    amplified: loses log10(R·λmax(Λ⁻¹)) digits, since f is the small difference of R a and R J ν.
// Source   paper, Algorithm 4 and section V-D, with the corrections of docs/paper_notes.md.
#pragma once

#include "algorithms/operators/operator.h"
#include "algorithms/factors/factor.h"
#include "algorithms/kit/columns.h"

namespace delassus {

template <class T> class Lcaba : public Operator<T> {
 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_kkt_workspace() const override { return factor_.solve_workspace() + padded(this->size()); }
  [[nodiscard]] Index do_bytes() const override;

 private:
  Plan plan_;
  Factor<T> factor_;
  BlockDiagonal<T> weights_;  // R
  Report undamped_, factored_;  // of phase A, and of the whole factor
};

}  // namespace delassus
