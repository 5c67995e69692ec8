// The dense kernel of the square-root elimination: Householder reflections of a panel of rows.
//
// What     A panel has some leading columns, each an array of numbers, and trailing blocks of six columns, each an array
//          of rows. Its leading columns are reduced one by one: a reflection leaves one entry in the column, in the row
//          of its pivot, and is applied to everything behind.
// Formula  H = 1 − β v vᵀ, β = 2 / vᵀv, v₀ = x₀ + sign(x₀)‖x‖:  H x = −sign(x₀)‖x‖ e₀.
// Pivots   column: the largest norm that is left; row: the largest entry of that column. With both, the error of every
//          row is relative to the size of that row (not to the largest), which is what lets weights of very different
//          size stand in one panel.
// Cost     per reflection 4 operations per entry it meets.
// Source   M. Powell, J. Reid, 1969; A. Cox, N. Higham, Stability of Householder QR factorization for weighted
//          least squares problems, 1998.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "algorithms/kit/six.h"

namespace delassus {

// Arrays of numbers go on to the next multiple of eight, so that they can be read in lanes.

/// xᵀ y; one of them is zero from `count` to the next multiple of eight.
template <class T> [[nodiscard]] inline T inner(const T* x, const T* y, int count) {
  if constexpr (std::is_same_v<T, double>) {
    Lanes8 products{};
    for (int k = 0; k < count; k += 8) products += load_lanes(x + k) * load_lanes(y + k);
    return total(products);
  } else {
    T sum(0);
    for (int r = 0; r < count; ++r) sum += x[r] * y[r];
    return sum;
  }
}

/// x ← (1 − β v vᵀ) x; v is zero from `count` to the next multiple of eight.
template <class T> inline void reflect(T* x, const T* v, const T& beta, int count) {
  const T factor = inner(x, v, count) * beta;
  if constexpr (std::is_same_v<T, double>) {
    for (int k = 0; k < count; k += 8) store_lanes(x + k, load_lanes(x + k) - load_lanes(v + k) * factor);
  } else {
    for (int r = 0; r < count; ++r) x[r] -= factor * v[r];
  }
}

/// rows ← (1 − β v vᵀ) rows.
template <class T> inline void reflect(Six<T>* rows, const T* v, const T& beta, int count) {
  Six<T> even = Six<T>::zero(), odd = even;  // two sums: a chain of additions would set the pace
  for (int r = 0; r + 1 < count; r += 2) {
    add_scaled(even, rows[r], v[r]);
    add_scaled(odd, rows[r + 1], v[r + 1]);
  }
  if (count % 2 != 0) add_scaled(even, rows[count - 1], v[count - 1]);
  add(even, odd);
  scale(even, beta);
  for (int r = 0; r < count; ++r) subtract_scaled(rows[r], even, v[r]);
}

template <int... lane> inline void keep_larger(Lanes4& value, Lanes4& index) {
  const Lanes4 other = picked<lane...>(value, value), at = picked<lane...>(index, index);
  index = other > value ? at : index;
  value = other > value ? other : value;
}

/// The index of the largest entry of v in magnitude; v is zero from `count` to the next multiple of eight.
template <class T> [[nodiscard]] inline int largest_entry(const T* v, int count) {
  using std::abs;
  if constexpr (std::is_same_v<T, double>) {
    const auto magnitude = [&](int k) {
      const Lanes4 x = reinterpret_cast<const UnalignedLanes4*>(v + k)[0];
      return Lanes4(x < 0 ? -x : x);
    };
    Lanes4 best = magnitude(0), index{0, 1, 2, 3}, here = index;  // by lane: the largest, and where it is
    for (int k = 4; k < count; k += 4) {
      const Lanes4 next = magnitude(k);
      here += 4;
      index = next > best ? here : index;
      best = next > best ? next : best;
    }
    keep_larger<2, 3, 0, 1>(best, index);
    keep_larger<1, 0, 3, 2>(best, index);
    return static_cast<int>(index[0]);
  } else {
    int largest = 0;
    for (int r = 1; r < count; ++r)
      if (T(abs(v[r])) > T(abs(v[largest]))) largest = r;
    return largest;
  }
}

/// The entries c of eight rows, for six c. Rows from `count` on are taken for zero.
inline void columns_of_eight(const Six<double>* rows, int count, Lanes8 (&column)[6]) {
  Lanes4 low[2][4], high[2][4];  // of rows 0…3 and 4…7: entries 0…3, and 4 and 5
  for (int k = 0; k < 8; ++k) {
    const Lanes8 row = k < count ? rows[k].v : Lanes8{};
    low[k / 4][k % 4] = lower(row);
    high[k / 4][k % 4] = upper(row);
  }
  for (int half = 0; half < 2; ++half) {
    transpose_four(low[half]);
    transpose_four(high[half]);
  }
  for (int c = 0; c < 4; ++c) column[c] = joined(low[0][c], low[1][c]);
  for (int c = 0; c < 2; ++c) column[4 + c] = joined(high[0][c], high[1][c]);
}

/// x_k[r] = rows[r]ᵀ matrix[k] for r < count, zero from there to the stride; x_k at x + k · stride.
template <class T> inline void multiply(const Six<T>* rows, int count, const Six<T>* matrix, int columns, T* x, Index stride) {
  for (int r = 0; r < stride; r += 8) {
    if constexpr (std::is_same_v<T, double>) {
      Lanes8 entries[6];
      columns_of_eight(rows + r, count - r, entries);
      for (int k = 0; k < columns; ++k) {
        Lanes8 sum = entries[0] * matrix[k][0];
        for (int c = 1; c < 6; ++c) sum += entries[c] * matrix[k][c];
        store_lanes(x + k * stride + r, sum);
      }
    } else {
      for (int k = 0; k < columns; ++k)
        for (int q = r; q < r + 8; ++q) x[k * stride + q] = q < count ? dot(matrix[k], rows[q]) : T(0);
    }
  }
}

/// x_c[r] = entry c of rows[r] for r < count, zero from there to the stride; x_c at x + c · stride.
template <class T> inline void transpose(const Six<T>* rows, int count, T* x, Index stride) {
  for (int r = 0; r < stride; r += 8) {
    if constexpr (std::is_same_v<T, double>) {
      Lanes8 entries[6];
      columns_of_eight(rows + r, count - r, entries);
      for (int c = 0; c < 6; ++c) store_lanes(x + c * stride + r, entries[c]);
    } else {
      for (int c = 0; c < 6; ++c)
        for (int q = r; q < r + 8; ++q) x[c * stride + q] = q < count ? rows[q][c] : T(0);
    }
  }
}

/// One reflection, besides its vector: the row of its pivot, β, and what it leaves there. β = 0: the column was zero.
template <class T> struct Reflection {
  int pivot;
  T beta, left;
};

/// Leading column c at columns + c · stride (zero from its last row to the stride), trailing block b at
/// rows + b · height. Reduced columns become the vectors of their reflections.
template <class T> struct Panel {
  T* columns;
  Index stride;
  int width;
  Six<T>* rows;
  Index height;
  int blocks;

  [[nodiscard]] T* column(int c) const { return columns + c * stride; }
  [[nodiscard]] Six<T>* block(int b) const { return rows + b * height; }

  /// Exchanges column k for the longest of columns k, k + 1, …, with what is known of them.
  void bring_longest(int k, T* squared, int* lane) const {
    int longest = k;
    for (int c = k + 1; c < width; ++c)
      if (squared[c] > squared[longest]) longest = c;
    if (longest == k) return;
    std::swap(squared[k], squared[longest]);
    std::swap(lane[k], lane[longest]);
    std::swap_ranges(column(k), column(k) + stride, column(longest));
  }
  /// Reduces column k within the first `count` rows and brings the pivot's row to the last of them.
  Reflection<T> reduce(int k, int count) const {
    using std::abs;
    using std::sqrt;
    T* const v = column(k);
    const T squared = inner(v, v, count);
    if (!ScalarTraits<T>::usable_pivot(squared)) {
      const T left = v[count - 1];
      std::fill_n(v, stride, T(0));
      return {count - 1, T(0), left};
    }
    const int pivot = largest_entry(v, count);
    const T norm = sqrt(squared), x = v[pivot];
    v[pivot] = x < T(0) ? x - norm : x + norm;
    const T beta = T(1) / (norm * T(abs(v[pivot])));
    for (int c = k + 1; c < width; ++c) {
      reflect(column(c), v, beta, count);
      std::swap(column(c)[pivot], column(c)[count - 1]);
    }
    for (int b = 0; b < blocks; ++b) {
      reflect(block(b), v, beta, count);
      std::swap(block(b)[pivot], block(b)[count - 1]);
    }
    return {pivot, beta, x < T(0) ? norm : T(-norm)};
  }
  /// Takes the entry in row `last` out of column c, whose squared norm it had a share in.
  T take(int c, int last, T& squared) const {
    const T entry = std::exchange(column(c)[last], T(0)), before = squared;
    squared -= entry * entry;
    if (!(squared > before / 1024)) squared = inner(column(c), column(c), last);  // few digits are left
    return entry;
  }
};

}  // namespace delassus
