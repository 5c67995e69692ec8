// Eight numbers side by side: the width of every kernel, whatever the instruction set.
//
//   Lanes4  four doubles, one vector of the compiler
//   Lanes8  eight doubles: one vector of the compiler, or with AVX2 two Lanes4 (of which g++ 12 keeps both in registers; a
//           vector of eight it takes apart through memory there; without AVX2 it is the other way round)
//
// Sums over lanes are taken in one order, halves first, so that the width of the machine does not change a bit of them.
#pragma once

#include <cstddef>
#include <type_traits>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace delassus {

using Lanes4 = double __attribute__((vector_size(32)));
typedef double UnalignedLanes4 __attribute__((vector_size(32), aligned(8)));  // clang forgets the alignment in `using`, g++ in `auto`
using Lanes8f = float __attribute__((vector_size(32)));
using Lanes4f = float __attribute__((vector_size(16)));
typedef float UnalignedLanes4f __attribute__((vector_size(16), aligned(4)));

/// Whether sums over the lanes of several vectors are taken together (without AVX2 g++ 12 does it through memory).
#ifdef __AVX2__
inline constexpr bool sums_together = true;
#else
inline constexpr bool sums_together = false;
#endif

/// a b + c, rounded once.
[[nodiscard]] inline double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
[[nodiscard, gnu::always_inline]] inline Lanes4 fused(const Lanes4& a, const Lanes4& b, const Lanes4& c) {
#ifdef __FMA__  // g++ 12 takes the loop apart
  return _mm256_fmadd_pd(a, b, c);
#else
  return Lanes4{fused(a[0], b[0], c[0]), fused(a[1], b[1], c[1]), fused(a[2], b[2], c[2]), fused(a[3], b[3], c[3])};
#endif
}

#if defined __AVX512F__ || !defined __AVX2__

using Lanes8 = double __attribute__((vector_size(64)));
[[nodiscard, gnu::always_inline]] inline Lanes8 joined(const Lanes4& lower, const Lanes4& upper) {
  return __builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[nodiscard, gnu::always_inline]] inline Lanes4 lower(const Lanes8& x) { return __builtin_shufflevector(x, x, 0, 1, 2, 3); }
[[nodiscard, gnu::always_inline]] inline Lanes4 upper(const Lanes8& x) { return __builtin_shufflevector(x, x, 4, 5, 6, 7); }
[[nodiscard, gnu::always_inline]] inline Lanes8 fused(const Lanes8& a, const Lanes8& b, const Lanes8& c) {
#ifdef __AVX512F__
  return _mm512_fmadd_pd(a, b, c);
#else
  return joined(fused(lower(a), lower(b), lower(c)), fused(upper(a), upper(b), upper(c)));
#endif
}
/// The first six of x, then zeros.
[[nodiscard, gnu::always_inline]] inline Lanes8 load_six(const double* x) {
#ifdef __AVX512F__
  return _mm512_maskz_loadu_pd(0x3f, x);
#else
  return Lanes8{x[0], x[1], x[2], x[3], x[4], x[5], 0, 0};
#endif
}
typedef double UnalignedLanes8 __attribute__((vector_size(64), aligned(8)));
/// Eight numbers at any address.
[[nodiscard, gnu::always_inline]] inline Lanes8 load_lanes(const double* x) { return *reinterpret_cast<const UnalignedLanes8*>(x); }
[[gnu::always_inline]] inline void store_lanes(double* x, const Lanes8& y) { *reinterpret_cast<UnalignedLanes8*>(x) = y; }

#else

struct alignas(64) Lanes8 {
  Lanes4 lo, hi;

  Lanes8() = default;
  Lanes8(const Lanes4& l, const Lanes4& h) : lo(l), hi(h) {}
  /// The same number in all lanes.
  Lanes8(double x) : lo{x, x, x, x}, hi{x, x, x, x} {}
  Lanes8(double a, double b, double c, double d, double e, double f, double g, double h) : lo{a, b, c, d}, hi{e, f, g, h} {}

  double operator[](std::ptrdiff_t k) const { return k < 4 ? lo[k] : hi[k - 4]; }
  double& operator[](std::ptrdiff_t k) { return reinterpret_cast<double*>(this)[k]; }  // a vector may alias its entries

  Lanes8& operator+=(const Lanes8& x) { return lo += x.lo, hi += x.hi, *this; }
  Lanes8& operator-=(const Lanes8& x) { return lo -= x.lo, hi -= x.hi, *this; }
  Lanes8& operator*=(const Lanes8& x) { return lo *= x.lo, hi *= x.hi, *this; }
  Lanes8& operator*=(double s) { return lo *= s, hi *= s, *this; }
  friend Lanes8 operator+(const Lanes8& x, const Lanes8& y) { return {x.lo + y.lo, x.hi + y.hi}; }
  friend Lanes8 operator-(const Lanes8& x, const Lanes8& y) { return {x.lo - y.lo, x.hi - y.hi}; }
  friend Lanes8 operator*(const Lanes8& x, const Lanes8& y) { return {x.lo * y.lo, x.hi * y.hi}; }
  friend Lanes8 operator*(const Lanes8& x, double s) { return {x.lo * s, x.hi * s}; }
  friend Lanes8 operator*(double s, const Lanes8& x) { return x * s; }
  friend Lanes8 operator/(const Lanes8& x, const Lanes8& y) { return {x.lo / y.lo, x.hi / y.hi}; }
  friend Lanes8 operator/(const Lanes8& x, double s) { return {x.lo / s, x.hi / s}; }
  friend Lanes8 operator-(const Lanes8& x) { return {-x.lo, -x.hi}; }
};
[[nodiscard, gnu::always_inline]] inline Lanes8 joined(const Lanes4& lower, const Lanes4& upper) { return {lower, upper}; }
[[nodiscard, gnu::always_inline]] inline Lanes4 lower(const Lanes8& x) { return x.lo; }
[[nodiscard, gnu::always_inline]] inline Lanes4 upper(const Lanes8& x) { return x.hi; }
[[nodiscard, gnu::always_inline]] inline Lanes8 fused(const Lanes8& a, const Lanes8& b, const Lanes8& c) {
  return {fused(a.lo, b.lo, c.lo), fused(a.hi, b.hi, c.hi)};
}
/// The first six of x, then zeros.
[[nodiscard, gnu::always_inline]] inline Lanes8 load_six(const double* x) {
  return {Lanes4{x[0], x[1], x[2], x[3]}, Lanes4{x[4], x[5], 0, 0}};
}
/// Eight numbers at any address.
[[nodiscard, gnu::always_inline]] inline Lanes8 load_lanes(const double* x) {
  const UnalignedLanes4* const halves = reinterpret_cast<const UnalignedLanes4*>(x);
  return {Lanes4(halves[0]), Lanes4(halves[1])};  // by value: a reference would claim an alignment that x has not
}
[[gnu::always_inline]] inline void store_lanes(double* x, const Lanes8& y) {
  UnalignedLanes4* const halves = reinterpret_cast<UnalignedLanes4*>(x);
  halves[0] = y.lo;
  halves[1] = y.hi;
}

#endif

/// The first n of x; all of them from 4 on.
[[gnu::always_inline]] inline void store_lanes(double* to, const Lanes4& x, int n) {
  if (n >= 4) *reinterpret_cast<UnalignedLanes4*>(to) = x;
  else
#ifdef __AVX512VL__
    _mm256_mask_storeu_pd(to, static_cast<__mmask8>((1 << n) - 1), x);
#else
    for (int k = 0; k < n; ++k) to[k] = x[k];
#endif
}
[[gnu::always_inline]] inline void store_lanes(float* to, const Lanes4f& x, int n) {
  if (n >= 4) *reinterpret_cast<UnalignedLanes4f*>(to) = x;
  else
    for (int k = 0; k < n; ++k) to[k] = x[k];
}

[[nodiscard, gnu::always_inline]] inline Lanes4f lower(const Lanes8f& x) { return __builtin_shufflevector(x, x, 0, 1, 2, 3); }
[[nodiscard, gnu::always_inline]] inline Lanes4f upper(const Lanes8f& x) { return __builtin_shufflevector(x, x, 4, 5, 6, 7); }
/// The first six of x, then zeros.
[[nodiscard, gnu::always_inline]] inline Lanes8f load_six(const float* x) {
#ifdef __AVX512VL__
  return _mm256_maskz_loadu_ps(0x3f, x);
#else
  return Lanes8f{x[0], x[1], x[2], x[3], x[4], x[5], 0, 0};
#endif
}
/// In double.
[[nodiscard, gnu::always_inline]] inline Lanes8 widened(const Lanes8f& x) {
  return joined(__builtin_convertvector(lower(x), Lanes4), __builtin_convertvector(upper(x), Lanes4));
}

/// Rounded to float.
[[nodiscard, gnu::always_inline]] inline Lanes8f narrowed(const Lanes8& x) {
  const Lanes4f l = __builtin_convertvector(lower(x), Lanes4f), u = __builtin_convertvector(upper(x), Lanes4f);
  return __builtin_shufflevector(l, u, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// The sum of the lanes.
[[nodiscard, gnu::always_inline]] inline double total(const Lanes8& x) {
  const Lanes4 four = lower(x) + upper(x);
  const auto two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}
[[nodiscard, gnu::always_inline]] inline float total(const Lanes8f& x) {
  const Lanes4f four = lower(x) + upper(x);
  return (four[0] + four[2]) + (four[1] + four[3]);
}

/// Rows for columns.
[[gnu::always_inline]] inline void transpose_four(Lanes4 (&r)[4]) {
  const Lanes4 even01 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), odd01 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const Lanes4 even23 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), odd23 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

/// Rows for columns, six by six; the last two lanes of the result are zero.
[[gnu::always_inline]] inline void transpose_six(Lanes8 (&r)[6]) {
  Lanes4 a[4], b[4], c[4], d[4];  // rows 0…3 and 4…5, entries 0…3 and 4…5
  for (int k = 0; k < 4; ++k) {
    a[k] = lower(r[k]);
    b[k] = upper(r[k]);
    c[k] = k < 2 ? lower(r[4 + k]) : Lanes4{};
    d[k] = k < 2 ? upper(r[4 + k]) : Lanes4{};
  }
  transpose_four(a);
  transpose_four(b);
  transpose_four(c);
  transpose_four(d);
  for (int k = 0; k < 4; ++k) r[k] = joined(a[k], c[k]);
  for (int k = 0; k < 2; ++k) r[4 + k] = joined(b[k], d[k]);
}

}  // namespace delassus
