// Reductions of vectors that are zero up to their padded ends (columns.h), eight entries at a time where the scalar has lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/kit/columns.h"
#include "algorithms/kit/six.h"

namespace delassus {

/// max |x_c|; NaN is passed over.
template <class T> [[nodiscard]] inline double largest_magnitude(const T* x, Index n) {
  if constexpr (std::is_same_v<T, double>) {
    const Lanes4* const v = reinterpret_cast<const Lanes4*>(x);
    Lanes4 most[2] = {};
    for (Index c = 0; 4 * c < n; c += 2)
      for (Index half = 0; half < 2; ++half) {
        const Lanes4 size = v[c + half] < 0 ? -v[c + half] : v[c + half];
        most[half] = most[half] < size ? size : most[half];
      }
    double largest = 0;
    for (int l = 0; l < 8; ++l) largest = std::max(largest, most[l / 4][l % 4]);
    return largest;
  } else {
    double largest = 0;
    for (Index c = 0; c < n; ++c) largest = std::max(largest, std::abs(static_cast<double>(x[c])));
    return largest;
  }
}

/// The same of each column.
template <class X> [[nodiscard]] inline std::array<double, columns_in<X>> largest_magnitudes(const X* x, Index n) {
  if constexpr (columns_in<X> == 1) return {largest_magnitude(x, n)};
  else {
    std::array<double, columns_in<X>> largest{};
    for (Index r = 0; r < n; ++r)
      for (int l = 0; l < columns_in<X>; ++l) {
        const double size = std::abs(static_cast<double>(x[r][l]));
        largest[l] = largest[l] < size ? size : largest[l];
      }
    return largest;
  }
}

/// xᵀ y, of each column where they are lanes.
template <class T> [[nodiscard]] inline T dot(const T* x, const T* y, Index n) {
  if constexpr (std::is_same_v<T, double>) {
    const Lanes8 *const a = reinterpret_cast<const Lanes8*>(x), *const b = reinterpret_cast<const Lanes8*>(y);
    Lanes8 sum{};
    for (Index c = 0; 8 * c < n; ++c) sum += a[c] * b[c];
    return total(sum);
  } else {
    T sum{};
    for (Index c = 0; c < n; ++c) sum += x[c] * y[c];
    return sum;
  }
}

/// Σ x_c y_c z_c.
template <class T> [[nodiscard]] inline T dot(const T* x, const T* y, const T* z, Index n) {
  if constexpr (std::is_same_v<T, double>) {
    const Lanes8 *const a = reinterpret_cast<const Lanes8*>(x), *const b = reinterpret_cast<const Lanes8*>(y), *const d = reinterpret_cast<const Lanes8*>(z);
    Lanes8 sum{};
    for (Index c = 0; 8 * c < n; ++c) sum += a[c] * b[c] * d[c];
    return total(sum);
  } else {
    T sum{};
    for (Index c = 0; c < n; ++c) sum += x[c] * y[c] * z[c];
    return sum;
  }
}

}  // namespace delassus
