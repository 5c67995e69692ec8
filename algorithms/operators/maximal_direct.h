// maximal_direct: the Delassus matrix from a sparse direct factor in maximal coordinates.
//
// What     A₀ = J M⁻¹Jᵀ from the equations of motion with every joint as a constraint, all six motions of every body unknown;
//          A = A₀ + R⁻¹ as explicit.h.
// Formula  per body i and its joint, unknowns (a_i, φ_i, ν_i):
//            H_i a_i + φ_i − Σ φ_children = g_i,   a_i − a_π − S_i ν_i = 0,   A_i ν_i − S_iᵀφ_i = τ_i
//          L D Lᵀ of that matrix, children before parents: no fill but the six numbers of the parent. Row r of J as g, τ; what its
//          solution moves the other rows by is column r of A₀.
// Pivots   (a_k, φ_k) two by two, [h 1; 1 0], which no number h makes singular, so that massless bodies need no exception; then D_i of
//          ν_i one by one. H_i itself is never inverted, as it is where ν is left out.
// Singular M: lost_pivot at the degree of freedom. A as explicit.h.
// Cost     update: (18 + n_i)² (12 + n_i) or so per body; per row 2 (18 + n_i)(12 + n_i) per body that has rows beyond it: O(n m);
//          m³/3 for the factor of A. About 30 times the numbers of the articulated-body algorithm, to which the same elimination
//          comes down where the zeros of the matrix are known.
// Workspace  for a pair (12 + n_i) per body and as much.
// Error    apply componentwise: the sums that are not zeros times zeros are those of the articulated-body algorithm. solve normwise κ(A).
// Source   D. Baraff, Linear-time dynamics using Lagrange multipliers, 1996, with ν and six multipliers where he has 6 − n_i.
#pragma once

#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T> class MaximalDirect : public Explicit<T> {
 protected:
  void analyze_form() override;
  Report factor_M(const Problem<T>& problem) override;
  void form(const Problem<T>& problem, MatrixX<T>& A0) override;
  void subtract_rates(const T* r1, T* x, T* work) const override;
  void motion(const T* r1, const T* lambda, T* nu, T* work) const override;
  [[nodiscard]] Index pair_workspace() const override { return unknowns_; }
  [[nodiscard]] Index form_bytes() const override;

 private:
  static constexpr int most = 24;  // 12 + n_i, and six of the parent
  [[nodiscard]] Index pivots(Index body) const { return 12 + this->structure()->dofs(body); }
  /// Entry (r, c) of the factor of a body, c < pivots.
  [[nodiscard]] T& L(Index body, Index r, Index c) { return factor_[first_[body] + c * most + r]; }
  [[nodiscard]] const T& L(Index body, Index r, Index c) const { return factor_[first_[body] + c * most + r]; }
  bool factor_body(Index body, const Problem<T>& problem);
  /// x ← the solution, of the bodies listed, children before parents; `at_` of each.
  void forward(Index body, T* x) const;
  void backward(Index body, T* x) const;
  void add_row(Index row, T* x) const;
  [[nodiscard]] T rate_of(Index row, const T* x) const;

  struct OfRow {
    Index body, first, count;  // K row `first` on a_i; 𝒦 of `count` numbers from `first` on where count > 0
  };
  std::vector<Index> first_row_;   // per row, and one past the end: its parts
  std::vector<OfRow> parts_;
  std::vector<Index> first_, at_;  // per body: its factor; its unknowns a_k, φ_k in turn, then ν
  std::vector<char> active_;       // per body: rows act on it or beyond it
  std::vector<T> factor_;          // L below the pivots, D on them
  std::vector<Matrix6<T>> inertia_;
  std::vector<Vector6<T>> k_;
  std::vector<T> joint_k_, x_;
  Index unknowns_ = 0;
};

}  // namespace delassus
