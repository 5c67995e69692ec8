// The one recursion of the library: the factor of M, or of M_R = M + JᵀRJ, and y = J M_R⁻¹ Jᵀ x in two sweeps.
//
// What     Each step eliminates one joint i. With W_j the force on node j per joint acceleration,
//            U_i = H_ii S_i,   W_j = H_ji S_i (j ∈ N_i),   W_π += U_i,
//            D_i = A_i + 𝒦ᵢᵀ R 𝒦ᵢ + S_iᵀ U_i
//          the body is merged into its parent (H_ππ += H_ii + H_iπ + H_πi, H_πj += H_ij) and the Schur complement
//            H_jk −= W_j D_i⁻¹ W_kᵀ     over Q_i = N_i ∪ {π(i)}
//          is taken. D_i = L D Lᵀ, and S_i, W_j, 𝒦ᵢ are stored in the basis E_i = L⁻ᵀ, in which D_i is diagonal (E_iᵀD_iE_i):
//          a joint of n_i degrees of freedom is n_i scalar steps, so the sweeps know no joint types.
// Sweeps   force convention (docs/paper_notes.md): u = τ + Sᵀf; f_π += f_i; f_j −= W_j D⁻¹u; then
//            ν = D⁻¹u − Σ_j (W_j D⁻¹)ᵀ a_j;   a_i = a_π + S_i ν.
// Singular a pivot of D_i that is not positive: M (or M_R) is singular in this arithmetic; reported, never repaired.
// Cost     update ≈ 160 N₁ + 144 |pairs| + 12 m operations; project ≈ 48 n + 24 |W| + 24 m (one-dof joints N₁).
// Beside    a factor of M beside one of M_R has the same order (mass_plan): phase A is that of M_R, copied.
// Workspace  6 per active body + 1 per active degree of freedom, times the columns.
// Error    componentwise within the data's sensitivity as long as no pivot is lost (tested, not proven).
// Source   paper, Algorithms 1–4 with the corrections of docs/paper_notes.md.
#pragma once

#include "algorithms/factors/link_rows.h"
#include "algorithms/kit/slab.h"

namespace delassus {

template <class T> class Factor {
 public:
  /// The plan decides the matrix: made with Matrix::M it takes no weights. Both arguments must outlive this.
  void analyze(const Structure& structure, const Plan& plan);
  /// The factor of M beside one of M_R, which must outlive this too: `plan` is mass_plan of its plan. Rows, and numbers that
  /// elimination leaves as they are, are kept there only.
  void analyze_beside(const Factor& of_M_R, const Plan& plan);
  /// Numbers at a configuration, and phase A. Report: lost_pivot with the body's first degree of freedom.
  [[nodiscard]] Report start(const Problem<T>& problem);
  /// The same after the start of the factor of M_R beside this, whose phase A it shares.
  [[nodiscard]] Report start_beside();
  /// Takes K and 𝒦 of rows that moved at the same configuration. A factor of M is as good as before; one of M_R needs new weights.
  void move_rows(const Problem<T>& problem);
  void move_rows_beside();
  /// The rest of the factor of M_R; what start computed is kept, so that new weights cost no more than they must.
  [[nodiscard]] Report update_weights(const BlockDiagonal<T>& weights);
  /// The rest of the factor of M, once after each start.
  [[nodiscard]] Report update_undamped() { return eliminate(plan_->first_active, plan_->steps); }

  /// y = J M_R⁻¹ Jᵀ x, shapes m. `work` needs workspace() values of V. x and y may be the same.
  template <class V> void project(const V* x, V* y, V* work) const;

  /// y = J ν, ν = M_R⁻¹ (Jᵀ x + τ), of every joint. τ and ν in the problem's order of degrees of freedom; τ = nullptr: zero.
  /// `work` needs solve_workspace() values of V.
  template <class V> void solve(const V* x, const V* tau, V* y, V* nu, V* work) const;
  /// τᵀ M_R⁻¹ τ, by the backward sweep alone; `work` as for solve.
  template <class V> [[nodiscard]] V energy(const V* tau, V* work) const;

  /// z with xᵀ J M⁻¹Jᵀ x' = Σ z_c z'_c / inverse_pivots()[c], c < columns(), by the backward sweep alone.
  template <class V> void half(const V* x, V* z, V* work) const;
  /// 1/D of the columns that Jᵀx reaches, in the order of the sweeps.
  [[nodiscard]] const T* inverse_pivots() const { return d_inverse_.data() + plan_->first_column[plan_->first_active]; }
  [[nodiscard]] Index columns() const { return plan_->active_columns(); }

  /// d_r ≥ (J M⁻¹Jᵀ)_rr, equal for rows on one body or joint, at most k times it and twice the mixed terms for k links: from
  /// the mobilities Ω_i (6×6 inverse inertia of body i seen from outside, paper's [34]). For the factor of M.
  /// `omega` is scratch, one per body. Cost about 300 operations per body. Shape m.
  void row_mobility(T* d, SixBySix<T>* omega) const;
  /// d_j = (M⁻¹)_jj of every degree of freedom, in the problem's order, likewise. Shape n.
  void joint_mobility(T* d, SixBySix<T>* omega) const;

  /// Step i as the sweeps see it, in the basis in which D_i is diagonal: S_i and 1/D, a column each, and W_j D⁻¹ of the members of
  /// Q_i, `dofs` columns each.
  struct Joint {
    int dofs;
    const Six<T>*s, *w;
    const T* d_inverse;
  };
  [[nodiscard]] Joint joint(int i) const {
    const int first = plan_->first_column[i];
    return {plan_->first_column[i + 1] - first, s_.data() + first, w_.data() + plan_->first_w[i], d_inverse_.data() + first};
  }
  /// use(row, 𝒦 of the row in that basis) of the rows on the joint of active step i, in the order of the joint constraints.
  template <class Use> void for_joint_rows(int i, Use&& use) const {
    const int step = i - plan_->first_active;
    for (int j = first_joint_rows_[step]; j < first_joint_rows_[step + 1]; ++j)
      for (Index r = 0; r < joint_rows_[j].rows; ++r)
        use(static_cast<int>(joint_rows_[j].row + r), joint_k_.data() + joint_rows_[j].first + r * joint_rows_[j].dofs);
  }

  [[nodiscard]] Index workspace() const;  ///< values of V
  [[nodiscard]] Index solve_workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  template <class> friend class FactorView;  // reads intermediate numbers: property_tests/laws/digits.cpp

  enum Filled : int { never, from_the_start, with_rows, by_a_copy };  // how inertia_ of a step gets its numbers before it runs
  struct JointRows {
    int step, column, dofs;  // from the first active step and column
    Index row, rows, first, constraint;
  };

  void take_plan(const Structure& structure, const Plan& plan);
  void make_joint_rows();
  void find_sources();
  void into_basis(int step);
  void add_weights(const BlockDiagonal<T>& weights);
  void add_joint_weights(const BlockDiagonal<T>& weights);
  Report eliminate(int begin, int end);
  bool eliminate(int i);
  bool eliminate_simple(int i);
  template <class N> bool eliminate_general(int i, N n);
  template <class N> bool diagonalise(int i, N n, T (&D)[6][6]);
  template <class N> void take_basis(int i, N n, const T (&D)[6][6]);
  template <class N> void update_members(int i, N n, SixBySix<T>& H);
  [[nodiscard]] SixBySix<T> inertia(int i) const;
  /// Where start leaves H_ii.
  [[nodiscard]] SixBySix<T>& given(int i) { return kept(i) ? own_[i - plan_->first_active] : inertia_[i]; }
  /// Step i hands its part to a parent of its own phase, which takes it when it runs.
  [[nodiscard]] bool waits(int i) const {
    return plan_->simple(i) && (i < plan_->first_active) == (plan_->parent[i] < plan_->first_active);
  }
  /// Step i runs again with every damping.
  [[nodiscard]] bool kept(int i) const { return plan_->matrix == Matrix::M_R && i >= plan_->first_active; }

  template <class V> void scatter(const V* x, Six<V>* f, V* u) const;
  template <class V> void add_torques(const V* tau, V* u) const;
  void mobility(int i, SixBySix<T>* omega, Six<T> (&V)[6]) const;
  template <class V> void velocities(const V* u, V* nu) const;
  // f and u begin at the first active step and column; those of phase A stand before them.
  template <class V> void backward(Plan::Runs runs, Six<V>* f, V* u) const;
  template <class V> void forward(Plan::Runs runs, Six<V>* f, V* u) const;
  template <class V> struct Whole;  // f and u of every step
  template <class V> void gather(const Six<V>* f, const V* u, V* y) const;

  const Structure* structure_ = nullptr;
  const Plan* plan_ = nullptr;
  // Everything below is in sweep order (steps, then their columns).
  std::span<Six<T>> s_;             // S_i E_i, per column
  std::span<Six<T>> w_;             // W_j D⁻¹, per step, member, column
  std::span<Six<T>> s0_, e_;        // S_i, and the columns of E_i, of joints of several degrees of freedom
  std::span<Six<T>> unscaled_;      // scratch: W_j of one step
  std::span<T> d_inverse_;          // 1/D, per column
  std::span<T> armature_, shift_;   // per column; with 𝒦ᵢᵀ R 𝒦ᵢ where the joint has one degree of freedom
  std::span<T> joint_k0_, joint_k_; // 𝒦_i and 𝒦_i E_i
  std::span<T> joint_weight_;       // 𝒦ᵢᵀ R 𝒦ᵢ, n_i × n_i, of joints of several degrees of freedom with rows
  std::span<SixBySix<T>> own_;      // of M_R, per active step: H_ii before weights, with what phase A adds
  std::span<SixBySix<T>> inertia_;  // of filled steps H_ii without their children's parts until the step runs; then its own part
  std::span<SixBySix<T>> block_;    // couplings H_ij
  std::span<int> vector_of_;        // per step: its six columns in s0_ and e_, −1: one degree of freedom or none
  std::span<Filled> filled_;        // per step
  std::span<int> first_child_, next_child_;  // per step, those it takes inertia_ from (simple, of the same phase), −1 at the end
  std::span<int> first_joint_rows_; // per active step
  std::span<int> joint_weight_of_;  // per active step, −1: none
  std::span<JointRows> joint_rows_; // ascending by step

  const Factor* beside_ = nullptr;  // of M_R: has s0_, armature_, joint_k0_, vector_of_ and what is known of rows
  const LinkRows<T>* rows_ = nullptr;  // the K_e^i: links_, or those beside
  LinkRows<T> links_;
  Report started_;                  // by start
  Slab<Six<T>> sixes_;
  Slab<T> scalars_;
  Slab<SixBySix<T>> matrices_;
  Lists lists_, shared_;            // of this factor alone, and what one beside takes too
};

}  // namespace delassus
