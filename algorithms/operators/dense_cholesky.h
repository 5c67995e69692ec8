// dense_cholesky: the textbook three steps, everything explicit.
//
// What     A₀ = J M⁻¹ Jᵀ by dense matrices; A = A₀ + R⁻¹ as explicit.h.
// Formula  M = L D Lᵀ;  Y = L⁻¹ Jᵀ;  A₀ = Yᵀ D⁻¹ Y
// Singular M: lost_pivot at a joint's first degree of freedom.
// How      M by composite inertias along paths to the root, J by paths, square-root-free Cholesky (ldlt.h). M leaf first: its zeros
//          between branches stay exact zeros in L. Root first they fill up, and a body at the ground ties its branches together
//          by what rounding leaves there.
// Cost     n³/3 + n² m + n m² + m³/3 operations for update, m³/3 + m² n for a new damping's factor alone m³/3; 2 m² apply.
// Workspace  n for a pair, beyond the operator's own n² + 2 n m + 3 m².
// Error    apply normwise κ(M); solve normwise κ(A), backward stable in A.
// Source   paper, section II, with R. Featherstone, Rigid Body Dynamics Algorithms, table 6.2 for M.
#pragma once

#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T> class DenseCholesky : public Explicit<T> {
 protected:
  void analyze_form() override;
  Report factor_M(const Problem<T>& problem) override;
  void form(const Problem<T>& problem, MatrixX<T>& A0) override;
  void subtract_rates(const T* r1, T* x, T* work) const override;
  void motion(const T* r1, const T* lambda, T* nu, T* work) const override;
  [[nodiscard]] Index pair_workspace() const override { return M_.rows(); }
  [[nodiscard]] Index form_bytes() const override;

 private:
  void assemble_M(const Problem<T>& problem);
  void assemble_J(const Problem<T>& problem);

  std::vector<Matrix6<T>> composite_;  // Σ of the H below each body; below, degrees of freedom run backwards
  MatrixX<T> M_;                       // n × n, then its factor
  MatrixX<T> Y_;                       // n × m: Jᵀ, then L⁻¹Jᵀ
  MatrixX<T> DY_;                      // n × m: D⁻¹ L⁻¹ Jᵀ
};

}  // namespace delassus
