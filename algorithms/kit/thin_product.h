// C += X Yᵀ for X and Y of few rows, side by side in their columns: sums of outer products of short columns.
//
// How      in double eight rows of X at a time, whatever their number is (what is loaded beyond them is not stored), and four of Y, so
//          that every sum stays in a register. X must be followed by seven numbers that may be read.
#pragma once

#include <algorithm>
#include <type_traits>

#include "algorithms/kit/lanes.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

/// C: x_rows × y_rows, columns `stride` apart; X: x_rows × depth, columns `x_stride` apart; Y: y_rows × depth.
template <class T>
void add_thin_product(T* C, Index stride, const T* X, Index x_stride, Index x_rows, const T* Y, Index y_rows, Index depth) {
  if constexpr (std::is_same_v<T, double>) {
    for (Index first = 0; first < x_rows; first += 8)
      for (Index c = 0; c < y_rows; c += 4) {
        const Index columns = std::min<Index>(4, y_rows - c), rows = std::min<Index>(8, x_rows - first);
        Lanes8 sum[4] = {};
        const auto add = [&](auto width) {
          for (Index k = 0; k < depth; ++k) {
            const Lanes8 x = load_lanes(X + k * x_stride + first);
            for (Index l = 0; l < width; ++l) sum[l] += x * Y[k * y_rows + c + l];
          }
        };
        if (columns == 4) add(std::integral_constant<Index, 4>{});
        else if (columns == 3) add(std::integral_constant<Index, 3>{});
        else if (columns == 2) add(std::integral_constant<Index, 2>{});
        else add(std::integral_constant<Index, 1>{});
        for (Index l = 0; l < columns; ++l)
          for (Index r = 0; r < rows; ++r) C[(c + l) * stride + first + r] += sum[l][r];
      }
  } else {
    for (Index c = 0; c < y_rows; ++c)
      for (Index r = 0; r < x_rows; ++r) {
        T sum(0);
        for (Index k = 0; k < depth; ++k) sum += X[k * x_stride + r] * Y[k * y_rows + c];
        C[c * stride + r] += sum;
      }
  }
}

/// The columns of X side by side.
template <class T> void add_thin_product(T* C, Index stride, const T* X, Index x_rows, const T* Y, Index y_rows, Index depth) {
  add_thin_product(C, stride, X, x_rows, x_rows, Y, y_rows, depth);
}

}  // namespace delassus
