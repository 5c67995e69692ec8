#include "algorithms/factors/weight_root.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <cmath>

namespace delassus {

template <class T> void WeightRoot<T>::analyze(const Structure& s) {
  constraints_.clear();
  Index size = 0;
  const auto append = [&](const auto& c) {
    constraints_.push_back({c.row, c.rows, size});
    size += c.rows * c.rows;
  };
  for (const auto& e : s.link_constraints) append(e);
  for (const auto& j : s.joint_constraints) append(j);
  has_lower_.assign(constraints_.size(), 0);
  root_.assign(static_cast<std::size_t>(s.rows), T(0));
  lower_.assign(static_cast<std::size_t>(size), T(0));
  damping_.analyze(s);
}

template <class T> Report WeightRoot<T>::assign(const Damping<T>& damping) {
  using std::sqrt;
  damping_.assign(damping);
  for (std::size_t e = 0; e < constraints_.size(); ++e) {
    const auto [first, count, lower] = constraints_[e];
    const T* const block = damping_.dense(static_cast<Index>(e));
    has_lower_[e] = block != nullptr;
    T* const L = lower_.data() + lower;
    if (block != nullptr) {
      std::copy_n(block, count * count, L);
      for (const Index r : damping_.off())
        if (r >= first && r < first + count) L[(r - first) * (count + 1)] = T(1);
      const Index lost = ldlt_factor(L, count, count);
      if (lost >= 0) return {Status::zero_damping, first + lost};
    }
    for (Index r = 0; r < count; ++r) {
      const T d = block != nullptr ? L[r * count + r] : damping_.diagonal(first + r);
      if (std::binary_search(damping_.off().begin(), damping_.off().end(), first + r)) {
        root_[first + r] = T(0);
        continue;
      }
      if (!ScalarTraits<T>::usable_pivot(d)) return {Status::zero_damping, first + r};
      root_[first + r] = T(1) / T(sqrt(d));
    }
  }
  return {};
}

template <class T> void WeightRoot<T>::multiply(const T* x, T* y) const {
  std::copy_n(x, root_.size(), y);
  for (std::size_t e = 0; e < constraints_.size(); ++e) multiply_rows(e, y + constraints_[e].first);
}

template <class T> void WeightRoot<T>::multiply_transposed(const T* x, T* y) const {
  for (std::size_t r = 0; r < root_.size(); ++r) y[r] = x[r] * root_[r];
  for (std::size_t e = 0; e < constraints_.size(); ++e) {  // y ← L⁻ᵀ y
    const auto [first, count, lower] = constraints_[e];
    for (Index r = count; has_lower_[e] && r-- > 0;)
      for (Index s = r + 1; s < count; ++s) y[first + r] -= lower_[lower + r * count + s] * y[first + s];
  }
}

template <class T> Index WeightRoot<T>::bytes() const {
  return static_cast<Index>(constraints_.size() * (sizeof(Constraint) + 1) + (root_.size() + lower_.size()) * sizeof(T)) +
         damping_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class WeightRoot<T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
