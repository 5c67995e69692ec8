#include "algorithms/factors/block_diagonal.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>

namespace delassus {

template <class T> void BlockDiagonal<T>::analyze(const Structure& s) {
  const std::size_t links = s.link_constraints.size(), rows = static_cast<std::size_t>(s.rows);
  const std::size_t constraints = links + s.joint_constraints.size();
  lists_.divide(Lists::Part{rows_, constraints}, Lists::Part{first_, constraints}, Lists::Part{constraint_of_, rows}, Lists::Part{has_dense_, constraints});
  for (std::size_t e = 0; e < links; ++e) rows_[e] = {s.link_constraints[e].row, s.link_constraints[e].rows};
  for (std::size_t e = links; e < constraints; ++e) rows_[e] = {s.joint_constraints[e - links].row, s.joint_constraints[e - links].rows};
  Index size = 0, largest = 0;
  for (std::size_t e = 0; e < constraints; ++e) {
    const Index m = rows_[e].count;
    std::fill_n(constraint_of_.begin() + rows_[e].first, m, static_cast<Index>(e));
    first_[e] = size;
    size += m * m;
    largest = std::max(largest, m * m);
  }
  scalars_.divide(T(0), {{&diagonal_, rows}, {&dense_, static_cast<std::size_t>(size)}, {&scratch_, static_cast<std::size_t>(largest)}});
  off_.clear();
  off_.reserve(rows);
  any_dense_ = false;
}

// Of a block of `count` rows from `row` on: rows and columns that are off are zero but for their diagonal.
template <class T> void BlockDiagonal<T>::set_off(T* dense, Index row, Index count, const T& diagonal) const {
  for (const Index r : off_) {
    const Index k = r - row;
    if (k < 0 || k >= count) continue;
    for (Index s = 0; s < count; ++s) dense[k * count + s] = dense[s * count + k] = T(0);
    dense[k * count + k] = diagonal;
  }
}

template <class T> void BlockDiagonal<T>::assign(const T& weight) {
  std::fill(has_dense_.begin(), has_dense_.end(), 0);
  std::fill(diagonal_.begin(), diagonal_.end(), weight);
  off_.clear();
  any_dense_ = false;
}

template <class T> void BlockDiagonal<T>::assign(const Damping<T>& damping) {
  std::fill(has_dense_.begin(), has_dense_.end(), 0);
  std::copy(damping.diagonal.begin(), damping.diagonal.end(), diagonal_.begin());
  off_.clear();
  for (std::size_t r = 0; r < diagonal_.size(); ++r)
    if (ScalarTraits<T>::is_infinite(diagonal_[r])) {
      off_.push_back(static_cast<Index>(r));
      diagonal_[r] = T(0);
    }
  any_dense_ = !damping.blocks.empty();
  for (const auto& b : damping.blocks) {
    const Index m = b.R_inverse.rows();
    const Index e = constraint_of_[b.row];
    const auto [row, count] = rows_[e];
    T* const dense = dense_.data() + first_[e];
    if (!has_dense_[e]) {  // start from the constraint's diagonal
      std::fill_n(dense, count * count, T(0));
      for (Index r = 0; r < count; ++r) dense[r * count + r] = diagonal_[row + r];
      has_dense_[e] = 1;
    }
    for (Index c = 0; c < m; ++c)
      for (Index r = 0; r < m; ++r) dense[(b.row - row + c) * count + b.row - row + r] = b.R_inverse(r, c);
    if (!off_.empty()) set_off(dense, row, count, T(0));
  }
}

template <class T> void BlockDiagonal<T>::add_to_diagonal(const T* shift) {
  for (std::size_t e = 0; e < rows_.size(); ++e)
    for (Index r = 0; r < rows_[e].count; ++r) {
      const Index row = rows_[e].first + r;
      if (has_dense_[e]) dense_[first_[e] + r * rows_[e].count + r] += shift[row];
      else diagonal_[row] += shift[row];
    }
}

template <class T> Report BlockDiagonal<T>::assign_inverse(const Damping<T>& damping, const T* shift) {
  assign(damping);
  if (shift != nullptr) add_to_diagonal(shift);
  if (!any_dense_) {
    int usable = 1;
    for (T& d : diagonal_) usable &= ScalarTraits<T>::usable_pivot(d);
    for (T& d : diagonal_) d = usable ? T(1) / d : d;
    if (usable) switch_off(diagonal_.data());  // where a shift made them positive
    if (usable) return {};
  }
  for (std::size_t e = 0; e < rows_.size(); ++e) {
    const auto [row, m] = rows_[e];
    if (has_dense_[e]) {  // R_e = (R_e⁻¹)⁻¹ by LDLᵀ
      T* const dense = dense_.data() + first_[e];
      set_off(dense, row, m, T(1));
      std::copy_n(dense, m * m, scratch_.begin());
      const Index lost = ldlt_factor(scratch_.data(), m, m);
      if (lost >= 0) return {Status::zero_damping, row + lost};
      ldlt_inverse(scratch_.data(), m, m, dense);
      set_off(dense, row, m, T(0));
      continue;
    }
    for (Index r = row; r < row + m; ++r) {
      if (!ScalarTraits<T>::usable_pivot(diagonal_[r])) {
        if (std::binary_search(off_.begin(), off_.end(), r)) continue;
        return {Status::zero_damping, r};
      }
      diagonal_[r] = T(1) / diagonal_[r];
    }
  }
  switch_off(diagonal_.data());
  return {};
}

#define DELASSUS_INSTANTIATE(T) template class BlockDiagonal<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
template class BlockDiagonal<Stochastic>;
#endif

}  // namespace delassus
