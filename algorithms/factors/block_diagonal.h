// R⁻¹ as given, or R: diagonal, or one dense symmetric block for a constraint whose damping is given as a block. Of a row that is
// off (R⁻¹ = ∞) both hold 0: its λ is 0, and so is what it adds anywhere.
// No allocation after analyze, whatever blocks a Damping brings.
#pragma once

#include <algorithm>
#include <vector>

#include "algorithms/kit/ldlt.h"
#include "algorithms/kit/slab.h"
#include "algorithms/problem/problem.h"

namespace delassus {

template <class T> class BlockDiagonal {
 public:
  void analyze(const Structure& structure);
  /// Holds this weight times the identity.
  void assign(const T& weight);
  /// Holds R⁻¹.
  void assign(const Damping<T>& damping);
  /// Holds R. Report: zero_damping with the first row whose damping is zero or whose block is singular.
  /// With `shift` (m, ≥ 0): holds (R⁻¹ + diag shift)⁻¹.
  [[nodiscard]] Report assign_inverse(const Damping<T>& damping, const T* shift = nullptr);
  /// The entries of another one of the same structure divided by `unit`, rounded to T.
  template <class U> void round(const BlockDiagonal<U>& other, const U& unit) {
    const auto rounded = [&](const U& x) { return static_cast<T>(U(x / unit)); };
    std::transform(other.diagonal_.begin(), other.diagonal_.end(), diagonal_.begin(), rounded);
    std::transform(other.dense_.begin(), other.dense_.end(), dense_.begin(), rounded);
    off_ = other.off_;
    std::copy(other.has_dense_.begin(), other.has_dense_.end(), has_dense_.begin());
    any_dense_ = other.any_dense_;
  }

  /// The rows with R⁻¹ = ∞, ascending.
  [[nodiscard]] const std::vector<Index>& off() const { return off_; }
  /// x_r = 0 of the rows that are off, for values of V.
  template <class V> void switch_off(V* x) const {
    for (const Index r : off_) x[r] = V{};
  }
  [[nodiscard]] const T& diagonal(Index row) const { return diagonal_[row]; }
  /// Of the diagonal, blocks included.
  [[nodiscard]] const T& entry(Index row) const {
    const Index e = constraint_of_[row], r = row - rows_[e].first;
    return has_dense_[e] ? dense_[first_[e] + r * rows_[e].count + r] : diagonal_[row];
  }
  /// The block of constraint e (link constraints first, then joint constraints), rows × rows, or nullptr when diagonal.
  [[nodiscard]] const T* dense(Index e) const { return has_dense_[e] ? dense_.data() + first_[e] : nullptr; }

  /// y = this · x for m values of V (T, or lanes of T). x and y must not overlap.
  template <class V> void multiply(const V* x, V* y) const {
    for (std::size_t r = 0; r < diagonal_.size(); ++r) y[r] = x[r] * diagonal_[r];
    if (!any_dense_) return;
    for (std::size_t e = 0; e < rows_.size(); ++e)
      if (has_dense_[e])
        for (Index r = 0; r < rows_[e].count; ++r) {
          V sum = x[rows_[e].first] * dense_[first_[e] + r];
          for (Index s = 1; s < rows_[e].count; ++s) sum += x[rows_[e].first + s] * dense_[first_[e] + s * rows_[e].count + r];
          y[rows_[e].first + r] = sum;
        }
  }
  [[nodiscard]] Index bytes() const { return lists_.bytes() + scalars_.bytes() + static_cast<Index>(constraint_of_.size() * sizeof(Index)); }

 private:
  template <class U> friend class BlockDiagonal;
  void add_to_diagonal(const T* shift);
  void set_off(T* dense, Index row, Index count, const T& diagonal) const;
  struct Rows {
    Index first, count;
  };
  std::span<Rows> rows_;            // per constraint
  std::span<Index> first_;          // per constraint: its block in dense_
  std::span<Index> constraint_of_;  // per row
  std::span<char> has_dense_;       // per constraint
  std::vector<Index> off_;
  std::span<T> diagonal_, dense_, scratch_;
  Lists lists_;
  Slab<T> scalars_;
  bool any_dense_ = false;
};

}  // namespace delassus
