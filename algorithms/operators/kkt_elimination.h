// kkt_elimination, dense_refined: the multipliers kept to the end, damping zero allowed.
//
// What     f = A⁻¹ a, A = J M⁻¹Jᵀ + R⁻¹ formed by articulated-body sweeps and factored with diagonal pivoting; where rows are
//          hard (R⁻¹ = 0), factored by hard_rows.h without forming it.
// Formula  elimination of ν from  M ν − Jᵀλ = r₁,  J ν + R⁻¹λ = r₂:   A λ = r₂ − J M⁻¹ r₁,   ν = M⁻¹(r₁ + Jᵀλ);
//          then refinement.h.
// Rank     hard rows are judged by their angles, relative to the numbers they were made from (hard_rows.h); damped ones have no
//          part in it. The pivot of a row with scalar damping is at least R⁻¹_rr, whatever rounding left of it.
//            kkt_elimination   leaves dependent rows out (λ_r = 0) and names them in dependent_rows(); a that is not in the
//                              range of A is `inconsistent`: what the others leave of a row left out, a_r − J_r ν with the
//                              refined ν, exceeds 30 eps · m (|a_r| + |A_r·||λ| + √(B_r λᵀA₀λ)), B_r the size of
//                              hard_rows.h: as far as a row that was called dependent can be off, and the rounding of J_r ν,
//                              |J_rj||ν_j| ≤ b_rj √(M⁻¹)_jj ‖ν‖_M; with r₁, √(B_r r₁ᵀM⁻¹r₁) more. Judged at full accuracy, whatever was wanted; not at all by Accuracy::fastest().
//            dense_refined     reports lost_pivot.
// Bound    on r₂ᵀA⁻¹r₂ of the rows not left out, where a row is hard: L D Lᵀ = (Y + E)(Y + E)ᵀ, A = Y Yᵀ, |E_r| ≤ (k + 30) eps s_r,
//          s_r² = B_r + R⁻¹_rr, k rows. The singular values of Y + E, its rows divided by s_r, are at least 1/√τ with the trace
//          τ = Σ s_r² ((L D Lᵀ)⁻¹)_rr; those of Y at least t times that, t = 1 − √k (k + 30) eps √τ, and
//          r₂ᵀA⁻¹r₂ ≤ ‖D^(−½) L⁻¹ r₂‖² / t². None when t < ½. Rigorous up to the rounding of M's factor, for which the 30 stands.
// Cost     update: m sweeps of the factor of M and m³/3, or that of hard_rows.h and m³/3 for τ; solve: per step 2 m² + 4 sweeps + a residual.
// Workspace  refinement's + n + 2 m. Memory 4 m² and hard_rows.h's.
// Error    refined.
// Source   paper, section II; refinement.h.
#pragma once

#include "algorithms/factors/hard_rows.h"
#include "algorithms/operators/refined.h"

namespace delassus {

enum class Dependent : std::uint8_t { left_out, refused };

template <class T, Dependent policy> class KktEliminationWith : public Refined<T> {
 public:
  static constexpr int max_steps = 20;  // the last rung: it takes what it needs
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override { return dependent_; }
  /// What update was given; `to` has the structure and the sizes.
  void numbers(Problem<T>& to) const { refinement_.numbers(to); }
  /// The elimination alone: M d_nu − Jᵀd_lambda = r1, J d_nu + R⁻¹d_lambda = r2 on the rows not left out. Shapes n, m, n, m;
  /// `work` as for solve.
  void solve_kkt(const T* r1, const T* r2, T* d_nu, T* d_lambda, T* work) const;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const override;
  Report solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  Report take_rows(const Problem<T>& problem, const Damping<T>& damping);
  Index factor_by_rows();
  Index factor_by_pivots();
  void solve_multipliers(const T* right, T* lambda, T* work) const;
  [[nodiscard]] Report check_dependent(const typename Refinement<T>::Asked& asked, const T* f, const T* nu, T* work) const;
  [[nodiscard]] double trust_in_factor();
  void forward(const T* right, T* x) const;
  [[nodiscard]] std::optional<T> bound_at_rows(const T* r2, T* work) const;

  Refinement<T> refinement_;
  BlockDiagonal<T> damping_;      // R⁻¹
  HardRows<T> hard_rows_;
  using V = std::conditional_t<has_lanes<T>, Lanes<T>, T>;
  static constexpr Index width = columns_in<V>;
  MatrixX<T> A0_, factor_;        // m × m; where a row is hard A0_ has the columns of dependent rows and no others
  MatrixX<T> lower_, upper_;      // padded m × m: L and Lᵀ of A without their diagonal
  VectorX<T> inverse_pivots_, unit_, column_;  // 1/D; all zero up to their padded ends
  bool formed_ = false, any_hard_ = false;
  using Kind = typename HardRows<T>::Kind;
  std::vector<Kind> kinds_;       // per row: R⁻¹_rr = 0, ∞ or neither
  std::vector<Index> order_, dependent_;
  Index rank_ = 0;
  double trust_ = 0;              // t; 0: no bound
  std::unique_ptr<Workspace<T>> sweep_work_;  // of the sweeps that form A
  Report undamped_, factored_;
};

template <class T> using KktElimination = KktEliminationWith<T, Dependent::left_out>;
template <class T> using DenseRefined = KktEliminationWith<T, Dependent::refused>;

}  // namespace delassus
