// caba_osim, caba_osimr: the damped inverse as an explicit matrix, by rows carried through the constrained factor.
//
// What     V = Λ_R = (R⁻¹ + J M⁻¹Jᵀ)⁻¹, m × m and dense, without forming or factoring J M⁻¹Jᵀ; solve is a product.
// Formula  V = R − R (J M_R⁻¹ Jᵀ) R,   M_R = M + Jᵀ R J;
//          J M_R⁻¹Jᵀ = Σ_i G_i D_i⁻¹G_iᵀ,  κ_π += κ_i,  κ_j −= G_i D_i⁻¹W_jᵀ (j ∈ Q_i)   on lcaba's own factor, loops included
//          caba_osim in the whole tree, caba_osimr in the contracted one (row_propagation.h).
// Singular when M_R is (lost_pivot); R⁻¹ must be positive (zero_damping names the row).
// Off      R = 0 in rows that are off, so that V is 0 there.
// Cost     update and new damping: lcaba's, then O(m²d) or O(n + m²), more where loops couple joints (each coupled step n_i per
//          pair of rows it sees), and 4 m² (row blocks of m_e rows: 4 m² m_e); 2 m² per solve (symmetric_tiles.h). No m³.
// Workspace  2 m; for a pair that of the sweep and m. Holds 5/2 m² numbers and those of row_propagation.h.
// Error    amplified: V is the small difference of R and R (J M_R⁻¹Jᵀ) R, as lcaba's.
// Source   A. S. Sathya, J. Carpentier, Constrained articulated body dynamics algorithms, 2025 (trees, unary rows); loops:
//          docs/paper_notes.md.
#pragma once

#include "algorithms/factors/row_propagation.h"
#include "algorithms/factors/symmetric_tiles.h"
#include "algorithms/operators/operator.h"

namespace delassus {

template <class T, Tree tree> class CabaOsimWith : public Operator<T> {
 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index) const override { return 2 * padded(this->size()); }
  [[nodiscard]] Index do_kkt_workspace() const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  void invert();
  Plan plan_;
  Factor<T> factor_;
  RowPropagation<T> rows_;
  BlockDiagonal<T> weights_;    // R
  MatrixX<T> F_, RF_;           // m × m: J M_R⁻¹Jᵀ, then Λ_R, their lower triangles; R F
  SymmetricTiles<T> inverse_;   // Λ_R
  Report undamped_, factored_;  // of phase A, and of the whole factor
};

template <class T> using CabaOsim = CabaOsimWith<T, Tree::whole>;
template <class T> using CabaOsimR = CabaOsimWith<T, Tree::contracted>;

}  // namespace delassus
