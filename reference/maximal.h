// Maximal coordinates, dense: every joint is a constraint, one LU factorisation, no recursion, no M, no J.
// The system is in kkt.h. Unknowns: 12 N + n (apply), 12 N + n + m (solve). Cost (that)³ / 3 at most; zero multipliers
// are skipped.
//
// Rounded arithmetic: rows and columns are scaled by powers of two to largest entries in [1, 2), partial pivoting, then
// iterative refinement in the same arithmetic, which makes the result backward stable entry by entry (Skeel 1980).
// Rational: exact, the first non-zero entry is the pivot.
// M may be regular with massless bodies; H itself is never inverted.
//
// Instantiated for double, Quad and Rational.
#pragma once

#include "reference/kkt.h"

namespace delassus::reference {

/// a = A f, shapes m×k. @throws std::runtime_error naming the unknown when the system is singular (M is).
template <class T>
[[nodiscard]] MatrixX<T> maximal_apply(const Problem<T>& problem, const Damping<T>& damping, const MatrixX<T>& f);
/// f = A⁻¹ a, shapes m×k. @throws std::runtime_error naming the unknown when the system is singular (M or A is).
template <class T>
[[nodiscard]] MatrixX<T> maximal_solve(const Problem<T>& problem, const Damping<T>& damping, const MatrixX<T>& a);

/// LU with row exchanges of a square matrix, and refined solves.
template <class T> class PivotedLu {
 public:
  /// Pivot lost: zero, or in rounded arithmetic |pivot| / (eps · bound) < 30 with bound = size · largest entry of the
  /// scaled matrix. @throws std::runtime_error naming the column.
  explicit PivotedLu(MatrixX<T> A);
  /// X with A X = B, shapes n×k.
  [[nodiscard]] MatrixX<T> solve(const MatrixX<T>& B) const;

 private:
  void scale();
  void factorise();
  [[nodiscard]] VectorX<T> solve_once(const VectorX<T>& b) const;
  using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  MatrixX<T> A_;
  RowMajor factor_;
  std::vector<Index> order_;
  VectorX<T> row_scale_, column_scale_;
};

}  // namespace delassus::reference
