// The square-root (QR) factor of M_R = M + JᵀRJ: the elimination of Factor on square roots of the weights.
//
// What     ν minimises  Σ_i |L_iᵀ a_i|² + |A^½ ν|² + Σ_e |W_e (Σ_i K_e^i a_i − a_e)|²,   a_i = a_π + S_i ν_i,
//          with H_i = L_i L_iᵀ and W_eᵀ W_e = R_e. M_R is never formed, and the forces are read from the propagated
//          residual of the fit, not from the difference a − J ν.
// How      Multifrontal (front_plan.h). In front i, a_i = a_π + S_i ν_i is substituted and the columns of ν_i are reduced
//          by Householder reflections (householder.h): n_i rows T_i ν_i + Σ_b C_b a_b stay. The others are reduced on the
//          columns of the next member b, six rows going to b's front, and so on; what is left at last touches nothing
//          and is pure residual. The reflections are kept: Q is their product.
// Solve    M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂ (a general right-hand side, as refinement needs it). With T all rows
//          that stay:  w = T⁻ᵀ r₁,  (c₁, c₂) = Qᵀ (0, W r₂),  T δν = w + c₁,  (·, ρ) = Q (−w, c₂),  δλ = Wᵀ ρ.
// Singular a column of ν_i whose norm is at most 30 ε times its magnitude before products cancelled,
//          Σ_c ‖column c of a_i‖ |S_c|: lost_pivot with the degree of freedom. R⁻¹ must be positive (zero_damping names
//          the row). H_i may be singular: it is factored with pivots until they are at most 30 ε · steps · h_cc.
// Cost     4 · 6 (|Q_i| + 1) operations per row and reflection of a front; n_i + 6 |Q_i| reflections at most.
// Workspace  6 per body + 1 per row of a front + n + 2 m.
// Error    row-wise backward stable: relative to each row's own weight.
// Source   Å. Björck, Numerical Methods for Least Squares Problems, 1996, sections 4.4 and 6.6–6.7.
#pragma once

#include "algorithms/front_plan.h"
#include "algorithms/householder.h"
#include "algorithms/weight_root.h"

namespace delassus {

template <class T> class SquareRootFactor {
 public:
  /// Allocates everything. The structure must outlive this.
  void analyze(const Structure& structure);
  /// Numbers at a configuration; then those at a new damping, fronts of subtrees without rows kept.
  [[nodiscard]] Report update(const Problem<T>& problem, const Damping<T>& damping);
  [[nodiscard]] Report update_weights(const Damping<T>& damping);

  /// M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂; r1 may be nullptr (zero). n and m numbers, in the problem's order; dlambda and
  /// r2 may be the same, and dnu and r1.
  void solve_kkt(const T* r1, const T* r2, T* dnu, T* dlambda, T* work) const;

  [[nodiscard]] Index workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  using Front = FrontPlan::Front;
  [[nodiscard]] Report eliminate(int begin, int end);
  [[nodiscard]] int eliminate(int i);  // −1, or the lost column of the joint
  int assemble(int i, T* least_squared);
  void assemble_constraint(const Front& f, const FrontPlan::Constraint& c, int row);
  void assemble_handed(const Front& f, int member, int row);
  void substitute(int i, int begin, int end, T* magnitude);
  int hand_on(const Front& f, const Strip<T>& front);
  void take(const Strip<T>& front, int b, int row);  // row `row` out of the blocks from b on
  [[nodiscard]] Reflections<T> reflections(const Front& f) {
    return {v_.data() + f.v, f.stride, beta_.data() + f.row, pivot_.data() + f.row};
  }
  [[nodiscard]] Reflections<const T> reflections(const Front& f) const {
    return {v_.data() + f.v, f.stride, beta_.data() + f.row, pivot_.data() + f.row};
  }
  void fit(int i, const T* right, T* x) const;
  void push_force(int i, const T* r1, Six<T>* force, T* w) const;
  void move(int i, const T* y, Six<T>* acceleration, T* dnu) const;
  void unfit(int i, T* x, T* residual) const;

  const Structure* structure_ = nullptr;
  Plan plan_;
  FrontPlan fronts_;
  Report undamped_;  // of the subtrees without rows
  // Numbers of the problem, in sweep order.
  std::vector<Six<T>> s_, k_, joint_k_;  // columns of S; rows of K (the problem's order); rows of 𝒦, n_i lanes each
  std::vector<Six<T>> inertia_;          // six rows L_iᵀ per step
  std::vector<int> inertia_rows_;        // rank of H_i
  std::vector<T> armature_;              // A^½
  WeightRoot<T> root_;
  // The factor.
  std::vector<Six<T>> t_, c_;            // row k of T_i, per column; C_b per step, member, row
  std::vector<T> t_inverse_;             // 1 / diagonal of T_i
  std::vector<int> lane_;                // which degree of freedom of the joint is column k of T_i
  std::vector<int> rows_, reflections_;  // per step
  std::vector<T> v_, beta_;
  std::vector<int> pivot_;               // per front: its rows in the order in which they stay or are handed on
  std::vector<Six<T>> handed_rows_;
  std::vector<int> handed_count_;        // per member of the plan
  std::vector<Six<T>> front_;            // scratch: the front being eliminated
  std::vector<char> taken_;              // scratch: which of its rows are done
};

}  // namespace delassus
