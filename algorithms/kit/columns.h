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

/// How many columns a value stands for.
template <class X> inline constexpr int columns_in = 1;
template <> inline constexpr int columns_in<Lanes8> = 8;
template <> inline constexpr int columns_in<Lanes8f> = 8;
template <class X> [[nodiscard, gnu::always_inline]] inline auto lane(const X& x, int l) {
  if constexpr (columns_in<X> == 1) return x;
  else return x[l];
}
template <class X, class T> [[gnu::always_inline]] inline void set_lane(X& x, int l, const T& value) {
  if constexpr (columns_in<X> == 1) x = value;
  else x[l] = value;
}

/// `count` columns of m numbers side by side; what is left of the lanes is zero.
template <class T, class V> void load_columns(const T* from, Index stride, Index m, Index count, V* x) {
  for (Index r = 0; r < m; ++r) {
    V v{};
    for (Index l = 0; l < count; ++l) v[l] = from[r + l * stride];
    x[r] = v;
  }
}

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
      const Index count = std::min(lane_count, k - c);
      load_columns(in.data() + c * in.outerStride(), in.outerStride(), m, count, x);
      kernel(static_cast<const V*>(x), y, y + padded(m));
      for (Index r = 0; r < m; ++r)
        for (Index l = 0; l < count; ++l) out(r, c + l) = y[r][l];
    }
  }
  for (; c < k; ++c)
    kernel(static_cast<const T*>(in.data() + c * in.outerStride()), out.data() + c * out.outerStride(), work);
}

}  // namespace delassus
