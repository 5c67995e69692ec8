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

/// rows ← (1 − β v vᵀ) rows; returns the squared norms of its columns, row 0 left out.
template <class T> inline Six<T> reflect(Six<T>* rows, const T* v, const T& beta, int count) {
  Six<T> even = Six<T>::zero(), odd = even, norms = even;  // two sums: a chain of additions would set the pace
  int r = 0;
  for (; r + 1 < count; r += 2) {
    add_scaled(even, rows[r], v[r]);
    add_scaled(odd, rows[r + 1], v[r + 1]);
  }
  if (r < count) add_scaled(even, rows[r], v[r]);
  add(even, odd);
  scale(even, beta);
  subtract_scaled(rows[0], even, v[0]);
  for (r = 1; r < count; ++r) {
    subtract_scaled(rows[r], even, v[r]);
    add_squares(norms, rows[r]);
  }
  return norms;
}

using UnalignedLanes8 = double __attribute__((vector_size(64), aligned(8)));

/// x ← (1 − β v vᵀ) x for numbers; x and v are readable up to the next multiple of eight, where v is zero.
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

/// `blocks` blocks of `rows` rows each, block b at data + b · stride. Rows move up as they become pivots: order[r] is
/// where row r stood at first. v is scratch of `rows` numbers.
template <class T> struct Strip {
  Six<T>* data;
  Index stride;
  int blocks, rows;
  int* order;
  T* v;

  [[nodiscard]] Six<T>* block(int b) const { return data + b * stride; }
};

/// The reflections of one strip: the vector of reflection t is at v + t · stride, in the first order of the rows and zero
/// for the pivots before it. T is const where they are only applied.
template <class T> struct Reflections {
  T* v;
  Index stride;
  T* beta;

  [[nodiscard]] T* vector(int t) const { return v + t * stride; }
  /// x ← H_count−1 … H_0 x, and its inverse. x has `rows` numbers.
  void apply(std::remove_const_t<T>* x, int count, int rows) const {
    for (int t = 0; t < count; ++t) reflect(x, vector(t), beta[t], rows);
  }
  void apply_transposed(std::remove_const_t<T>* x, int count, int rows) const {
    for (int t = count; t-- > 0;) reflect(x, vector(t), beta[t], rows);
  }
};

/// Exchanges two rows in the blocks from b on.
template <class T> inline void exchange(const Strip<T>& strip, int b, int to, int from) {
  std::swap(strip.order[to], strip.order[from]);
  for (int i = b; i < strip.blocks; ++i) std::swap(strip.block(i)[to], strip.block(i)[from]);
}

/// Reduces `columns` columns of block b to triangular form in rows top, top + 1, …; lane[k] is the column reduced k-th.
/// least_squared[c]: a column c whose remaining squared norm does not exceed it has no numerical support. Returns the
/// number of columns reduced; it is less than `columns` when the next best one, lane[that number], has no support.
/// Blocks before b, and in block b what lies below a pivot, are not kept up.
template <class T>
int triangularise(const Strip<T>& strip, int b, int top, int columns, const T* least_squared, const Reflections<T>& kept,
                  int* lane) {
  using std::abs;
  using std::sqrt;
  Six<T>* const rows = strip.block(b);
  T* const v = strip.v;
  for (int k = 0; k < columns; ++k) lane[k] = k;
  Six<T> norms = squared_norms(rows + top, strip.rows - top);
  for (int k = 0; k < columns; ++k, ++top) {
    const int count = strip.rows - top;
    for (int c = k + 1; c < columns; ++c)
      if (norms[lane[c]] > norms[lane[k]]) std::swap(lane[k], lane[c]);
    const int j = lane[k];
    const T squared = norms[j];
    if (count == 0 || !ScalarTraits<T>::usable_pivot(squared) || !(squared > least_squared[j])) return k;

    int largest = 0;
    for (int r = 0; r < count; ++r) {
      v[r] = rows[top + r][j];
      if (T(abs(v[r])) > T(abs(v[largest]))) largest = r;
    }
    std::swap(v[0], v[largest]);
    exchange(strip, b, top, top + largest);
    const T norm = sqrt(squared), x0 = v[0];
    v[0] = x0 < T(0) ? x0 - norm : x0 + norm;
    const T beta = kept.beta[top] = T(1) / (norm * T(abs(v[0])));
    T* const vector = kept.vector(top);
    std::fill_n(vector, kept.stride, T(0));
    for (int r = 0; r < count; ++r) vector[strip.order[top + r]] = v[r];

    if (k + 1 < columns) norms = reflect(rows + top, v, beta, count);
    rows[top].v[j] = x0 < T(0) ? norm : -norm;
    for (int i = b + 1; i < strip.blocks; ++i) reflect(strip.block(i) + top, v, beta, count);
  }
  return columns;
}

}  // namespace delassus
