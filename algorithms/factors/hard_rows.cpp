#include "algorithms/factors/hard_rows.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <cmath>

#include "algorithms/kit/vectors.h"

namespace delassus {
namespace {
template <class T> double magnitude(const T& x) { return std::abs(static_cast<double>(x)); }
}  // namespace

template <class T> void HardRows<T>::analyze(const Structure& structure) {
  structure_ = &structure;
  const Index n = structure.dofs(), m = structure.rows, bodies = structure.bodies();
  panels_ = (m + width - 1) / width;
  mobility_.assign(static_cast<std::size_t>(n), T(0));
  sizes_ = VectorX<T>::Constant(panels_ * width, T(1));
  of_rows_.assign(static_cast<std::size_t>(m), T(0));
  angular_.assign(static_cast<std::size_t>(bodies), T(0));
  linear_ = angular_;
  omega_.assign(static_cast<std::size_t>(bodies), SixBySix<T>::zero());
  weights_ = row_ = of_motion_ = VectorX<T>::Constant(padded(n), T(0));
  Y_ = rest_ = VectorX<T>::Constant(panels_ * width * n, T(0));
  shares_ = VectorX<T>::Constant(panels_ * width * m, T(0));
  left_ = measured_ = to_take_ = relative_ = VectorX<T>::Constant(panels_ * width, T(0));
  ends_ = MatrixX<T>::Constant(m, m, T(0));
  open_.assign(static_cast<std::size_t>(m), 0);
  columns_are_current_ = false;
}

template <class T> void HardRows<T>::update(const Problem<T>& problem, const Factor<T>& M) {
  columns_are_current_ = false;
  if constexpr (ScalarTraits<T>::exact) {  // nothing is lost: any size serves
    sizes_.setConstant(T(1));
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
  sizes_.head(s.rows).setConstant(T(0));
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

// Unit vectors of as many rows as there are lanes, in one sweep.
template <class T> void HardRows<T>::columns(const Factor<T>& M, T* work) {
  columns_ = M.columns();
  for (Index c = 0; c < columns_; ++c) weights_[c] = T(1) / M.inverse_pivots()[c];
  V* const units = reinterpret_cast<V*>(work);
  std::fill_n(units, structure_->rows, V{});
  for (Index first = 0; first < structure_->rows; first += width) {
    const Index count = std::min(width, structure_->rows - first);
    for (Index r = 0; r < count; ++r) set_lane(units[first + r], static_cast<int>(r), T(1));
    M.half(units, reinterpret_cast<V*>(Y_.data() + first * columns_), units + structure_->rows);
    std::fill_n(units + first, count, V{});
  }
  columns_are_current_ = true;
}

// One row, and it in the metric; ‖row‖².
template <class T> T HardRows<T>::bring(const VectorX<T>& from, Index row) {
  const T* const x = from.data() + row / width * width * columns_ + row % width;
  T* const to = row_.data();
  for (Index c = 0, n = columns_; c < n; ++c) to[c] = x[c * width];
  const V *const weights = reinterpret_cast<const V*>(weights_.data()), *const taken = reinterpret_cast<const V*>(to);
  V* const metric = reinterpret_cast<V*>(of_motion_.data());
  for (Index c = 0; c * width < columns_; ++c) metric[c] = weights[c] * taken[c];
  return dot(to, of_motion_.data(), columns_);
}

// ‖rest‖² of all rows.
template <class T> void HardRows<T>::measure() {
  for (Index p = 0; p < panels_; ++p) {
    const V* const x = reinterpret_cast<const V*>(rest_.data()) + p * columns_;
    V sum{};
    for (Index c = 0; c < columns_; ++c) sum += x[c] * x[c] * weights_[c];
    reinterpret_cast<V*>(left_.data())[p] = sum;
  }
  measured_ = left_;
}

// The hard row with the largest rest, relative to its size; −1: none is open.
template <class T> Index HardRows<T>::largest() {
  const V *const left = reinterpret_cast<const V*>(left_.data()), *const to_take = reinterpret_cast<const V*>(to_take_.data()),
    *const sizes = reinterpret_cast<const V*>(sizes_.data());
  V* const relative = reinterpret_cast<V*>(relative_.data());
  for (Index p = 0, panels = panels_; p < panels; ++p) relative[p] = left[p] * to_take[p] / sizes[p];
  const T* const all = relative_.data();
  const Index m = structure_->rows;
  const double most = largest_magnitude(all, m);
  if (!(most > 0)) return -1;
  Index r = 0;
  while (r < m && magnitude(all[r]) != most) ++r;
  return r < m ? r : -1;
}

// The hard row to take as the k-th, brought, −1: none is independent of those before.
template <class T> Index HardRows<T>::next_hard(Index k, T& pivot) {
  Index next = largest();
  if (next < 0 || !(left_[next] > T(0x1p-20) * measured_[next])) {
    measure();
    next = largest();
  }
  if (next < 0) return -1;
  pivot = bring(rest_, next);
  const double noise = 30 * unit_roundoff<T> * static_cast<double>(k + 1);
  return ScalarTraits<T>::usable_pivot(pivot) && T(pivot / sizes_[next]) > T(noise * noise) ? next : -1;
}

// l_rk = ⟨q_k, y_r⟩ / d_k, y_r −= l_rk q_k of the row brought, for every row; what is not open is read no more
template <class T> void HardRows<T>::take(Index row, Index k, const T& pivot, const BlockDiagonal<T>& damping) {
  const bool hard = open_[row] == 1;
  const T inverse = T(1) / pivot;
  open_[row] = 0;
  to_take_[row] = T(0);
  T* const of_step = shares_.data() + k * panels_ * width;
  const T *const motion = of_motion_.data(), *const q = row_.data();
  const Index n = columns_;
  if (!hard) damping.multiply(ends_.col(row).data(), of_rows_.data());
  for (Index p = 0; p < panels_; ++p) {
    V* const x = reinterpret_cast<V*>(rest_.data()) + p * n;
    V& share = reinterpret_cast<V*>(of_step)[p];
    V& left = reinterpret_cast<V*>(left_.data())[p];
    V sum{};
#pragma GCC unroll 6
    for (Index c = 0; c < n; ++c) sum += x[c] * motion[c];
    share = sum * inverse;
    for (Index r = p * width; !hard && r < std::min((p + 1) * width, ends_.cols()); ++r) {
      if (open_[r] == 0) continue;
      for (Index s = 0; s < ends_.rows(); ++s) of_step[r] += of_rows_[s] * ends_(s, r) * inverse;
      ends_.col(r) -= ends_.col(row) * of_step[r];
    }
    const V taken = share;
#pragma GCC unroll 6
    for (Index c = 0; c < n; ++c) x[c] -= taken * q[c];
    left -= taken * taken * pivot;
  }
  of_step[row] = pivot;
}

template <class T>
Index HardRows<T>::factor(const std::vector<Kind>& kinds, const BlockDiagonal<T>& damping, const Factor<T>& M, Index* order, T* work) {
  if (!columns_are_current_) columns(M, work);
  const Index m = structure_->rows;
  rest_ = Y_;
  bool any_damped = false;
  for (Index r = 0; r < m; ++r) {
    open_[r] = kinds[r] == Kind::off ? 0 : kinds[r] == Kind::hard ? 1 : 2;
    any_damped = any_damped || open_[r] == 2;
    to_take_[r] = T(open_[r] == 1 && sizes_[r] > T(0) ? 1 : 0);
  }
  measure();
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
  return any_damped ? take_damped(damping, order, k, left_out) : k;
}

template <class T> Index HardRows<T>::take_damped(const BlockDiagonal<T>& damping, Index* order, Index k, Index left_out) {
  ends_.setConstant(T(0));
  for (Index r = 0; r < structure_->rows; ++r)
    if (open_[r] == 2) ends_(r, r) = T(1);
  for (Index r = 0; r < structure_->rows; ++r) {
    if (open_[r] != 2) continue;
    const T noise = T(30 * unit_roundoff<T> * static_cast<double>(k + 1)) * (bring(Y_, r) + damping.entry(r));
    damping.multiply(ends_.col(r).data(), of_rows_.data());
    T pivot = bring(rest_, r);
    for (Index s = 0; s < structure_->rows; ++s) pivot += of_rows_[s] * ends_(s, r);
    const T least = damping.diagonal(r);  // 0 for rows of a dense block
    if (least > pivot) pivot = least;
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

template <class T> void HardRows<T>::column(Index row, T* out) {
  (void)bring(Y_, row);
  const Index n = columns_, m = structure_->rows;
  const T* const motion = of_motion_.data();
  for (Index p = 0; p < panels_; ++p) {
    const V* const x = reinterpret_cast<const V*>(Y_.data()) + p * n;
    V sum{};
#pragma GCC unroll 6
    for (Index c = 0; c < n; ++c) sum += x[c] * motion[c];
    for (Index r = p * width; r < std::min((p + 1) * width, m); ++r) out[r] = lane(sum, static_cast<int>(r % width));
  }
}

template <class T> Index HardRows<T>::bytes() const {
  const std::size_t lists = mobility_.size() + angular_.size() + linear_.size() + of_rows_.size();
  const Index vectors = 3 * weights_.size() + 2 * Y_.size() + shares_.size() + 5 * left_.size() + ends_.size();
  return static_cast<Index>(lists * sizeof(T) + omega_.size() * sizeof(SixBySix<T>) + open_.size()) + vectors * static_cast<Index>(sizeof(T));
}

#define DELASSUS_INSTANTIATE(T) template class HardRows<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
