#include "algorithms/kkt_residual.h"

#include <algorithm>
#include <cstdint>

namespace delassus {

template <class T> void KktResidual<T>::analyze(std::shared_ptr<const Structure> structure) {
  structure_ = std::move(structure);
  const Structure& s = *structure_;
  s_.assign(static_cast<std::size_t>(s.dofs()), Six<T>::zero());
  k_.assign(static_cast<std::size_t>(s.K_rows), Six<T>::zero());
  h_.assign(static_cast<std::size_t>(s.bodies()), SixBySix<T>::zero());
  armature_.assign(s_.size(), T(0));
  joint_k_.assign(static_cast<std::size_t>(s.joint_K_size), T(0));
  damping_.analyze(s);
}

template <class T> void KktResidual<T>::update(const Problem<T>& problem) {
  std::transform(problem.S.begin(), problem.S.end(), s_.begin(), [](const Vector6<T>& x) { return load(x); });
  std::transform(problem.K.begin(), problem.K.end(), k_.begin(), [](const Vector6<T>& x) { return load(x); });
  std::transform(problem.H.begin(), problem.H.end(), h_.begin(), [](const Matrix6<T>& x) { return load(x); });
  std::copy(problem.armature.begin(), problem.armature.end(), armature_.begin());
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k_.begin());
}

template <class T>
void KktResidual<T>::evaluate(const W* nu, const W* lambda, const T* a, T* r1, T* r2, T* work) const {
  const Structure& s = *structure_;
  const Index bodies = s.bodies();
  const auto past = reinterpret_cast<std::uintptr_t>(work) % alignof(Six<W>);  // Wide<float> asks for more than float
  Six<W>* const acceleration = reinterpret_cast<Six<W>*>(past == 0 ? work : work + (alignof(Six<W>) - past) / sizeof(T));
  Six<W>* const force = acceleration + bodies;
  W* const damped = reinterpret_cast<W*>(force + bodies);
  W* const torque = damped + s.rows;

  for (Index i = 0; i < bodies; ++i) {  // a_i = a_π + S_i ν_i;  F_i = −H_i a_i
    Six<W> ai = s.parent[i] == ground ? Six<W>::zero() : acceleration[s.parent[i]];
    for (Index c = s.first_dof[i]; c < s.first_dof[i + 1]; ++c) add_scaled(ai, s_[c], nu[c]);
    Six<W> Fi = Six<W>::zero();
    for (int c = 0; c < 6; ++c) subtract_scaled(Fi, h_[i].column[c], W(ai[c]));
    acceleration[i] = ai;
    force[i] = Fi;
  }

  damping_.multiply(lambda, damped);
  for (const auto& e : s.link_constraints)
    for (Index r = 0; r < e.rows; ++r) {
      W residual = W(a[e.row + r]) - damped[e.row + r];  // r₂ = a − R⁻¹λ − Σ K_e^i a_i
      for (const auto& link : e.links) {
        residual -= dot(k_[link.first + r], acceleration[link.body]);
        add_scaled(force[link.body], k_[link.first + r], lambda[e.row + r]);  // F_i += K_eᵀλ_e
      }
      r2[e.row + r] = narrow<T>(residual);
    }

  for (Index c = 0; c < s.dofs(); ++c) torque[c] = nu[c] * T(-armature_[c]);  // −A_i ν_i
  for (const auto& j : s.joint_constraints) {
    const Index first = s.first_dof[j.body], n = s.dofs(j.body);
    for (Index r = 0; r < j.rows; ++r) {
      W residual = W(a[j.row + r]) - damped[j.row + r];
      for (Index c = 0; c < n; ++c) {
        const T& k = joint_k_[j.first + r * n + c];
        residual -= nu[first + c] * k;               // r₂ = a − R⁻¹λ − 𝒦ᵢ ν_i
        torque[first + c] += lambda[j.row + r] * k;  // + 𝒦ᵢᵀ λ
      }
      r2[j.row + r] = narrow<T>(residual);
    }
  }

  for (Index i = bodies; i-- > 0;) {  // r₁ = S_iᵀF_i + 𝒦ᵢᵀλ − A_i ν_i;  F_π += F_i
    for (Index c = s.first_dof[i]; c < s.first_dof[i + 1]; ++c) r1[c] = narrow<T>(dot(s_[c], force[i]) + torque[c]);
    if (s.parent[i] != ground) add(force[s.parent[i]], force[i]);
  }
}

template <class T> Index KktResidual<T>::workspace() const {
  const std::size_t bytes = 2 * h_.size() * sizeof(Six<W>) + (static_cast<std::size_t>(structure_->rows) + s_.size()) * sizeof(W);
  return static_cast<Index>((bytes + alignof(Six<W>)) / sizeof(T)) + 8;
}

template <class T> Index KktResidual<T>::bytes() const {
  return static_cast<Index>((s_.size() + k_.size()) * sizeof(Six<T>) + h_.size() * sizeof(SixBySix<T>) +
                            (armature_.size() + joint_k_.size()) * sizeof(T)) + damping_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class KktResidual<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
