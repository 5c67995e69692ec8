#include "algorithms/factors/mass_root.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <cmath>

namespace delassus {

template <class T> void MassRoot<T>::analyze(const Structure& s, const Plan& plan) {
  structure_ = &s;
  plan_ = &plan;
  motion_.assign(static_cast<std::size_t>(s.dofs()), Six<T>::zero());
  force_ = basis_ = motion_;
  inertia_.assign(static_cast<std::size_t>(plan.steps), SixBySix<T>::zero());
}

template <class T> Report MassRoot<T>::update(const Problem<T>& problem) {
  for (int i = 0; i < plan_->steps; ++i) {
    const int body = plan_->body[i];
    inertia_[i] = load(problem.H[body]);
    Index dof = structure_->first_dof[body];
    for (int c = plan_->first_column[i]; c < plan_->first_column[i + 1]; ++c) motion_[c] = load(problem.S[dof++]);
  }
  for (int i = 0; i < plan_->steps; ++i) {
    const Index dof = structure_->first_dof[plan_->body[i]];
    const int lost = eliminate(i, problem.armature.data() + dof);
    if (lost >= 0) return {Status::lost_pivot, dof + lost};
  }
  return {};
}

// The columns of S_i made orthonormal in the inertia seen at the joint, one after the other.
template <class T> int MassRoot<T>::eliminate(int i, const T* armature) {
  using std::sqrt;
  const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
  Six<T>*const s = motion_.data() + first, *const c = force_.data() + first, *const p = basis_.data() + first;
  for (int k = 0; k < n; ++k) {
    c[k] = multiply(inertia_[i], s[k]);
    p[k] = Six<T>::zero();
    p[k].v[k] = T(1);
    const T diagonal = armature[k] + dot(s[k], c[k]);
    T rest = diagonal, along[6];
    for (int j = 0; j < k; ++j) {
      along[j] = dot(c[j], s[k]);
      rest -= along[j] * along[j];
    }
    if (!ScalarTraits<T>::usable_pivot(rest) || !(rest > T(30 * unit_roundoff<T>) * diagonal)) return k;
    const T scaling = T(1) / T(sqrt(rest));
    for (Six<T>* const x : {s, c, p}) {
      for (int j = 0; j < k; ++j) subtract_scaled(x[k], x[j], along[j]);
      scale(x[k], scaling);
    }
  }
  if (plan_->parent[i] < 0) return -1;
  SixBySix<T>& parent = inertia_[plan_->parent[i]];
  add(parent, inertia_[i]);
  for (int k = 0; k < n; ++k) subtract_outer(parent, c[k], c[k]);
  return -1;
}

template <class T> T MassRoot<T>::energy(const T* tau, T* work) const {
  Six<T>* const f = reinterpret_cast<Six<T>*>(work);
  std::fill_n(f, plan_->steps, Six<T>::zero());
  T sum(0);
  for (int i = 0; i < plan_->steps; ++i) {
    const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
    const T* const t = tau + structure_->first_dof[plan_->body[i]];
    Six<T> rest = f[i];
    for (int k = 0; k < n; ++k) {
      T w = dot(motion_[first + k], f[i]);
      for (int j = 0; j <= k; ++j) w += T(basis_[first + k][j]) * t[j];
      subtract_scaled(rest, force_[first + k], w);
      sum += w * w;
    }
    if (plan_->parent[i] >= 0) add(f[plan_->parent[i]], rest);
  }
  return sum;
}

template <class T> Index MassRoot<T>::bytes() const {
  return static_cast<Index>(3 * motion_.size() * sizeof(Six<T>) + inertia_.size() * sizeof(SixBySix<T>));
}

#define DELASSUS_INSTANTIATE(T) template class MassRoot<T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
