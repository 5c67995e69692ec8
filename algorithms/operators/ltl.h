// What operators share that factor M = LᵀDL by branches (branch_factor.h, branch_rows.h): all but how A₀ = Y D⁻¹ Yᵀ is summed,
// Y = J L⁻¹. A pair (ν, λ):  z = L⁻ᵀr₁,  A λ = r₂ − Y D⁻¹ z,  ν = L⁻¹D⁻¹(z + Yᵀλ).
#pragma once

#include "algorithms/factors/branch_rows.h"
#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T> class Ltl : public Explicit<T> {
 protected:
  void analyze_form() override;
  Report factor_M(const Problem<T>& problem) override { return factor_.update(problem); }
  void subtract_rates(const T* r1, T* x, T* work) const override;
  void motion(const T* r1, const T* lambda, T* nu, T* work) const override;
  [[nodiscard]] Index pair_workspace() const override { return factor_.dofs(); }
  [[nodiscard]] Index form_bytes() const override { return factor_.bytes() + rows_.bytes(); }

  BranchFactor<T> factor_;
  BranchRows<T> rows_;
};

}  // namespace delassus
