#include "algorithms/factors/symmetric_tiles.h"

#include <algorithm>
#include <utility>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/registers.h"

namespace delassus {

template <class T> void SymmetricTiles<T>::analyze(Index n, Fill tiles) {
  n_ = n;
  tiles_ = std::move(tiles);
  values_.setZero(static_cast<Index>(tiles_.row.size()) * width * width);
  pivots_.setZero(panels() * width);
  upper_.setZero(panels() * width * width);
  scaled_.setZero(panels() * width * width);
  cut_.assign(static_cast<std::size_t>(panels() * width), 0);
}

template <class T> void SymmetricTiles<T>::clear(MatrixX<T>& matrix) const {
  if (2 * static_cast<Index>(tiles_.row.size()) == panels() * (panels() + 1)) {
    matrix.setZero();
    return;
  }
  for (Index p = 0; p < panels(); ++p)
    for (Index t = tiles_.first[p]; t < tiles_.first[p + 1]; ++t) {
      const Index s = p * width, r = tiles_.row[t] * width, rows = std::min(width, n_ - r), columns = std::min(width, n_ - s);
      matrix.block(r, s, rows, columns).setZero();
      matrix.block(s, r, columns, rows).setZero();
    }
}

template <class T> void SymmetricTiles<T>::assign(const MatrixX<T>& lower) {
  for (Index p = 0; p < panels(); ++p) {
    const Index s = p * width, some = std::min(width, n_ - s);
    for (Index t = tiles_.first[p]; t < tiles_.first[p + 1]; ++t) {
      const Index r = tiles_.row[t] * width, rows = std::min(width, n_ - r);
      for (Index c = 0; c < some; ++c) {
        const T* const from = lower.data() + (s + c) * n_ + r;
        T* const to = tile(t) + c * width;
        if (t > tiles_.first[p]) std::copy(from, from + rows, to);
        else
          for (Index k = c; k < rows; ++k) to[k] = tile(t)[k * width + c] = from[k];
      }
    }
  }
}

template <class T> void SymmetricTiles<T>::add(Index r, Index s, const T& x) {
  const auto at = std::find(tiles_.row.begin() + tiles_.first[s / width], tiles_.row.begin() + tiles_.first[s / width + 1], r / width) - tiles_.row.begin();
  tile(at)[s % width * width + r % width] += x;
  if (r / width == s / width && r != s) tile(at)[r % width * width + s % width] += x;
}

template <class T> void SymmetricTiles<T>::cut(const std::vector<Index>& rows) {
  if (rows.empty()) return;
  std::fill(cut_.begin(), cut_.end(), char(0));
  for (const Index r : rows) cut_[r] = 1;
  for (Index p = 0; p < panels(); ++p)
    for (Index t = tiles_.first[p]; t < tiles_.first[p + 1]; ++t)
      for (Index c = 0; c < width; ++c)
        for (Index k = 0; k < width; ++k)
          if (cut_[p * width + c] || cut_[tiles_.row[t] * width + k]) tile(t)[c * width + k] = T(0);
}

template <class T> Index SymmetricTiles<T>::factor() {
  for (Index p = 0; p < panels(); ++p) {
    const Index lost = factor_diagonal(p);
    if (lost >= 0) return lost;
    eliminate(p);
  }
  return -1;
}

// A_pp = L D Lᵀ, and D = 1 behind the last row
template <class T> Index SymmetricTiles<T>::factor_diagonal(Index panel) {
  T* const a = tile(tiles_.first[panel]);
  Column* const column = columns(tiles_.first[panel]);
  T* const d = pivots_.data() + panel * width;
  const Index some = std::min(width, n_ - panel * width);
  std::fill(d + some, d + width, T(1));
  for (Index c = 0; c < some; ++c) {
    d[c] = a[c * width + c];
    if (!ScalarTraits<T>::usable_pivot(d[c])) return panel * width + c;
    if (c + 1 == width) break;
    const Column l = column[c] / d[c];
    for (Index j = c + 1; j < some; ++j) column[j] -= l * a[c * width + j];
    column[c] = l;
  }
  T* const u = upper_.data() + panel * width * width;
  for (Index c = 0; c < width; ++c)
    for (Index r = 0; r < width; ++r) {
      T& l = a[c * width + r];
      if (r <= c) l = T(0);
      u[r * width + c] = l;
    }
  return -1;
}

// Y_r = A_rp L_pp⁻ᵀ,  L_rp = Y_r D_p⁻¹,  A_rs −= Y_r L_spᵀ
template <class T> void SymmetricTiles<T>::eliminate(Index panel) {
  const Index begin = tiles_.first[panel] + 1, end = tiles_.first[panel + 1];
  const T *const diagonal = tile(begin - 1), *const d = pivots_.data() + panel * width;
  Column* const scaled = reinterpret_cast<Column*>(scaled_.data());
  for (Index t = begin; t < end; ++t) {
    Column *const a = columns(t), *const y = scaled + (t - begin) * width;
    for (Index c = 0; c < width; ++c) {
      Column x = a[c];
      for (Index j = 0; j < c; ++j) x -= y[j] * diagonal[j * width + c];
      y[c] = x;
      a[c] = x / d[c];
    }
  }
  for (Index s = begin; s < end; ++s) {
    const T* const l = tile(s);
    Index target = tiles_.first[tiles_.row[s]];
    for (Index t = s; t < end; ++t, ++target) {
      while (tiles_.row[target] != tiles_.row[t]) ++target;
      Column* const a = columns(target);
      const Column* const y = scaled + (t - begin) * width;
      constexpr int group = has_lanes<T> ? in_factor : 1;
      for (Index c = 0; c < width; c += group) {
        Column sum[group];
        unrolled<group>([&](auto k) { sum[k] = a[c + k]; });
        for (Index j = 0; j < width; ++j) {
          const Column of = y[j];
          unrolled<group>([&](auto k) { sum[k] -= of * l[j * width + c + k]; });
        }
        unrolled<group>([&](auto k) { a[c + k] = sum[k]; });
      }
    }
  }
}

template <class T> void SymmetricTiles<T>::load(const T* from, T* x) const {
  Index r = 0;
  if constexpr (has_lanes<T>) {
    for (; r + width <= n_; r += width) *reinterpret_cast<Column*>(x + r) = unaligned<Column>(from + r);
    if (r < n_) *reinterpret_cast<Column*>(x + r) = first_of<Column>(from + r, static_cast<int>(n_ - r));
  } else {
    for (; r < n_; ++r) x[r] = from[r];
  }
}

template <class T> void SymmetricTiles<T>::store(const T* y, T* to) const {
  Index r = 0;
  if constexpr (has_lanes<T>)
    for (; r + width <= n_; r += width) set_unaligned(to + r, *reinterpret_cast<const Column*>(y + r));
  for (; r < n_; ++r) to[r] = y[r];
}

// y_p = A_pp x_p;  then for every panel p  y_r += A_rp x_p,  y_p += A_rpᵀ x_r
template <class T> void SymmetricTiles<T>::multiply(const T* x, T* y) const {
  using P = Part<T>;
  for (Index p = 0; p < panels(); ++p) {
    const T* const own = x + p * width;
    const Column* const diagonal = columns(tiles_.first[p]);
    Column sum = diagonal[0] * own[0];
    unrolled<width - 1>([&](auto c) { sum += diagonal[c + 1] * own[c + 1]; });
    reinterpret_cast<Column*>(y)[p] = sum;
  }
  for (Index p = 0; p < panels(); ++p) {
    const Index begin = tiles_.first[p] + 1, end = tiles_.first[p + 1];
    const T* const own = x + p * width;
    if (begin == end) continue;
    for (Index c = 0; c < width; c += group<T>) {
      P factor[group<T>], rows[group<T>];
      unrolled<group<T>>([&](auto k) { factor[k] = spread<P>(own[c + k]), rows[k] = P{}; });
      for (Index t = begin; t < end; ++t) {
        const P* const a = reinterpret_cast<const P*>(values_.data() + (t * width + c) * width);
        const P* const there = reinterpret_cast<const P*>(x + tiles_.row[t] * width);
        P* const of = reinterpret_cast<P*>(y + tiles_.row[t] * width);
        unrolled<parts<T>>([&](auto h) {
          P in_rows = of[h];
          unrolled<group<T>>([&](auto k) { in_rows += a[k * parts<T> + h] * factor[k], rows[k] += a[k * parts<T> + h] * there[h]; });
          of[h] = in_rows;
        });
      }
      add_sums(y + p * width + c, rows);
    }
  }
}

template <class T> void SymmetricTiles<T>::solve(T* x) const {
  using P = Part<T>;
  Column* const in_tiles = reinterpret_cast<Column*>(x);
  const Column *const d = reinterpret_cast<const Column*>(pivots_.data()), *const upper = reinterpret_cast<const Column*>(upper_.data());
  for (Index p = 0; p < panels(); ++p) {  // L y = x:  x_r −= L_rp x_p
    const Index begin = tiles_.first[p] + 1, end = tiles_.first[p + 1];
    Column own = in_tiles[p];
    unrolled<width - 1>([&](auto c) { own -= columns(begin - 1)[c] * spread_row<c>(own); });
    in_tiles[p] = own;
    for (Index c = 0; c < width; c += group<T>) {
      P factor[group<T>];
      unrolled<group<T>>([&](auto k) { factor[k] = spread<P>(x[p * width + c + k]); });
      for (Index t = begin; t < end; ++t) {
        const P* const l = reinterpret_cast<const P*>(values_.data() + (t * width + c) * width);
        P* const of = reinterpret_cast<P*>(x + tiles_.row[t] * width);
        unrolled<parts<T>>([&](auto h) {
          P rest = of[h];
          unrolled<group<T>>([&](auto k) { rest -= l[k * parts<T> + h] * factor[k]; });
          of[h] = rest;
        });
      }
    }
  }
  for (Index p = panels(); p-- > 0;) {  // Lᵀ x = D⁻¹ y:  x_p −= L_rpᵀ x_r
    const Index begin = tiles_.first[p] + 1, end = tiles_.first[p + 1];
    alignas(Column) T across[width] = {};
    for (Index c = 0; c < width && begin < end; c += group<T>) {
      P rows[group<T>] = {};
      for (Index t = begin; t < end; ++t) {
        const P* const l = reinterpret_cast<const P*>(values_.data() + (t * width + c) * width);
        const P* const there = reinterpret_cast<const P*>(x + tiles_.row[t] * width);
        unrolled<parts<T>>([&](auto h) { unrolled<group<T>>([&](auto k) { rows[k] += l[k * parts<T> + h] * there[h]; }); });
      }
      add_sums(across + c, rows);
    }
    Column own = in_tiles[p] / d[p] - *reinterpret_cast<const Column*>(across);
    unrolled<width - 1>([&](auto k) { own -= upper[p * width + width - 1 - k] * spread_row<width - 1 - k>(own); });
    in_tiles[p] = own;
  }
}

template <class T> Index SymmetricTiles<T>::bytes() const {
  return static_cast<Index>(sizeof(T)) * (values_.size() + pivots_.size() + upper_.size() + scaled_.size()) +
         static_cast<Index>(sizeof(Index) * (tiles_.first.size() + tiles_.row.size()) + cut_.size());
}

#define DELASSUS_INSTANTIATE(T) template class SymmetricTiles<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
