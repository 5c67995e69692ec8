// A register of the machine, for loops that keep sums in registers: a column of eight numbers is taken in parts of one register each.
//
// Other scalars than double and float are their own column, part and register.
#pragma once

#include <type_traits>
#include <utility>

#include "algorithms/kit/columns.h"

namespace delassus {

// The register, and how many sums stay in registers: of parts (at_once), of whole columns (in_factor).
#if defined __AVX512F__
using Doubles = Lanes8;
using Floats = Lanes8f;
inline constexpr int at_once = 8, in_factor = 8;
#elif defined __AVX2__
using Doubles = Lanes4;
using Floats = Lanes8f;
inline constexpr int at_once = 4, in_factor = 4;
#else
using Doubles = double __attribute__((vector_size(16)));
using Floats = Lanes4f;
inline constexpr int at_once = 4, in_factor = 2;
#endif
typedef float UnalignedFloats __attribute__((vector_size(32), aligned(4)));  // as in lanes.h
template <class T> using Part = std::conditional_t<std::is_same_v<T, double>, Doubles, std::conditional_t<std::is_same_v<T, float>, Floats, T>>;
template <class T> inline constexpr int parts = (has_lanes<T> ? static_cast<int>(lane_count) : 1) * static_cast<int>(sizeof(T)) / static_cast<int>(sizeof(Part<T>));
template <class T> inline constexpr int group = has_lanes<T> ? at_once : 1;

/// f of 0 … n − 1, known to the compiler.
template <int n, class F> [[gnu::always_inline]] inline void unrolled(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) { (f(std::integral_constant<int, k>{}), ...); }(std::make_integer_sequence<int, n>{});
}

/// The same number in all of a register.
template <class P, class T> [[nodiscard, gnu::always_inline]] inline P spread(const T& x) {
  if constexpr (std::is_same_v<P, T>) {
    return x;
  } else {
    P all;
    unrolled<static_cast<int>(sizeof(P) / sizeof(T))>([&](auto l) { all[l()] = x; });
    return all;
  }
}

/// Eight numbers at any address.
template <class C, class T> [[nodiscard, gnu::always_inline]] inline C unaligned(const T* x) {
  if constexpr (std::is_same_v<T, double>) return load_lanes(x);
  else return *reinterpret_cast<const UnalignedFloats*>(x);
}
[[gnu::always_inline]] inline void set_unaligned(double* to, const Lanes8& x) { store_lanes(to, x); }
[[gnu::always_inline]] inline void set_unaligned(float* to, const Lanes8f& x) { *reinterpret_cast<UnalignedFloats*>(to) = x; }

/// The first n < 8 of them, then zeros; never through memory, where narrow stores would wait for the wide load.
template <class C, class T> [[nodiscard, gnu::always_inline]] inline C first_of(const T* x, int n) {
#ifdef __AVX512VL__
  const auto mask = static_cast<__mmask8>((1 << n) - 1);
  if constexpr (std::is_same_v<T, double>) return _mm512_maskz_loadu_pd(mask, x);
  else return _mm256_maskz_loadu_ps(mask, x);
#else
  C all{};
  const auto take = [&]<int some, int... k>(std::integral_constant<int, some>, std::integer_sequence<int, k...>) { all = C{(k < some ? x[k] : T(0))...}; };
  unrolled<7>([&](auto k) { if (n == k() + 1) take(std::integral_constant<int, k() + 1>{}, std::make_integer_sequence<int, 8>{}); });
  return all;
#endif
}

/// Number c of a tile's column, in all of its rows.
template <int c, class C> [[nodiscard, gnu::always_inline]] inline C spread_row(const C& x) {
  if constexpr (columns_in<C> == 1) {
    return x;
  } else if constexpr (std::is_class_v<C>) {
    const Lanes4 half = c < 4 ? lower(x) : upper(x), all = __builtin_shufflevector(half, half, c % 4, c % 4, c % 4, c % 4);
    return joined(all, all);
  } else {
    return __builtin_shufflevector(x, x, c, c, c, c, c, c, c, c);
  }
}

/// The sum of what a register holds.
template <class T, class P> [[nodiscard, gnu::always_inline]] inline T sum_of(const P& x) {
  if constexpr (std::is_same_v<P, T>) {
    return x;
  } else {
    T sum = x[0];
    unrolled<static_cast<int>(sizeof(P) / sizeof(T)) - 1>([&](auto l) { sum += x[l() + 1]; });
    return sum;
  }
}

/// to_c += the sum of column c.
template <class T, class P> [[gnu::always_inline]] inline void add_sums(T* to, const P* sum) {
  if constexpr (std::is_same_v<P, Lanes8> && sums_together) {
    const Six<double> low[4] = {{sum[0]}, {sum[1]}, {sum[2]}, {sum[3]}}, high[4] = {{sum[4]}, {sum[5]}, {sum[6]}, {sum[7]}};
    store_lanes(to, load_lanes(to) + joined(four_sums(low), four_sums(high)));
  } else if constexpr (std::is_same_v<P, Lanes4>) {
    Lanes4 rows[4] = {sum[0], sum[1], sum[2], sum[3]};
    transpose_four(rows);
    UnalignedLanes4& four = *reinterpret_cast<UnalignedLanes4*>(to);
    four += (rows[0] + rows[1]) + (rows[2] + rows[3]);
  } else {
    unrolled<group<T>>([&](auto k) { to[k] += sum_of<T>(sum[k]); });
  }
}

}  // namespace delassus
