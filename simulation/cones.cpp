#include "simulation/cones.h"

#include "algorithms/kit/quad.h"

namespace delassus::simulation {
namespace {

/// x_n − (1 − s) N(s), and its derivative N − (1 − s) N'.
template <class T> struct Secular {
  T value, slope, normal;
  Secular(const T* x, const T* mu, Index rows, const T& s) {
    using std::sqrt;
    T square(0), falling(0);
    for (Index k = 1; k < rows; ++k) {
      if (!(mu[k] > T(0))) continue;
      const T stiff = mu[k] * mu[k] + s, y = x[k] * mu[k] / stiff;
      square += y * y;
      falling += y * y / stiff;
    }
    normal = sqrt(square);
    value = x[0] - (T(1) - s) * normal;
    slope = normal + (T(1) - s) * falling / normal;
  }
};

template <class T> T unequal(const T* x, const T* mu, Index rows) {
  T low(0), high(1);
  for (int k = 0; k < 2000 && Secular<T>(x, mu, rows, high).value < T(0); ++k) {
    low = high;
    high = T(2) * high;
  }
  T s = low;
  for (int k = 0; k < 200; ++k) {
    const Secular<T> f(x, mu, rows, s);
    (f.value < T(0) ? low : high) = s;
    T next = s - f.value / f.slope;
    if (!(next > low && next < high)) next = low + (high - low) / T(2);
    if (next == s || !(low < next && next < high)) break;
    s = next;
  }
  return s;
}

template <class T> T boundary(T* x, const T* mu, Index rows) {
  using std::sqrt;
  T first(0), length(0);
  bool equal = true;
  for (Index k = 1; k < rows; ++k) {
    if (!(mu[k] > T(0))) continue;
    equal = equal && (first == T(0) || mu[k] == first);
    first = mu[k];
    length += x[k] * x[k];
  }
  length = sqrt(length);
  if (equal) {
    x[0] = (x[0] + first * length) / (T(1) + first * first);
    for (Index k = 1; k < rows; ++k) x[k] = mu[k] > T(0) ? x[k] * (first * x[0] / length) : T(0);
    return first * length / x[0] - first * first;
  }
  const T s = unequal(x, mu, rows);
  x[0] = Secular<T>(x, mu, rows, s).normal;
  for (Index k = 1; k < rows; ++k) x[k] = x[k] * (mu[k] * mu[k]) / (mu[k] * mu[k] + s);
  return s;
}

}  // namespace

template <class T> ConeProjection<T> ConeProjection<T>::project(T* x, const T* mu, Index rows) {
  using std::sqrt;
  T slope(0);
  for (Index k = 1; k < rows; ++k) {
    if (mu[k] > T(0)) slope += (x[k] / mu[k]) * (x[k] / mu[k]);
    else x[k] = T(0);
  }
  if (sqrt(slope) <= x[0]) return {Region::inside, T(0)};
  if (tangent_norm(x, mu, rows) <= -x[0]) {
    std::fill(x, x + rows, T(0));
    return {Region::apex, T(0)};
  }
  if (!(slope > T(0))) {  // no tangent, and x_n < 0 is above: NaN
    std::fill(x, x + rows, ScalarTraits<T>::nan());
    return {Region::apex, T(0)};
  }
  const T s = boundary(x, mu, rows);
  return x[0] == T(0) ? ConeProjection<T>{Region::apex, T(0)} : ConeProjection<T>{Region::boundary, s};  // between both, but for rounding
}

template <class T> void ConeProjection<T>::derivative(const T* lambda, const T* mu, Index rows, T* d) const {
  std::fill(d, d + rows * rows, T(0));
  if (region == Region::apex) return;
  T b[max_cone_rows], bw[max_cone_rows], q(0);
  for (Index k = 1; k < rows; ++k) {
    const T square = mu[k] * mu[k];
    b[k] = mu[k] > T(0) ? square / (square + s) : T(0);
    const T w = mu[k] > T(0) ? lambda[k] / square : T(0);
    bw[k] = b[k] * w;
    q += bw[k] * w;
    d[k * rows + k] = b[k];
  }
  if (region == Region::inside) {
    d[0] = T(1);
    return;
  }
  const T D = (T(1) - s) * q + lambda[0] * lambda[0];
  d[0] = q / D;
  for (Index j = 1; j < rows; ++j) {
    d[j] = d[j * rows] = lambda[0] * bw[j] / D;
    for (Index i = 1; i < rows; ++i) d[j * rows + i] -= (T(1) - s) * bw[i] * bw[j] / D;
  }
}

template struct ConeProjection<double>;
template struct ConeProjection<Quad>;

}  // namespace delassus::simulation
