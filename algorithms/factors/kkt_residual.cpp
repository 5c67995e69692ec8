#include "algorithms/factors/kkt_residual.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <cstdint>

namespace delassus {

template <class T> void KktResidual<T>::analyze(std::shared_ptr<const Structure> structure) {
  structure_ = std::move(structure);
  const Structure& s = *structure_;
  const std::size_t dofs = static_cast<std::size_t>(s.dofs());
  body_of_.resize(dofs);
  for (Index i = 0; i < s.bodies(); ++i) std::fill(body_of_.begin() + s.first_dof[i], body_of_.begin() + s.first_dof[i + 1], static_cast<int>(i));
  sixes_.divide(Six<T>::zero(), {{&s_, dofs}, {&k_, static_cast<std::size_t>(s.K_rows)}});
  h_.assign(static_cast<std::size_t>(s.bodies()), SixBySix<T>::zero());
  scalars_.divide(T(0), {{&armature_, dofs}, {&joint_k_, static_cast<std::size_t>(s.joint_K_size)}});
  damping_.analyze(s);
}

template <class T> void KktResidual<T>::update(const Problem<T>& problem) {
  std::transform(problem.S.begin(), problem.S.end(), s_.begin(), [](const Vector6<T>& x) { return load(x); });
  std::transform(problem.H.begin(), problem.H.end(), h_.begin(), [](const Matrix6<T>& x) { return load(x); });
  std::copy(problem.armature.begin(), problem.armature.end(), armature_.begin());
  update_rows(problem);
}

template <class T> void KktResidual<T>::update_rows(const Problem<T>& problem) {
  std::transform(problem.K.begin(), problem.K.end(), k_.begin(), [](const Vector6<T>& x) { return load(x); });
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k_.begin());
}

template <class T> void KktResidual<T>::numbers(Problem<T>& to) const {
  const auto six = [](const Six<T>& from, T* x) {
    for (int r = 0; r < 6; ++r) x[r] = from[r];
  };
  for (std::size_t c = 0; c < s_.size(); ++c) six(s_[c], to.S[c].data());
  for (std::size_t r = 0; r < k_.size(); ++r) six(k_[r], to.K[r].data());
  for (std::size_t i = 0; i < h_.size(); ++i)
    for (int c = 0; c < 6; ++c) six(h_[i].column[c], to.H[i].data() + 6 * c);
  std::copy(armature_.begin(), armature_.end(), to.armature.begin());
  std::copy(joint_k_.begin(), joint_k_.end(), to.joint_K.begin());
}

// In `work`, from where V is aligned.
template <class T> template <class V> struct KktResidual<T>::Buffers {
  Six<V> *acceleration, *force;  // a_i, F_i per body
  V *damped, *torque;            // R⁻¹λ; what of r₁ is not S_iᵀF_i

  template <class X> Buffers(const Structure& s, X* work) {
    const auto past = reinterpret_cast<std::uintptr_t>(work) % alignof(Six<V>);  // Wide<float> asks for more than float
    acceleration = reinterpret_cast<Six<V>*>(past == 0 ? work : work + (alignof(Six<V>) - past) / sizeof(X));
    force = acceleration + s.bodies();
    damped = reinterpret_cast<V*>(force + s.bodies());
    torque = damped + s.rows;
  }
};

template <class T>
template <class V, class X>
void KktResidual<T>::evaluate(const V* nu, const V* lambda, const X* r1_0, const X* r2_0, X* r1, X* r2, X* work) const {
  Buffers<V> b(*structure_, work);
  outward(nu, b);
  damping_.multiply(lambda, b.damped);
  link_rows(lambda, r2_0, r2, b);
  for (std::size_t c = 0; c < s_.size(); ++c) b.torque[c] = V(r1_0 == nullptr ? X{} : r1_0[c]) - nu[c] * armature_[c];
  joint_rows(nu, lambda, r2_0, r2, b);
  damping_.switch_off(r2);
  inward(r1, b);
}

// a_i = a_π + S_i ν_i;  F_i = −H_i a_i
template <class T> template <class V> void KktResidual<T>::outward(const V* nu, Buffers<V>& b) const {
  const Structure& s = *structure_;
  for (Index i = 0; i < s.bodies(); ++i) {
    Six<V> ai = s.parent[i] == ground ? Six<V>::zero() : b.acceleration[s.parent[i]];
    for (Index c = s.first_dof[i]; c < s.first_dof[i + 1]; ++c) add_scaled(ai, s_[c], nu[c]);
    b.acceleration[i] = ai;
    b.force[i] = negated(multiply(h_[i], ai));
  }
}

// r₂ = r₂⁰ − R⁻¹λ − Σ K_e^i a_i;  F_i += K_eᵀλ_e
template <class T>
template <class V, class X>
void KktResidual<T>::link_rows(const V* lambda, const X* r2_0, X* r2, Buffers<V>& b) const {
  for (const auto& e : structure_->link_constraints)
    for (Index first = 0; first < e.rows; first += 4) {
      const Index count = std::min<Index>(4, e.rows - first);
      Six<V> p[4] = {Six<V>::zero(), Six<V>::zero(), Six<V>::zero(), Six<V>::zero()};
      for (const auto& link : e.links) {
        const bool is_first = &link == e.links.data();
        const Six<T>* const k = k_.data() + link.first + first;
        const Six<V> ai = b.acceleration[link.body];
        Six<V> Fi = b.force[link.body];
        for (Index r = 0; r < count; ++r) {
          const Six<V> terms = product(k[r], ai);
          if (is_first) p[r] = terms;
          else add(p[r], terms);
          add_scaled(Fi, k[r], lambda[e.row + first + r]);
        }
        b.force[link.body] = Fi;
      }
      V sum[4];
      sums(p, sum, count);
      for (Index r = 0, row = e.row + first; r < count; ++r, ++row) r2[row] = narrow<X>(V(r2_0[row]) - b.damped[row] - sum[r]);
    }
}

// r₂ = r₂⁰ − R⁻¹λ − 𝒦ᵢ ν_i;  + 𝒦ᵢᵀλ
template <class T>
template <class V, class X>
void KktResidual<T>::joint_rows(const V* nu, const V* lambda, const X* r2_0, X* r2, Buffers<V>& b) const {
  for (const auto& j : structure_->joint_constraints) {
    const Index first = structure_->first_dof[j.body], n = structure_->dofs(j.body);
    for (Index r = 0; r < j.rows; ++r) {
      V residual = V(r2_0[j.row + r]) - b.damped[j.row + r];
      for (Index c = 0; c < n; ++c) {
        const T& k = joint_k_[j.first + r * n + c];
        residual -= nu[first + c] * k;
        b.torque[first + c] += lambda[j.row + r] * k;
      }
      r2[j.row + r] = narrow<X>(residual);
    }
  }
}

// F_π += F_i;  r₁ = r₁⁰ + S_iᵀF_i + 𝒦ᵢᵀλ − A_i ν_i
template <class T> template <class V, class X> void KktResidual<T>::inward(X* r1, Buffers<V>& b) const {
  const Structure& s = *structure_;
  for (Index i = s.bodies(); i-- > 0;)
    if (s.parent[i] != ground) add(b.force[s.parent[i]], b.force[i]);
  for (Index first = 0; first < s.dofs(); first += 4) {
    const Index count = std::min<Index>(4, s.dofs() - first);
    Six<V> p[4] = {Six<V>::zero(), Six<V>::zero(), Six<V>::zero(), Six<V>::zero()};
    for (Index r = 0; r < count; ++r) p[r] = product(s_[first + r], b.force[body_of_[first + r]]);
    V sum[4];
    sums(p, sum, count);
    for (Index r = 0; r < count; ++r) r1[first + r] = narrow<X>(sum[r] + b.torque[first + r]);
  }
}

template <class T> Index KktResidual<T>::workspace() const {
  using W = Wide<T>;
  const std::size_t bytes = 2 * h_.size() * sizeof(Six<W>) + (static_cast<std::size_t>(structure_->rows) + s_.size()) * sizeof(W);
  return static_cast<Index>((bytes + alignof(Six<W>)) / sizeof(T)) + 8;
}

template <class T> Index KktResidual<T>::bytes() const {
  return sixes_.bytes() + scalars_.bytes() + static_cast<Index>(h_.size() * sizeof(SixBySix<T>) + body_of_.size() * sizeof(int)) + damping_.bytes();
}

#define DELASSUS_INSTANTIATE(T)                                                                                     \
  template class KktResidual<T>;                                                                                    \
  template void KktResidual<T>::evaluate(const T*, const T*, const T*, const T*, T*, T*, T*) const;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#define DELASSUS_INSTANTIATE_WIDE(T) \
  template void KktResidual<T>::evaluate(const Wide<T>*, const Wide<T>*, const T*, const T*, T*, T*, T*) const;
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE_WIDE(Quad)
#else
DELASSUS_INSTANTIATE_WIDE(double)
DELASSUS_INSTANTIATE_WIDE(float)
template void KktResidual<double>::evaluate(const Lanes8*, const Lanes8*, const Lanes8*, const Lanes8*, Lanes8*, Lanes8*, Lanes8*) const;
template void KktResidual<double>::evaluate(const Wide<Lanes8>*, const Wide<Lanes8>*, const Lanes8*, const Lanes8*, Lanes8*, Lanes8*, Lanes8*) const;
#endif

}  // namespace delassus
