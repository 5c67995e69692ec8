// Columns of right-hand sides: one kernel call per column, or per eight columns where the scalar has lanes and they win.
#pragma once

#include <algorithm>

#include "algorithms/kit/six.h"

namespace delassus {

/// Rounds a count of scalars up so that what follows stays 64-byte aligned.
[[nodiscard]] constexpr Index padded(Index n) { return (n + 7) / 8 * 8; }

/// Fewer columns than this go one by one: eight lanes take as long however few are filled, as long as two calls on robots,
/// three and a half on piles of boxes (`bench --benchmark_filter=columns_`).
inline constexpr Index least_lanes = 4;

/// Scalars for_columns needs when its kernel needs `values` values of V.
template <class T> [[nodiscard]] Index columns_workspace(Index m, Index values, Index columns) {
  return has_lanes<T> && columns >= least_lanes ? lane_count * (2 * padded(m) + values) : values;
}

/// Calls kernel(const V* x, V* y, V* work) on m contiguous values each, V = T for one column, lanes of T for more.
template <class T, class Kernel> void for_columns(ConstRef<T> in, Ref<T> out, T* work, Kernel&& kernel) {
  const Index m = in.rows(), k = in.cols();
  Index c = 0;
  if constexpr (has_lanes<T>) {
    using V = Lanes<T>;
    V* const x = reinterpret_cast<V*>(work);
    V* const y = x + padded(m);
    for (; k - c >= least_lanes; c += std::min(lane_count, k - c)) {
      const Index width = std::min(lane_count, k - c);
      for (Index r = 0; r < m; ++r) {
        V v{};
        for (Index l = 0; l < width; ++l) v[l] = in(r, c + l);
        x[r] = v;
      }
      kernel(static_cast<const V*>(x), y, y + padded(m));
      for (Index r = 0; r < m; ++r)
        for (Index l = 0; l < width; ++l) out(r, c + l) = y[r][l];
    }
  }
  for (; c < k; ++c)
    kernel(static_cast<const T*>(in.data() + c * in.outerStride()), out.data() + c * out.outerStride(), work);
}

}  // namespace delassus
