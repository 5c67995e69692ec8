// One step of Factor: the elimination of one joint.
#include <type_traits>

#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {
namespace {
// Steps go on behind a lost pivot: a negative one is as good as any to whoever counts them; by zero exact scalars cannot divide.
template <class T> T reciprocal(const T& pivot) {
  if constexpr (ScalarTraits<T>::exact) return pivot == T(0) ? T(0) : T(1) / pivot;
  else return T(1) / pivot;
}
}  // namespace

// H_ii as it is when step i runs.
template <class T> [[gnu::always_inline]] inline SixBySix<T> Factor<T>::inertia(int i) const {
  SixBySix<T> H = copied(filled_[i] != never ? inertia_[i] : own_[i - plan_->first_active]);
  for (int k = first_child_[i]; k >= 0; k = next_child_[k]) add(H, inertia_[k]);
  return H;
}

template <class T> bool Factor<T>::eliminate(int i) {
  const int n = plan_->first_column[i + 1] - plan_->first_column[i];
  if (n == 1 && plan_->simple(i)) return eliminate_simple(i);
  if constexpr (has_lanes<T>) {
    if (n == 6) return eliminate_general(i, std::integral_constant<int, 6>());
    if (n == 3) return eliminate_general(i, std::integral_constant<int, 3>());
  }
  return eliminate_general(i, n);
}

// The plain articulated-body step of one degree of freedom: H_ππ += H_ii − U D⁻¹Uᵀ.
template <class T> bool Factor<T>::eliminate_simple(int i) {
  const int c = plan_->first_column[i];
  SixBySix<T> H = inertia(i);
  const Six<T> U = multiply(H, s_[c]);
  const T D = dot(s_[c], U) + shift_[c];
  d_inverse_[c] = reciprocal(D);
  const Six<T> w = scaled(U, d_inverse_[c]);
  subtract_outer(H, w, U);
  copy(H, inertia_[i]);
  w_[plan_->first_w[i]] = w;
  return ScalarTraits<T>::usable_pivot(D);
}

// Alg. 4, lines 14–32, in the basis in which D_i is diagonal: W_j = H_ji S_i, W_π += U = H_ii S_i, D_i = A + 𝒦ᵀR𝒦 + SᵀU
template <class T> template <class N> bool Factor<T>::eliminate_general(int i, N n) {
  const int first = plan_->first_column[i], step = i - plan_->first_active;
  const Six<T>* const s = vector_of_[i] < 0 ? s_.data() + first : s0_.data() + vector_of_[i];
  SixBySix<T> H = inertia(i);
  Six<T> U[6];
  T D[6][6];
  for (int c = 0; c < n; ++c) {
    U[c] = multiply(H, s[c]);
    for (int d = 0; d <= c; ++d) D[c][d] = dot(s[d], U[c]);
    D[c][c] += n == 1 ? shift_[first] : armature_[first + c];
  }
  if (n > 1 && step >= 0 && joint_weight_of_[step] >= 0) {
    const T* const weight = joint_weight_.data() + joint_weight_of_[step];
    for (int c = 0; c < n; ++c)
      for (int d = 0; d <= c; ++d) D[c][d] += weight[c * n + d];
  }
  Six<T>* w = unscaled_.data();
  for (int k = plan_->first_member[i]; k < plan_->first_member[i + 1]; ++k)
    for (int c = 0; c < n; ++c, ++w) {
      const auto [j, block] = plan_->members[k];
      *w = block >= 0 ? multiply(block_[block], s[c]) : Six<T>::zero();
      if (j == plan_->parent[i]) add(*w, U[c]);
    }
  const bool usable = diagonalise(i, n, D);
  if (n > 1) take_basis(i, n, D);
  update_members(i, n, H);
  return usable;
}

// D = L diag(1/d_inverse) Lᵀ; L takes the place of the lower triangle of D.
template <class T> template <class N> bool Factor<T>::diagonalise(int i, N n, T (&D)[6][6]) {
  T* const d_inverse = d_inverse_.data() + plan_->first_column[i];
  bool usable = true;
  for (int c = 0; c < n; ++c) {
    usable = ScalarTraits<T>::usable_pivot(D[c][c]) && usable;
    d_inverse[c] = reciprocal(D[c][c]);
    T l[6];
    for (int d = c + 1; d < n; ++d) {
      l[d] = D[d][c] * d_inverse[c];
      for (int f = d; f < n; ++f) D[f][d] -= D[f][c] * l[d];
    }
    for (int d = c + 1; d < n; ++d) D[d][c] = l[d];
  }
  return usable;
}

// S, W_j and 𝒦 in the basis E = L⁻ᵀ
template <class T> template <class N> void Factor<T>::take_basis(int i, N n, const T (&L)[6][6]) {
  const auto take = [&](Six<T>* x) {
    for (int c = 0; c < n; ++c)
      for (int d = c + 1; d < n; ++d) subtract_scaled(x[d], x[c], L[d][c]);
  };
  Six<T>* const s = s_.data() + plan_->first_column[i];
  Six<T>* const e = e_.data() + vector_of_[i];
  for (int c = 0; c < n; ++c) {
    s[c] = s0_[vector_of_[i] + c];
    e[c] = unit_vector<T>(c);
  }
  take(s);
  take(e);
  for (int k = 0; k < plan_->first_member[i + 1] - plan_->first_member[i]; ++k) take(unscaled_.data() + k * n);
  if (i >= plan_->first_active) into_basis(i - plan_->first_active);
}

// 𝒦 ← 𝒦 E of the rows on the joint of an active step; E is unit upper triangular
template <class T> void Factor<T>::into_basis(int step) {
  const int of_joint = vector_of_[step + plan_->first_active];
  if (of_joint < 0) return;
  const Six<T>* const e = e_.data() + of_joint;
  for (int j = first_joint_rows_[step]; j < first_joint_rows_[step + 1]; ++j)
    for (Index r = 0; r < joint_rows_[j].rows; ++r) {
      const Index at = joint_rows_[j].first + r * joint_rows_[j].dofs;
      for (int c = 0; c < joint_rows_[j].dofs; ++c) {
        joint_k_[at + c] = joint_k0_[at + c];
        for (int d = 0; d < c; ++d) joint_k_[at + c] += joint_k0_[at + d] * e[c][d];
      }
    }
}

// Schur complement over Q_i and merging of body i into its parent, where W_j D⁻¹ is kept.
template <class T> template <class N> void Factor<T>::update_members(int i, N n, SixBySix<T>& H) {
  const int first = plan_->first_column[i], q = plan_->first_member[i + 1] - plan_->first_member[i];
  const Plan::Member* const member = plan_->members.data() + plan_->first_member[i];
  const int parent = plan_->parent[i];
  const Six<T>* const w = unscaled_.data();
  Six<T>* const wd = w_.data() + plan_->first_w[i];
  for (int k = 0; k < q; ++k)
    for (int c = 0; c < n; ++c) wd[k * n + c] = scaled(w[k * n + c], d_inverse_[first + c]);

  const int* pair = plan_->pairs.data() + plan_->first_pair[i];
  for (int k = 0; k < q; ++k) {
    const Six<T>* const wk = wd + k * n;
    const int j = member[k].step;
    if (j == parent) {  // H_ππ += H_ii + H_iπ + H_πi − W_π D⁻¹ W_πᵀ, the difference first
      if (member[k].block >= 0) {
        add(H, block_[member[k].block]);
        add(H, transposed(block_[member[k].block]));
      }
      subtract_products(H, w + k * n, wk, n);
      if (plan_->simple(i)) copy(H, inertia_[i]);
      else add(inertia_[j], H);
    } else {
      subtract_products(inertia_[j], w + k * n, wk, n);
    }
    for (int l = k + 1; l < q; ++l, ++pair) {
      if (j == parent) {  // H_πl += H_il − W_l D⁻¹ W_πᵀ
        SixBySix<T>& difference = block_[member[l].block];
        subtract_products(difference, w + l * n, wk, n);
        add(block_[*pair], difference);
      } else if (member[l].step == parent) {  // the same, with columns of k: (H_ik − W_k D⁻¹ W_πᵀ)ᵀ
        SixBySix<T>& difference = block_[member[k].block];
        subtract_products(difference, w + k * n, wd + l * n, n);
        add(block_[*pair], transposed(difference));
      } else {
        subtract_products(block_[*pair], w + l * n, wk, n);
      }
    }
  }
}

#define DELASSUS_INSTANTIATE(T) template SixBySix<T> Factor<T>::inertia(int) const; template bool Factor<T>::eliminate(int); template void Factor<T>::into_basis(int);
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#endif

}  // namespace delassus
