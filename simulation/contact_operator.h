// The operators that a contact solver asks for, of a problem that has a mechanism or a given matrix.
//
//   multiply   u = (G + R⁻¹) λ                            two sweeps with the factor of M, or the matrix
//   factor     of G + R⁻¹ + diag(shift); solve with it     lcaba_refined (another R⁻¹ each time), or a dense LDLᵀ
//   matrix     G, formed on demand: for solvers that sweep over its columns
//   diagonal   of G + R⁻¹                                 DelassusBlocks, or the matrix
// How      Rows that are off (R⁻¹ = ∞) have 0 in every vector that comes back.
// Cost     mechanism: that of the operators, O(n + m) with local loops; matrix: O(m²) a product, O(m³) a factor.
// Nothing allocates after analyze, but matrix() and factor() the first time they are called.
#pragma once

#include <memory>
#include <vector>

#include "algorithms/dynamics/delassus_blocks.h"
#include "algorithms/operators/operators.h"
#include "simulation/contact_problem.h"

namespace delassus::simulation {

template <class T> class ContactOperator {
 public:
  /// Sizes and plans. @throws ModelError for a bad structure.
  void analyze(const ContactProblem<T>& p);
  /// Whether analyze has seen a problem of this structure and size.
  [[nodiscard]] bool fits(const ContactProblem<T>& p) const;
  /// Numbers. The problem must live until the last call; so must `tree`, which has taken those of its mechanism, where one is given: its
  /// factor serves here, too. Report: lost_pivot where M is singular.
  [[nodiscard]] Report update(const ContactProblem<T>& p, TreeOperators<T>* tree = nullptr);

  [[nodiscard]] Index rows() const { return m_; }
  void multiply(const T* lambda, T* u);
  /// u = (G + R⁻¹) λ + g − target, 0 in rows that are off.
  void velocity(const T* lambda, T* u);
  [[nodiscard]] const VectorX<T>& diagonal() const { return diagonal_; }
  /// Of the mechanism.
  [[nodiscard]] TreeOperators<T>& tree() { return *tree_; }
  /// G, without R⁻¹, rows and columns that are off zero. Valid until the next update.
  [[nodiscard]] const MatrixX<T>& matrix();

  /// Of G + R⁻¹ + diag(shift), shift ≥ 0 (m). Report: zero_damping where a row of a mechanism has neither R⁻¹ nor shift; lost_pivot.
  [[nodiscard]] Report factor(const T* shift);
  /// x with (G + R⁻¹ + diag(shift)) x = b.
  [[nodiscard]] Report solve(const T* b, T* x);

 private:
  void switch_off(T* x) const {
    for (const Index r : off_) x[r] = T(0);
  }
  const ContactProblem<T>* problem_ = nullptr;
  std::shared_ptr<const Structure> structure_;
  Index m_ = 0;
  std::vector<Index> off_;
  VectorX<T> diagonal_;
  TreeOperators<T>* tree_ = nullptr;
  std::unique_ptr<TreeOperators<T>> own_tree_;
  std::unique_ptr<Operator<T>> solve_;
  std::unique_ptr<Workspace<T>> solve_work_;
  std::unique_ptr<DelassusBlocks<T>> blocks_;
  Damping<T> shifted_;
  bool solve_current_ = false, matrix_current_ = false;
  MatrixX<T> matrix_, dense_, unit_;
};

}  // namespace delassus::simulation
