// The square-root (QR) factor of M_R = M + JᵀRJ: weighted rows of J appended to the root of M.
//
// What     ν minimises  ‖ν‖²_M + Σ_e |W_e (Σ_i K_e^i a_i − a_e)|²,   a_i = a_π + S_i ν_i,  W_eᵀ W_e = R_e.
//          With ‖ν‖²_M = Σ_i |μ_i + C_iᵀ a_π|² (mass_root.h) that is M's triangular root and m rows appended to it. M_R
//          is never formed, and the forces are read from the propagated residual of the fit, not from the difference
//          a − J ν.
// How      Multifrontal (front_plan.h). In front i, a_i = a_π + (S_i P_i) μ_i is substituted in the rows appended, and the
//          columns of μ_i are reduced by Householder reflections (householder.h), each of one row of M and all appended
//          rows: one row T_i μ_i + Σ_b C_b a_b stays, one goes on in its place. So as many rows go on to b's front as came,
//          or six after a reduction on the columns of b, and so on; what is left at last touches nothing and is pure
//          residual. The reflections are kept: Q is their product.
// Solve    M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂ (a general right-hand side, as refinement needs it). With T all rows
//          that stay and ρ₁ = Pᵀ r₁:  w = T⁻ᵀ ρ₁,  (c₁, c₂) = Qᵀ (0, W r₂),  T μ = w + c₁,  (·, ρ) = Q (−w, c₂),
//          δλ = Wᵀ ρ,  δν = P μ.
// Singular where M is (mass_root.h), or when numbers overflow: lost_pivot with the degree of freedom. R⁻¹ must be positive
//          (zero_damping names the row).
// Cost     4 · 6 |Q_i| operations per row and reflection of a front; n_i reflections and six per reduced member.
// Workspace  6 per body + 1 per row of a front + 2 n + 2 m.
// Error    row-wise backward stable: relative to each row's own weight.
// Source   Å. Björck, Numerical Methods for Least Squares Problems, 1996, sections 3.1, 4.4 and 6.6–6.7.
#pragma once

#include "algorithms/factors/front_plan.h"
#include "algorithms/factors/mass_root.h"
#include "algorithms/factors/weight_root.h"
#include "algorithms/kit/householder.h"

namespace delassus {

template <class T> class SquareRootFactor {
 public:
  /// Allocates everything. The structure must outlive this.
  void analyze(const Structure& structure);
  /// Numbers at a configuration; then those at a new damping, the root of M kept.
  [[nodiscard]] Report update(const Problem<T>& problem, const Damping<T>& damping);
  [[nodiscard]] Report update_weights(const Damping<T>& damping);

  /// M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂; r1 may be nullptr (zero). n and m numbers, in the problem's order; dlambda and
  /// r2 may be the same, and dnu and r1.
  void solve_kkt(const T* r1, const T* r2, T* dnu, T* dlambda, T* work) const;

  /// The root of M alone.
  [[nodiscard]] const MassRoot<T>& mass() const { return mass_; }

  [[nodiscard]] Index workspace() const;
  [[nodiscard]] Index bytes() const;

 private:
  using Front = FrontPlan::Front;
  void keep_root(int i);
  void weigh();
  [[nodiscard]] int eliminate(int i);  // −1, or the lost degree of freedom of the joint
  [[nodiscard]] Panel<T> assemble(int i);
  template <class Put> void for_pieces(const Front& f, Put&& put) const;
  void fill_columns(int i, const Panel<T>& panel, const Six<T>* own);
  Reflection<T> keep(Index at, const Reflection<T>& r);
  void hand_on(const Front& f, const Panel<T>& panel);
  void reduce_member(const Front& f, const Panel<T>& panel, int b, int t);

  void push_force(int i, const T* r1, Six<T>* force, T* w) const;
  void fit(int i, const T* right, T* x, T* c1) const;
  void move(int i, const T* y, Six<T>* acceleration, T* dnu) const;
  void unfit(int i, const T* w, T* x, T* residual) const;

  const Structure* structure_ = nullptr;
  Plan plan_;
  FrontPlan fronts_;
  Report undamped_;  // of M
  MassRoot<T> mass_;
  WeightRoot<T> root_;
  std::vector<Six<T>> k_, joint_k_;                // rows of K (the problem's order); rows of 𝒦 P, n_i lanes each
  std::vector<Six<T>> weighted_k_, weighted_joint_k_;  // W K, W 𝒦 P
  // The factor.
  std::vector<Six<T>> t_, c_;            // row k of T_i, per column; C_b per step, member, row
  std::vector<T> t_inverse_;             // 1 / diagonal of T_i
  std::vector<int> lane_;                // which degree of freedom of the joint is column k of T_i
  std::vector<T> v_, beta_;              // the reflections
  std::vector<int> pivot_;               // of a reflection: the row that it completes
  std::vector<Six<T>> handed_rows_;
  std::vector<Six<T>> front_;            // scratch: the front being eliminated
};

}  // namespace delassus
