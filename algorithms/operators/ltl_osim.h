// ltl_osim: the Delassus matrix by the branch sparsity of M, J and L.
//
// What     A₀ = J M⁻¹ Jᵀ; A = A₀ + R⁻¹ as explicit.h.
// Formula  M = LᵀDL;  Y = J L⁻¹;  A₀ = Y D⁻¹ Yᵀ
// Singular M: lost_pivot at a joint's first degree of freedom.
// How      Branch by branch (branch_factor.h); a row of Y has the support of that of J, closed under ancestors, loops included
//          (branch_rows.h). For two groups of rows the product runs over what both supports have in common: runs of neighbouring
//          degrees of freedom, found once; the ways to the root of their common bodies, nothing between different trees.
// Cost     update O(n d²) for M, O(m d²) for Y, O(m² d) for the product, d the degrees of freedom on the way to a root (of a loop:
//          on all of its ways).
// Workspace  n for a pair. Holds n d + m d + 3 m² numbers, and the runs.
// Error    apply within the data's sensitivity: the roundings of LᵀDL are those of √(M_ii M_jj) (branch_factor.h); solve normwise κ(A).
// Source   R. Featherstone 2010, Exploiting sparsity in operational-space dynamics (paper's [21]); loops: rows with several bodies.
#pragma once

#include "algorithms/operators/ltl.h"

namespace delassus {

template <class T> class LtlOsim : public Ltl<T> {
 protected:
  void analyze_form() override;
  void form(const Problem<T>& problem, MatrixX<T>& A0) override;
  [[nodiscard]] Index form_bytes() const override;

 private:
  struct Run {  // count degrees of freedom, from place a of group `of` and place b of group `with` ≥ of on
    Index of, with, a, b, count;
  };
  std::vector<Run> runs_;  // ascending in `of`
  std::vector<T> scaled_;  // Y D⁻¹ of one group
};

}  // namespace delassus
