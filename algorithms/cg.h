// cg: conjugate gradients on A = J M⁻¹ Jᵀ + R⁻¹, each product by two articulated-body sweeps.
//
// What     f = A⁻¹ a by Krylov iteration; a = A f directly.
// Formula  Hestenes and Stiefel's recurrences.
// Singular A may be singular when a lies in its range (redundant rows without damping): the iterate is then a solution
//          without null-space part. Stagnation is reported as not_converged with the backward error reached.
// How      stops when the recurrence's residual falls below eps (λmax ‖f‖ + ‖a‖), λmax the largest Rayleigh quotient seen,
//          or after 10 m + 50 iterations; then the residual is recomputed, and where rounding has left it larger the
//          iteration starts again from it, up to three times. In exact arithmetic at most m iterations suffice.
// Cost     per iteration one apply of aba_sweep + 10 m operations; about √κ(A) iterations.
// Workspace  that of aba_sweep + 4 m.
// Error    normwise κ(A).
// Source   M. Hestenes, E. Stiefel, Methods of conjugate gradients for solving linear systems, 1952 (paper's [1]).
#pragma once

#include "algorithms/block_diagonal.h"
#include "algorithms/delassus.h"
#include "algorithms/factor.h"

namespace delassus {

template <class T> class Cg : public Operator<T> {
 public:
  static constexpr int max_starts = 3;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  void multiply(const T* x, T* y, T* workspace) const;
  Report solve_column(const T* a, T* f, T* workspace) const;

  Plan plan_;
  Factor<T> factor_;
  BlockDiagonal<T> damping_;  // R⁻¹
  Report factored_;
};

}  // namespace delassus
