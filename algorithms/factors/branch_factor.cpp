#include "algorithms/factors/branch_factor.h"

#include <algorithm>
#include <iterator>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/scalars.h"

namespace delassus {

template <class T> void BranchFactor<T>::analyze(const Structure& structure) {
  structure_ = &structure;
  const auto n = static_cast<std::size_t>(structure.dofs());
  above_.assign(n, -1);
  depth_.assign(n, 0);
  first_.assign(n, 0);
  inverse_.assign(n, T(0));
  last_dof_.assign(static_cast<std::size_t>(structure.bodies()), -1);
  composite_.assign(last_dof_.size(), Matrix6<T>::Zero());
  Index size = 0;
  for (Index i = 0; i < structure.bodies(); ++i) {
    last_dof_[i] = structure.parent[i] == ground ? -1 : last_dof_[structure.parent[i]];
    for (Index k = structure.first_dof[i]; k < structure.first_dof[i + 1]; ++k) {
      above_[k] = last_dof_[i];
      depth_[k] = above_[k] < 0 ? 0 : depth_[above_[k]] + 1;
      first_[k] = size;
      size += depth_[k] + 1;
      last_dof_[i] = k;
    }
  }
  rows_.assign(static_cast<std::size_t>(size), T(0));
}

template <class T> void BranchFactor<T>::assemble(const Problem<T>& problem) {
  const Structure& s = *structure_;
  composite_ = problem.H;
  for (Index j = s.bodies(); j-- > 0;) {
    if (s.parent[j] != ground) composite_[s.parent[j]] += composite_[j];
    for (Index l = s.first_dof[j]; l < s.first_dof[j + 1]; ++l) {
      const Vector6<T> force = composite_[j] * problem.S[l];
      T* const entries = row(l);
      for (Index k = l; k >= 0; k = above_[k]) entries[depth_[k]] = problem.S[k].dot(force);
      entries[depth_[l]] += problem.armature[l];
    }
  }
}

template <class T> Report BranchFactor<T>::update(const Problem<T>& problem) {
  assemble(problem);
  for (Index k = dofs(); k-- > 0;) {
    T* const m = row(k);
    const T& pivot = m[depth_[k]];
    if (!ScalarTraits<T>::usable_pivot(pivot)) {
      const auto& first = structure_->first_dof;
      return {Status::lost_pivot, *std::prev(std::upper_bound(first.begin(), first.end(), k))};
    }
    inverse_[k] = T(1) / pivot;
    for (Index i = above_[k]; i >= 0; i = above_[i]) {  // what stands left of i is still M
      const Index t = depth_[i];
      const T l = m[t] * inverse_[k];
      T* const of_i = row(i);
      for (Index j = 0; j <= t; ++j) of_i[j] -= m[j] * l;
      m[t] = l;
    }
  }
  return {};
}

template <class T> void BranchFactor<T>::solve_transposed(T* z) const {
  for (Index k = dofs(); k-- > 0;)
    for (Index i = above_[k], t = depth_[k]; i >= 0; i = above_[i]) z[i] -= row(k)[--t] * z[k];
}

template <class T> void BranchFactor<T>::solve_scaled(T* z) const {
  for (Index k = 0; k < dofs(); ++k) {
    z[k] *= inverse_[k];
    for (Index i = above_[k], t = depth_[k]; i >= 0; i = above_[i]) z[k] -= row(k)[--t] * z[i];
  }
}

template <class T> Index BranchFactor<T>::bytes() const {
  return static_cast<Index>(sizeof(T) * (rows_.size() + inverse_.size()) + sizeof(Matrix6<T>) * composite_.size() +
                            sizeof(Index) * (above_.size() + depth_.size() + first_.size() + last_dof_.size()));
}

#define DELASSUS_INSTANTIATE(T) template class BranchFactor<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
