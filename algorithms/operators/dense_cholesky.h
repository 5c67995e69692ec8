// dense_cholesky: the textbook three steps, everything explicit.
//
// What     A = J M⁻¹ Jᵀ + R⁻¹ as a dense matrix; apply is a product, solve an LDLᵀ substitution.
// Formula  M = L D Lᵀ;  Y = L⁻¹ Jᵀ;  A = Yᵀ D⁻¹ Y + R⁻¹ = L_A D_A L_Aᵀ
// Singular M: lost_pivot at a joint's first degree of freedom. A (redundant rows at zero damping): lost_pivot at a row, on solve only.
// How      M by composite inertias along paths to the root, J by paths, square-root-free Cholesky (ldlt.h). M leaf first: its zeros
//          between branches stay exact zeros in L. Root first they fill up, and a body at the ground ties its branches together
//          by what rounding leaves there.
// Cost     n³/3 + n² m + n m² + m³/3 operations for update, m³/3 + m² n for a new damping's factor alone m³/3; 2 m² apply.
// Workspace  none beyond the operator's own n² + 2 n m + 2 m².
// Error    apply normwise κ(M); solve normwise κ(A), backward stable in A.
// Source   paper, section II, with R. Featherstone, Rigid Body Dynamics Algorithms, table 6.2 for M.
#pragma once

#include "algorithms/operators/operator.h"
#include "algorithms/factors/block_diagonal.h"

namespace delassus {

template <class T> class DenseCholesky : public Operator<T> {
 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index) const override { return 0; }
  [[nodiscard]] Index do_kkt_workspace() const override { return M_.rows(); }
  [[nodiscard]] Index do_bytes() const override;

 private:
  void assemble_M(const Problem<T>& problem);
  void assemble_J(const Problem<T>& problem);

  std::vector<Matrix6<T>> composite_;  // Σ of the H below each body; below, degrees of freedom run backwards
  MatrixX<T> M_;                       // n × n, then its factor
  MatrixX<T> Y_;                       // n × m: Jᵀ, then L⁻¹Jᵀ
  MatrixX<T> DY_;                      // n × m: D⁻¹ L⁻¹ Jᵀ
  MatrixX<T> A0_, A_, factor_;         // m × m: J M⁻¹ Jᵀ; with damping; its factor
  BlockDiagonal<T> damping_;
  Report factored_M_, factored_A_;
};

}  // namespace delassus
