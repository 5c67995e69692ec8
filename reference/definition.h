// The definition, written out: dense M, J and A = J M⁻¹ Jᵀ + R⁻¹ from path sums. No recursion over the tree.
//
//   a_i = J_i ν,  J_i = Σ_{k on the path from the root to i} S_k e_kᵀ     (6 × n)
//   M   = Σ_i J_iᵀ H_i J_i + diag(armature)                              (n × n)
//   J   = rows Σ_i K_e^i J_i of every link constraint and 𝒦_i of every joint constraint   (m × n)
//   A0  = J M⁻¹ Jᵀ,  A = A0 + R⁻¹                                        (m × m)
//
// Instantiated for double, Quad and Rational (exact). Cost O(N d² + n³ + n² m + n m² + m³), d = dofs on a path.
#pragma once

#include "algorithms/kit/scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::reference {

/// P A Pᵀ = L D Lᵀ of a symmetric positive semidefinite matrix (lower triangle read), L unit lower triangular, no
/// square roots, symmetric pivoting by the largest remaining diagonal. Cost n³/3 multiply-adds.
/// A pivot is lost when it is not positive, or in rounded arithmetic when pivot / (eps · bound) < 30 with
/// bound = steps · scale of its row; the default scale is the original diagonal = diagonal of |L||D||Lᵀ|.
template <class T> class PivotedLdlt {
 public:
  explicit PivotedLdlt(MatrixX<T> A);
  PivotedLdlt(MatrixX<T> A, const VectorX<T>& scale);
  /// No pivot was lost.
  [[nodiscard]] bool regular() const { return rank_ == factor_.rows(); }
  [[nodiscard]] Index rank() const { return rank_; }
  /// The row whose pivot was lost first, or −1.
  [[nodiscard]] Index lost_row() const { return regular() ? -1 : order_[static_cast<std::size_t>(rank_)]; }
  /// X with A X = B. Shapes n×k. @throws std::runtime_error when a pivot was lost.
  [[nodiscard]] MatrixX<T> solve(const MatrixX<T>& B) const;
  /// A⁻¹, symmetric. @throws std::runtime_error when a pivot was lost.
  [[nodiscard]] MatrixX<T> inverse() const;

 private:
  void factorise(VectorX<T> scale);
  void swap(Index a, Index b, VectorX<T>& scale);
  MatrixX<T> factor_;         // strictly lower: L; diagonal: D
  std::vector<Index> order_;  // row k of P A Pᵀ is row order_[k] of A
  Index rank_ = 0;
};

/// The matrices of the definition.
template <class T> struct Dense {
  MatrixX<T> M;          ///< n × n [kg m², kg m, kg]
  MatrixX<T> J;          ///< m × n
  MatrixX<T> M_inv_Jt;   ///< n × m: M⁻¹ Jᵀ
  MatrixX<T> A0;         ///< m × m: J M⁻¹ Jᵀ
  MatrixX<T> R_inverse;  ///< m × m, block diagonal
  /// A = A0 + R⁻¹.
  [[nodiscard]] MatrixX<T> A() const { return A0 + R_inverse; }
};

/// Degrees of freedom of the joints on the path from the root to body i, ascending.
[[nodiscard]] std::vector<Index> path_dofs(const Structure& structure, Index body);

/// J_i, 6 × n: the motion of body i about its tree's reference point is J_i ν.
template <class T> [[nodiscard]] MatrixX<T> body_jacobian(const Problem<T>& problem, Index body);
/// J, m × n.
template <class T> [[nodiscard]] MatrixX<T> constraint_jacobian(const Problem<T>& problem);
/// M, n × n.
template <class T> [[nodiscard]] MatrixX<T> mass_matrix(const Problem<T>& problem);
/// R⁻¹, m × m.
template <class T> [[nodiscard]] MatrixX<T> damping_matrix(const Structure& structure, const Damping<T>& damping);

/// Everything above. @throws std::runtime_error naming the degree of freedom when M is singular.
template <class T> [[nodiscard]] Dense<T> dense(const Problem<T>& problem, const Damping<T>& damping);

/// The factorisation of A, its pivots judged on the scale of the dot products that formed A.
template <class T> [[nodiscard]] PivotedLdlt<T> factorise(const Dense<T>& d);
/// Λ_R = A⁻¹, m × m. @throws std::runtime_error naming the row when A is singular.
template <class T> [[nodiscard]] MatrixX<T> dense_damped_inverse(const Dense<T>& d);
/// a = A f, shapes m×k.
template <class T> [[nodiscard]] MatrixX<T> dense_apply(const Dense<T>& d, const MatrixX<T>& f);
/// f = A⁻¹ a, shapes m×k. @throws std::runtime_error naming the row when A is singular.
template <class T> [[nodiscard]] MatrixX<T> dense_solve(const Dense<T>& d, const MatrixX<T>& a);

/// X Y by three loops; zero entries of X are skipped.
template <class T> [[nodiscard]] MatrixX<T> product(const MatrixX<T>& X, const MatrixX<T>& Y);

}  // namespace delassus::reference
