// What operators share that form A₀ = J M⁻¹Jᵀ: everything that is done with the matrix.
//
// What     A = A₀ + R⁻¹, m × m and dense; apply is a product, solve an L D Lᵀ substitution, a pair (ν, λ) goes by A alone:
//            A λ = r₂ − J M⁻¹ r₁,   ν = M⁻¹(r₁ + Jᵀλ).
// Singular M: as the row reports it. A (redundant hard rows): lost_pivot at a row, on solve only; rounding may leave a pivot above 0, and no digit.
// Off      rows and columns of rows that are off are 0 in A, and 1 on the diagonal of what is factored: λ_r = 0.
// How      A and its factor by tiles of the lower triangle, none where no tree and no constraint couples rows (symmetric_tiles.h).
// Cost     beyond A₀: m² + m³/3 for a new damping, 2 m² per apply and per solve, 2 m² numbers; where bodies are many and free the sums
//          over L's columns of coupled_rows.h in their place, and m² numbers.
// Workspace  2 m, and m more for a pair than its own.
// Error    apply that of A₀; solve normwise κ(A), backward stable in A (symmetric_tiles.h).
//
// A row of the table derives from Explicit and gives the eight functions below, or from ExplicitBySweeps, which has all but
// `form`, from the articulated-body factor of M (factor.h).
#pragma once

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/factors/factor.h"
#include "algorithms/factors/symmetric_tiles.h"
#include "algorithms/operators/operator.h"

namespace delassus {

template <class T> class Explicit : public Operator<T> {
 protected:
  /// Allocates everything.
  virtual void analyze_form() = 0;
  /// What depends on M alone. Report: lost_pivot at a joint's first degree of freedom; the others are not called then.
  virtual Report factor_M(const Problem<T>& problem) = 0;
  /// The lower triangle of J M⁻¹Jᵀ into the zeros of A0, m × m; again for rows K and 𝒦 that moved.
  virtual void form(const Problem<T>& problem, MatrixX<T>& A0) = 0;
  /// x −= J M⁻¹ r₁. Shapes m, n. `work` has pair_workspace() numbers, and reaches `motion` as it was left.
  virtual void subtract_rates(const T* r1, T* x, T* work) const = 0;
  /// ν = M⁻¹(r₁ + Jᵀλ), after subtract_rates of the same r₁.
  virtual void motion(const T* r1, const T* lambda, T* nu, T* work) const = 0;
  [[nodiscard]] virtual Index pair_workspace() const = 0;
  [[nodiscard]] virtual Index form_bytes() const = 0;

  void do_analyze() final;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) final;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) final;
  Report do_update_damping(const Damping<T>& damping) final;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const final;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const final;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const final;
  [[nodiscard]] Index do_workspace(Index) const final { return 2 * padded(this->size()); }
  [[nodiscard]] Index do_kkt_workspace() const final { return padded(this->size()) + pair_workspace(); }
  [[nodiscard]] Index do_bytes() const final;

 private:
  void solve_multipliers(const T* right, T* lambda, T* work) const;

  MatrixX<T> A0_;                  // m × m: J M⁻¹Jᵀ, its lower triangle
  SymmetricTiles<T> A_, factor_;   // with damping; its factor
  BlockDiagonal<T> damping_;
  Report factored_M_, factored_A_;
};

/// M⁻¹ by the articulated-body algorithm.
template <class T> class ExplicitBySweeps : public Explicit<T> {
 protected:
  void analyze_form() override;
  Report factor_M(const Problem<T>& problem) override;
  void subtract_rates(const T* r1, T* x, T* work) const override;
  void motion(const T* r1, const T* lambda, T* nu, T* work) const override;
  [[nodiscard]] Index pair_workspace() const override;
  [[nodiscard]] Index form_bytes() const override;

  Plan plan_;
  Factor<T> factor_M_;  // of M; takes new rows before `form`: factor_M_.move_rows
};

}  // namespace delassus
