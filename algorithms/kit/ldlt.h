// Square-root-free Cholesky of small and dense matrices: A = L D Lᵀ, L unit lower triangular. No allocation, any scalar.
//
// What     A (n × n, column-major with stride ld, lower triangle read) is overwritten by L below the diagonal and D on it.
// Cost     n³/3 operations; solve 2 n².
// Error    normwise backward stable for positive definite A (Higham, Accuracy and Stability, theorem 10.3).
#pragma once

#include "algorithms/kit/scalars.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

template <class T> using StridedMap = Eigen::Map<MatrixX<T>, 0, Eigen::OuterStride<>>;
template <class T> using ConstStridedMap = Eigen::Map<const MatrixX<T>, 0, Eigen::OuterStride<>>;

/// Factorises in place. Returns −1, or the index of the first pivot that is not usable.
template <class T> [[nodiscard]] Index ldlt_factor(T* a, Index n, Index ld) {
  using Column = Eigen::Map<VectorX<T>>;
  for (Index k = 0; k < n; ++k) {
    T* const column = a + k * ld;
    const T d = column[k];
    if (!ScalarTraits<T>::usable_pivot(d)) return k;
    for (Index j = k + 1; j < n; ++j) {  // right-looking: A_j −= L_jk d L_·k
      const T l = column[j] / d;
      Column(a + j * ld + j, n - j) -= Column(column + j, n - j) * l;
    }
    for (Index i = k + 1; i < n; ++i) column[i] = column[i] / d;
  }
  return -1;
}

/// x ← (L D Lᵀ)⁻¹ x.
template <class T> void ldlt_solve(const T* a, Index n, Index ld, T* x) {
  using Column = Eigen::Map<const VectorX<T>>;
  for (Index k = 0; k < n; ++k)  // L y = x
    Eigen::Map<VectorX<T>>(x + k + 1, n - k - 1) -= Column(a + k * ld + k + 1, n - k - 1) * x[k];
  for (Index k = 0; k < n; ++k) x[k] = x[k] / a[k * ld + k];
  for (Index k = n; k-- > 0;)  // Lᵀ x = y
    for (Index i = k + 1; i < n; ++i) x[k] -= a[k * ld + i] * x[i];
}

/// Overwrites the factor by the full symmetric inverse, using n scratch numbers.
template <class T> void ldlt_inverse(T* a, Index n, Index ld, T* inverse) {
  for (Index c = 0; c < n; ++c) {
    T* const x = inverse + c * n;
    for (Index r = 0; r < n; ++r) x[r] = T(r == c ? 1 : 0);
    ldlt_solve(a, n, ld, x);
  }
}

}  // namespace delassus
