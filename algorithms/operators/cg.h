// cg: conjugate gradients on A = J M⁻¹ Jᵀ + R⁻¹, each product by two articulated-body sweeps.
// cg_preconditioned: the same with z = (J M⁻¹Jᵀ + R₀⁻¹)⁻¹ r by lcaba in float, R₀ capped at g = 2¹³ (capped_inverse.h).
//
// What     f = A⁻¹ a by Krylov iteration; a = A f directly.
// Formula  Hestenes and Stiefel's recurrences.
// Singular A may be singular when a lies in its range (redundant rows without damping): the iterate is then a solution
//          without null-space part. Stagnation is not_converged, with the backward error reached; also where J M⁻¹Jᵀ is a small difference of large numbers: rounding hides it.
// How      stops when the recurrence's residual falls below eps (λmax ‖f‖ + ‖a‖), λmax the largest Rayleigh quotient seen,
//          or after 10 m + 50 iterations, or as many as wanted; then the residual is recomputed, and where rounding has left
//          it larger the iteration starts again from it, up to three times. In exact arithmetic at most m iterations suffice.
// Cost     per iteration one apply of aba_sweep + 10 m operations; about √κ(A) iterations. Preconditioned: also one
//          solve of lcaba in float; about √(1 + R λmax / g) iterations, one more per group of dependent rows.
// Workspace  that of aba_sweep + 4 m; preconditioned: + m + that of lcaba in float.
// Error    normwise κ(A).
// Source   M. Hestenes, E. Stiefel, Methods of conjugate gradients for solving linear systems, 1952 (paper's [1]).
#pragma once

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/factors/capped_inverse.h"
#include "algorithms/factors/factor.h"
#include "algorithms/operators/column_by_column.h"

namespace delassus {

/// z = r.
template <class T> class NoPreconditioner {
 public:
  explicit NoPreconditioner(double) {}
  void analyze(const Structure& structure) { rows_ = structure.rows; }
  [[nodiscard]] Report update(const Problem<T>&, const Factor<T>&) { return {}; }
  [[nodiscard]] Report update_damping(const Damping<T>&) { return {}; }
  void solve_kkt(const T*, const T* r, T*, T* z, T*) const { std::copy(r, r + rows_, z); }
  [[nodiscard]] Index workspace() const { return 0; }
  [[nodiscard]] Index bytes() const { return 0; }

 private:
  Index rows_ = 0;
};

template <class T, class Preconditioner> class CgWith : public ColumnByColumn<T> {
 public:
  static constexpr int max_starts = 3;
  static constexpr bool plain = std::is_same_v<Preconditioner, NoPreconditioner<T>>;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_kkt_workspace() const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  Report take_rows(const Problem<T>& problem, const Damping<T>& damping);
  /// From x = f where `start` says so.
  Report iterate(const T* a, T* f, Accuracy wanted, Start start, T* workspace) const;
  void multiply(const T* x, T* y, T* workspace) const;
  void precondition(const T* r, T* z, T* work) const;

  Plan plan_;
  Factor<T> factor_;
  BlockDiagonal<T> damping_;  // R⁻¹
  Preconditioner preconditioner_{0x1p13};
  Report undamped_, factored_, preconditioned_;
};

template <class T> using Cg = CgWith<T, NoPreconditioner<T>>;
/// The scalar a preconditioner runs in: float for double.
template <class T> using Narrow = std::conditional_t<std::is_same_v<T, double>, float, T>;
template <class T> using CgPreconditioned = CgWith<T, CappedInverse<T, Narrow<T>>>;

}  // namespace delassus
