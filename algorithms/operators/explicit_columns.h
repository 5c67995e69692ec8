// explicit_columns: the Delassus matrix column by column.
//
// What     A₀ = J M⁻¹ Jᵀ by one product of aba_sweep per row; A = A₀ + R⁻¹ as explicit.h.
// Formula  A₀ e_r, r = 1 … m
// Singular M: lost_pivot at a joint's first degree of freedom.
// How      Unit vectors eight at a time where the scalar has lanes: what a matrix-free operator must beat to be worth applying.
// Cost     update O(n) for the factor of M and O(m (n + m)) for the columns, about 45 n + 12 per K row each.
// Workspace  that of aba_sweep.
// Error    apply componentwise, as aba_sweep; solve normwise κ(A).
// Source   paper, Algorithms 1–3 (section IV-D).
#pragma once

#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T> class ExplicitColumns : public ExplicitBySweeps<T> {
 protected:
  void analyze_form() override;
  void form(const Problem<T>& problem, MatrixX<T>& A0) override;
  [[nodiscard]] Index form_bytes() const override;

 private:
  std::unique_ptr<Workspace<T>> work_;
};

}  // namespace delassus
