// The dense kernel of the square-root elimination: Householder reflections of a panel of rows.
//
// What     A panel has some leading columns, each an array of numbers, and trailing blocks of six columns, each an array
//          of rows. Its leading columns are reduced one by one: a reflection leaves one entry in the column, in the row
//          of its pivot, and is applied to everything behind.
// Formula  H = 1 − β v vᵀ, β = 2 / vᵀv, v₀ = x₀ + sign(x₀)‖x‖:  H x = −sign(x₀)‖x‖ e₀.
// Pivots   column: the largest norm that is left; row: the largest entry of that column. With both, the error of every
//          row is relative to the size of that row (not to the largest), which is what lets weights of very different
//          size stand in one panel.
// Cost     per reflection 4 operations per entry it meets, 2 more in leading columns for their norms.
// Source   M. Powell, J. Reid, 1969; A. Cox, N. Higham, Stability of Householder QR factorization for weighted
//          least squares problems, 1998.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "algorithms/six.h"

namespace delassus {

// Arrays of numbers go on to the next multiple of eight, so that they can be read in lanes.
using UnalignedLanes8 = double __attribute__((vector_size(64), aligned(8)));

[[nodiscard]] inline double total(const Lanes8& x) {
  const auto four = __builtin_shufflevector(x, x, 0, 1, 2, 3) + __builtin_shufflevector(x, x, 4, 5, 6, 7);
  const auto two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

/// xᵀ y; one of them is zero from `count` to the next multiple of eight.
template <class T> [[nodiscard]] inline T inner(const T* x, const T* y, int count) {
  if constexpr (std::is_same_v<T, double>) {
    const auto* const xs = reinterpret_cast<const UnalignedLanes8*>(x);
    const auto* const ys = reinterpret_cast<const UnalignedLanes8*>(y);
    Lanes8 products{};
    for (int k = 0; k < (count + 7) / 8; ++k) products += xs[k] * ys[k];
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
    auto* const xs = reinterpret_cast<UnalignedLanes8*>(x);
    const auto* const vs = reinterpret_cast<const UnalignedLanes8*>(v);
    for (int k = 0; k < (count + 7) / 8; ++k) xs[k] -= vs[k] * factor;
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

/// The index of the largest entry of v in magnitude; v is zero from `count` to the next multiple of eight.
template <class T> [[nodiscard]] inline int largest_entry(const T* v, int count) {
  using std::abs;
  int largest = 0;
  if constexpr (std::is_same_v<T, double>) {
    const auto* const vs = reinterpret_cast<const UnalignedLanes8*>(v);
    const auto magnitude = [&](int k) { const Lanes8 x = vs[k]; return Lanes8(x < 0 ? -x : x); };
    Lanes8 best = magnitude(0), chunk{};  // by lane: the largest, and the chunk it is in
    for (int k = 1; k < (count + 7) / 8; ++k) {
      const Lanes8 next = magnitude(k), here = Lanes8{} + k;
      chunk = next > best ? here : chunk;
      best = next > best ? next : best;
    }
    int lane = 0;
    for (int l = 1; l < 8; ++l)
      if (best[l] > best[lane]) lane = l;
    largest = 8 * static_cast<int>(chunk[lane]) + lane;
  } else {
    for (int r = 1; r < count; ++r)
      if (T(abs(v[r])) > T(abs(v[largest]))) largest = r;
  }
  return largest;
}

/// One reflection, besides its vector: the row of its pivot, β, and what it leaves there.
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
  /// Reduces column k, of that squared norm, within the first `count` rows.
  Reflection<T> reduce(int k, const T& squared, int count) const {
    using std::abs;
    using std::sqrt;
    T* const v = column(k);
    const int pivot = largest_entry(v, count);
    const T norm = sqrt(squared), x = v[pivot];
    v[pivot] = x < T(0) ? x - norm : x + norm;
    const T beta = T(1) / (norm * T(abs(v[pivot])));
    for (int c = k + 1; c < width; ++c) reflect(column(c), v, beta, count);
    for (int b = 0; b < blocks; ++b) reflect(block(b), v, beta, count);
    return {pivot, beta, x < T(0) ? norm : T(-norm)};
  }
  /// Exchanges two rows behind column k.
  void exchange(int k, int r, int s) const {
    for (int c = k + 1; c < width; ++c) std::swap(column(c)[r], column(c)[s]);
    for (int b = 0; b < blocks; ++b) std::swap(block(b)[r], block(b)[s]);
  }
};

}  // namespace delassus
