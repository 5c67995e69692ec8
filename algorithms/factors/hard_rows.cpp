#include "algorithms/factors/hard_rows.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void HardRows<T>::analyze(const Structure& structure) {
  structure_ = &structure;
  const Index n = structure.dofs(), m = structure.rows, bodies = structure.bodies();
  mobility_.assign(static_cast<std::size_t>(n), T(0));
  weights_ = mobility_;
  sizes_.assign(static_cast<std::size_t>(m), T(0));
  unit_ = sizes_;
  angular_.assign(static_cast<std::size_t>(bodies), T(0));
  linear_ = angular_;
  omega_.assign(static_cast<std::size_t>(bodies), SixBySix<T>::zero());
  Y_.setZero(n, m);
  rest_.setZero(n, m);
  ends_.setZero(m, m);
  shares_.setZero(m, m);
  of_motion_ = mobility_;
  of_rows_ = sizes_;
  open_.assign(static_cast<std::size_t>(m), 0);
  columns_are_current_ = false;
}

template <class T> void HardRows<T>::update(const Problem<T>& problem, const Factor<T>& M) {
  columns_are_current_ = false;
  if constexpr (ScalarTraits<T>::exact) {  // nothing is lost: any size serves
    std::fill(sizes_.begin(), sizes_.end(), T(1));
    return;
  }
  const Structure& s = *structure_;
  M.joint_mobility(mobility_.data(), omega_.data());
  for (Index i = 0; i < s.bodies(); ++i) {
    angular_[i] = s.parent[i] == ground ? T(0) : angular_[s.parent[i]];
    linear_[i] = s.parent[i] == ground ? T(0) : linear_[s.parent[i]];
    for (Index c = s.first_dof[i]; c < s.first_dof[i + 1]; ++c) {
      angular_[i] += problem.S[c].template head<3>().squaredNorm() * mobility_[c];
      linear_[i] += problem.S[c].template tail<3>().squaredNorm() * mobility_[c];
    }
  }
  std::fill(sizes_.begin(), sizes_.end(), T(0));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) {
        const Vector6<T>& k = problem.K[link.first + r];
        sizes_[e.row + r] += k.template head<3>().squaredNorm() * angular_[link.body] +
                             k.template tail<3>().squaredNorm() * linear_[link.body];
      }
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r)
      for (Index c = 0; c < s.dofs(j.body); ++c) {
        const T& k = problem.joint_K[j.first + r * s.dofs(j.body) + c];
        sizes_[j.row + r] += k * k * mobility_[s.first_dof[j.body] + c];
      }
}

template <class T> void HardRows<T>::columns(const Factor<T>& M, T* work) {
  for (Index c = 0; c < M.columns(); ++c) weights_[c] = T(1) / M.inverse_pivots()[c];
  for (Index r = 0; r < Y_.cols(); ++r) {
    unit_[r] = T(1);
    M.half(unit_.data(), Y_.col(r).data(), work);
    unit_[r] = T(0);
  }
  columns_are_current_ = true;
}

// Of the motion's part of what is left of a row.
template <class T> T HardRows<T>::squared(Index row) const {
  T sum(0);
  for (Index c = 0; c < rest_.rows(); ++c) sum += rest_(c, row) * weights_[c] * rest_(c, row);
  return sum;
}

// The hard row to take as the k-th, −1: none is independent of those before.
template <class T> Index HardRows<T>::next_hard(Index k, T& pivot) const {
  Index next = -1;
  T largest(0);
  for (Index r = 0; r < rest_.cols(); ++r) {
    if (open_[r] != 1 || !(sizes_[r] > T(0))) continue;
    const T left = squared(r), relative = left / sizes_[r];
    if (!(relative > largest)) continue;
    next = r;
    pivot = left;
    largest = relative;
  }
  const double noise = 30 * unit_roundoff<T> * static_cast<double>(k + 1);
  return next >= 0 && ScalarTraits<T>::usable_pivot(pivot) && largest > T(noise * noise) ? next : -1;
}

// l_rk = ⟨q_k, y_r⟩ / d_k, y_r −= l_rk q_k for every row not taken
template <class T> void HardRows<T>::take(Index row, Index k, const T& pivot, const BlockDiagonal<T>& damping) {
  const Index n = rest_.rows(), m = rest_.cols();
  const bool hard = open_[row] == 1;
  open_[row] = 0;
  shares_(row, k) = pivot;
  const auto q = rest_.col(row), e = ends_.col(row);
  for (Index c = 0; c < n; ++c) of_motion_[c] = weights_[c] * q[c];
  if (!hard) damping.multiply(e.data(), of_rows_.data());
  for (Index r = 0; r < m; ++r) {
    if (open_[r] == 0) continue;
    T sum(0);
    for (Index c = 0; c < n; ++c) sum += of_motion_[c] * rest_(c, r);
    for (Index s = 0; s < m && !hard; ++s) sum += of_rows_[s] * ends_(s, r);
    const T share = shares_(r, k) = sum / pivot;
    rest_.col(r) -= q * share;
    if (!hard) ends_.col(r) -= e * share;
  }
}

template <class T>
Index HardRows<T>::factor(const std::vector<Kind>& kinds, const BlockDiagonal<T>& damping, const Factor<T>& M, Index* order, T* work) {
  if (!columns_are_current_) columns(M, work);
  const Index m = Y_.cols();
  rest_ = Y_;
  ends_.setZero();
  for (Index r = 0; r < m; ++r) {
    open_[r] = kinds[r] == Kind::off ? 0 : kinds[r] == Kind::hard ? 1 : 2;
    if (open_[r] == 2) ends_(r, r) = T(1);
  }
  Index k = 0;
  T pivot(0);
  for (Index row = next_hard(k, pivot); row >= 0; row = next_hard(k, pivot)) {
    order[k] = row;
    take(row, k++, pivot, damping);
  }
  Index left_out = m;
  for (Index r = m; r-- > 0;)
    if (open_[r] == 1 || kinds[r] == Kind::off) {
      order[--left_out] = r;
      open_[r] = 0;
    }
  for (Index r = 0; r < m; ++r) {
    if (open_[r] != 2) continue;
    damping.multiply(ends_.col(r).data(), of_rows_.data());
    pivot = squared(r);
    for (Index s = 0; s < m; ++s) pivot += of_rows_[s] * ends_(s, r);
    const T least = damping.diagonal(r);  // 0 for rows of a dense block
    if (least > pivot) pivot = least;
    T whole(0);
    for (Index c = 0; c < Y_.rows(); ++c) whole += Y_(c, r) * weights_[c] * Y_(c, r);
    unit_[r] = T(1);
    damping.multiply(unit_.data(), of_rows_.data());
    unit_[r] = T(0);
    const T noise = T(30 * unit_roundoff<T> * static_cast<double>(k + 1)) * (whole + of_rows_[r]);
    if (!(least > T(0)) && !(ScalarTraits<T>::usable_pivot(pivot) && pivot > noise)) {
      order[--left_out] = r;
      open_[r] = 0;
      continue;
    }
    order[k] = r;
    take(r, k++, pivot, damping);
  }
  return k;
}

template <class T> Index HardRows<T>::bytes() const {
  const std::size_t scalars = mobility_.size() + sizes_.size() + weights_.size() + unit_.size() + angular_.size() + linear_.size() + of_motion_.size() + of_rows_.size() +
                              static_cast<std::size_t>(Y_.size() + rest_.size() + ends_.size() + shares_.size());
  return static_cast<Index>(scalars * sizeof(T) + omega_.size() * sizeof(SixBySix<T>) + open_.size());
}

#define DELASSUS_INSTANTIATE(T) template class HardRows<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
