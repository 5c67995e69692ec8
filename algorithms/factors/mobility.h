// One joint outwards: mobilities and motions of a body from those of its parent. In the basis of Factor::joint, w = W_π D⁻¹.
//
//   forces inwards     κ_π = P κ_i,  P = 1 − w Sᵀ
//   motions outwards   a_i = Pᵀ a_π
//   mobility           Ω_i = S D⁻¹Sᵀ + Pᵀ Ω_π P
//
// Cost     about 23 n_i per force or motion, 300 per mobility of a joint of one degree of freedom.
// Source   Kreutz-Delgado, Jain and Rodriguez 1992; paper, Algorithm 2.
#pragma once

#include "algorithms/factors/factor.h"

namespace delassus {

template <class T> inline void carry_inwards(const typename Factor<T>::Joint& j, Six<T>& force) {
  T g[6];
  for (int c = 0; c < j.dofs; ++c) g[c] = dot(j.s[c], force);
  for (int c = 0; c < j.dofs; ++c) subtract_scaled(force, j.w[c], g[c]);
}

template <class T> inline void carry_outwards(const typename Factor<T>::Joint& j, Six<T>& motion) {
  T g[6];
  for (int c = 0; c < j.dofs; ++c) g[c] = dot(j.w[c], motion);
  for (int c = 0; c < j.dofs; ++c) subtract_scaled(motion, j.s[c], g[c]);
}

/// Ω_i; of_parent = nullptr: the parent does not move.
template <class T> [[nodiscard]] inline SixBySix<T> mobility(const typename Factor<T>::Joint& j, const SixBySix<T>* of_parent) {
  SixBySix<T> omega = of_parent == nullptr ? SixBySix<T>::zero() : copied(*of_parent);
  if (of_parent == nullptr) {
    for (int c = 0; c < j.dofs; ++c) add_outer(omega, j.s[c], scaled(j.s[c], j.d_inverse[c]));
    return omega;
  }
  for (int c = 0; c < j.dofs; ++c) {
    const Six<T> pushed = multiply(*of_parent, j.w[c]);
    subtract_outer(omega, j.s[c], pushed);
    subtract_outer(omega, pushed, j.s[c]);
    for (int e = 0; e < j.dofs; ++e) {
      const T moved = dot(j.w[e], pushed);
      add_outer(omega, j.s[e], scaled(j.s[c], e == c ? T(j.d_inverse[c] + moved) : moved));
    }
  }
  return omega;
}

/// Ω = Σ_c d_c z_c z_cᵀ, z unit lower triangular: what differences of large numbers leave of a stiff direction is not seen in a sum
/// of squares.
template <class T> struct MobilityRoot {
  T z[6][6], d[6];  // column by column
};

/// Of body i from that of its parent (nullptr: the parent does not move): Σ of the parent's columns carried outwards and S_i D⁻¹S_iᵀ, by
/// weighted Gram–Schmidt (Björck, Numerical Methods for Least Squares Problems, section 2.4). About 750 operations.
template <class T> inline void carry_outwards(const typename Factor<T>::Joint& j, const MobilityRoot<T>* of_parent, MobilityRoot<T>& root) {
  T Z[12][6], weight[12];
  int n = 0;
  const auto take = [&](const Six<T>& column, const T& w) {
    for (int r = 0; r < 6; ++r) Z[n][r] = column[r];
    weight[n++] = w;
  };
  for (int c = 0; of_parent != nullptr && c < 6; ++c) {
    Six<T> column = load(of_parent->z[c]);
    carry_outwards(j, column);
    take(column, of_parent->d[c]);
  }
  for (int c = 0; c < j.dofs; ++c) take(j.s[c], j.d_inverse[c]);
  for (int r = 0; r < 6; ++r) {
    T weighted[12], d(0);
    for (int k = 0; k < n; ++k) d += (weighted[k] = Z[k][r] * weight[k]) * Z[k][r];
    const bool moves = ScalarTraits<T>::usable_pivot(d);
    root.d[r] = d;
    for (int q = 0; q < 6; ++q) root.z[r][q] = T(q == r ? 1 : 0);
    for (int q = r + 1; moves && q < 6; ++q) {
      T l(0);
      for (int k = 0; k < n; ++k) l += weighted[k] * Z[k][q];
      root.z[r][q] = l = l / d;
      for (int k = 0; k < n; ++k) Z[k][q] -= Z[k][r] * l;
    }
  }
}

}  // namespace delassus
