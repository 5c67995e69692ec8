// The dense kernel of the square-root elimination: Householder reflections of a strip of rows.
//
// What     A strip is a matrix stored as blocks of six columns; each block is an array of rows, each row a Six<T>.
//          `triangularise` reduces some columns of one block from row `top` on and applies the reflections to it and to
//          every later block.
// Formula  H = 1 − β v vᵀ, β = 2 / vᵀv, v₀ = x₀ + sign(x₀)‖x‖:  H x = −sign(x₀)‖x‖ e₀.
// Pivots   column: the largest norm that is left; row: the largest entry of that column comes to the top. With both, the
//          error of every row is relative to the size of that row (not to the largest), which is what lets weights of
//          very different size stand in one strip.
// Cost     per reflection 4 operations per entry it meets.
// Source   M. Powell, J. Reid, 1969; A. Cox, N. Higham, Stability of Householder QR factorization for weighted
//          least squares problems, 1998.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "algorithms/six.h"

namespace delassus {

/// y += the squares of x.
template <class T> inline void add_squares(Six<T>& y, const Six<T>& x) {
  if constexpr (std::is_same_v<T, double>) y.v += x.v * x.v;
  else for (int k = 0; k < 6; ++k) y.v[k] += x.v[k] * x.v[k];
}

/// The squared norms of the columns of `count` rows.
template <class T> [[nodiscard]] inline Six<T> squared_norms(const Six<T>* rows, int count) {
  Six<T> sum = Six<T>::zero();
  for (int r = 0; r < count; ++r) add_squares(sum, rows[r]);
  return sum;
}

/// rows ← (1 − β v vᵀ) rows; returns the squared norms of its columns, row `pivot` left out.
template <class T> inline Six<T> reflect(Six<T>* rows, const T* v, const T& beta, int count, int pivot) {
  Six<T> even = Six<T>::zero(), odd = even, norms = even;  // two sums: a chain of additions would set the pace
  for (int r = 0; r + 1 < count; r += 2) {
    add_scaled(even, rows[r], v[r]);
    add_scaled(odd, rows[r + 1], v[r + 1]);
  }
  if (count % 2 != 0) add_scaled(even, rows[count - 1], v[count - 1]);
  add(even, odd);
  scale(even, beta);
  const auto update = [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      subtract_scaled(rows[r], even, v[r]);
      add_squares(norms, rows[r]);
    }
  };
  update(0, pivot);
  subtract_scaled(rows[pivot], even, v[pivot]);
  update(pivot + 1, count);
  return norms;
}

using UnalignedLanes8 = double __attribute__((vector_size(64), aligned(8)));

/// x ← (1 − β v vᵀ) x for numbers; x and v go on to the next multiple of eight, where v is zero.
template <class T> inline void reflect(T* x, const T* v, const T& beta, int count) {
  if constexpr (std::is_same_v<T, double>) {
    auto* const xs = reinterpret_cast<UnalignedLanes8*>(x);
    const auto* const vs = reinterpret_cast<const UnalignedLanes8*>(v);
    const int chunks = (count + 7) / 8;
    Six<double> sum = Six<double>::zero();
    for (int k = 0; k < chunks; ++k) sum.v += xs[k] * vs[k];
    const auto four = __builtin_shufflevector(sum.v, sum.v, 0, 1, 2, 3) + __builtin_shufflevector(sum.v, sum.v, 4, 5, 6, 7);
    const auto two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
    const double factor = (two[0] + two[1]) * beta;
    for (int k = 0; k < chunks; ++k) xs[k] -= vs[k] * factor;
  } else {
    T sum(0);
    for (int r = 0; r < count; ++r) sum += x[r] * v[r];
    sum *= beta;
    for (int r = 0; r < count; ++r) x[r] -= sum * v[r];
  }
}

/// The index of the largest entry of v in magnitude; v as above.
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

/// `blocks` blocks of `rows` rows each, block b at data + b · stride. A row that has become a pivot is taken out: zero.
template <class T> struct Strip {
  Six<T>* data;
  Index stride;
  int blocks, rows;

  [[nodiscard]] Six<T>* block(int b) const { return data + b * stride; }
};

/// The reflections of one strip, in the order of its rows: the vector of reflection t is at v + t · stride, zero for the
/// rows taken before and from the last row to the stride; its pivot is row pivot[t]. T is const where they are applied.
template <class T> struct Reflections {
  T* v;
  Index stride;
  T* beta;
  std::conditional_t<std::is_const_v<T>, const int, int>* pivot;

  [[nodiscard]] T* vector(int t) const { return v + t * stride; }
  /// x ← H_count−1 … H_0 x, and its inverse. x has `rows` numbers.
  void apply(std::remove_const_t<T>* x, int count, int rows) const {
    for (int t = 0; t < count; ++t) reflect(x, vector(t), beta[t], rows);
  }
  void apply_transposed(std::remove_const_t<T>* x, int count, int rows) const {
    for (int t = count; t-- > 0;) reflect(x, vector(t), beta[t], rows);
  }
};

/// Reduces `columns` columns of block b, one by one: column lane[k] to nothing but its pivot, by reflection t + k. The
/// pivot's row is then complete: take(k, row) must copy it from blocks b, b + 1, … and leave zeros there. In block b it
/// holds for lane[k], lane[k + 1], … only.
/// least_squared[c]: a column c whose remaining squared norm does not exceed it has no numerical support. Returns the
/// number of columns reduced; it is less than `columns` when the next best one, lane[that number], has no support.
template <class T, class Take>
int triangularise(const Strip<T>& strip, int b, int columns, const T* least_squared, const Reflections<T>& kept, int t,
                  int* lane, Take&& take) {
  using std::abs;
  using std::sqrt;
  Six<T>* const rows = strip.block(b);
  for (int k = 0; k < columns; ++k) lane[k] = k;
  Six<T> norms = squared_norms(rows, strip.rows);
  for (int k = 0; k < columns; ++k, ++t) {
    for (int c = k + 1; c < columns; ++c)
      if (norms[lane[c]] > norms[lane[k]]) std::swap(lane[k], lane[c]);
    const int j = lane[k];
    const T squared = norms[j];
    if (!ScalarTraits<T>::usable_pivot(squared) || !(squared > least_squared[j])) return k;

    T* const v = kept.vector(t);
    for (int r = 0; r < strip.rows; ++r) v[r] = rows[r][j];
    std::fill(v + strip.rows, v + kept.stride, T(0));
    const int pivot = kept.pivot[t] = largest_entry(v, strip.rows);
    const T norm = sqrt(squared), x = v[pivot];
    v[pivot] = x < T(0) ? x - norm : x + norm;
    const T beta = kept.beta[t] = T(1) / (norm * T(abs(v[pivot])));
    if (k + 1 < columns) norms = reflect(rows, v, beta, strip.rows, pivot);
    rows[pivot].v[j] = x < T(0) ? norm : -norm;
    for (int i = b + 1; i < strip.blocks; ++i) reflect(strip.block(i), v, beta, strip.rows, pivot);
    take(k, pivot);
  }
  return columns;
}

}  // namespace delassus
