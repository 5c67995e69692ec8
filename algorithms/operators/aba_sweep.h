// aba_sweep: the Delassus operator by the articulated-body algorithm, two sweeps.
//
// What     a = J M⁻¹ Jᵀ f + R⁻¹ f, M never formed.
// Formula  Jᵀ (Alg. 1), M⁻¹ (Alg. 2) and J (Alg. 3) merged: the constraint forces start the backward sweep, the link
//          accelerations of the forward sweep give J ν.
// Singular when M is: a massless body without armature. Reported as lost_pivot.
// How      Factor of M (factor.h); branches without rows are factored but never visited by a vector.
// Cost     O(n + m): update about 330 operations per one-dof joint, apply about 45 n + 12 per K row.
// Workspace  8 per active body + 1 per active degree of freedom, per column.
// Error    componentwise: within the data's own sensitivity.
// Source   paper, Algorithms 1–3 and section IV-D (with f_i started at +Kᵀλ in the force convention).
#pragma once

#include <algorithm>

#include "algorithms/operators/operator.h"
#include "algorithms/factors/factor.h"

namespace delassus {

/// y = (J M⁻¹Jᵀ + R⁻¹) x by the factor of M; rows that are off take no part. Shapes m. `work`: the factor's, and padded m behind it.
template <class T, class V>
void delassus_product(const Factor<T>& M, const BlockDiagonal<T>& damping, Index m, const V* x, V* y, V* work) {
  V* const damped = work + M.workspace();
  const V* forces = x;
  if (!damping.off().empty()) {
    std::copy(x, x + m, damped);
    damping.switch_off(damped);
    forces = damped;
  }
  M.project(forces, y, work);
  damping.multiply(x, damped);
  for (Index r = 0; r < m; ++r) y[r] += damped[r];
  damping.switch_off(y);
}

template <class T> class AbaSweep : public Operator<T> {
 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  Plan plan_;
  Factor<T> factor_;
  BlockDiagonal<T> damping_;  // R⁻¹
  Report factored_;
};

}  // namespace delassus
