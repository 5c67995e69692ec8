// A symmetric matrix by tiles of its lower triangle, and its square-root-free Cholesky factor: products and substitutions.
//
// What     A x;  A = L D Lᵀ, L unit lower triangular, in place of A;  x ← L⁻ᵀ D⁻¹ L⁻¹ x.
// How      Only tiles that can be other than zero, in A or in L (coupled_rows.h). 8 × 8 tiles where the scalar has lanes, single entries elsewhere; columns of tiles (panels) one behind the other. Of an
//          entry A_rs off the diagonal tiles both uses, y_r += A_rs x_s and y_s += A_rs x_r, are made while it is at hand, so that
//          memory is read once for two operations. Substitution takes a panel in the same way: L y = x by columns, Lᵀ x = y by rows.
//          Behind the last row is the identity.
// Cost     with l_s entries in column s of L: Σ l_s² for a factor (n³/3 where all couple), 4 Σ l_s (2 n²) per product and per solve,
//          Σ l_s numbers, which a product reads once and a solve twice.
// Error    normwise backward stable for positive definite A, in any order of the sums (Higham, Accuracy and Stability, theorem 10.3).
#pragma once

#include <vector>

#include "algorithms/factors/coupled_rows.h"
#include "algorithms/kit/columns.h"

namespace delassus {

/// A value of a tile's column: eight rows side by side where the scalar has lanes.
template <class T> struct TileColumnOf { using type = T; };
template <class T> requires has_lanes<T> struct TileColumnOf<T> { using type = Lanes<T>; };
template <class T> using TileColumn = typename TileColumnOf<T>::type;

template <class T> class SymmetricTiles {
 public:
  static constexpr Index width = has_lanes<T> ? lane_count : 1;
  using Column = TileColumn<T>;

  /// Allocates everything, for n rows; `tiles`: by units of `width` rows.
  void analyze(Index n, Fill tiles);
  void analyze(Index n) { analyze(n, full((n + width - 1) / width)); }
  /// Zeros in both triangles of an n × n matrix, where A can be other than zero.
  void clear(MatrixX<T>& matrix) const;
  /// A = the lower triangle of `lower` (n × n).
  void assign(const MatrixX<T>& lower);
  /// A_rs (and A_sr) += x, r ≥ s.
  void add(Index r, Index s, const T& x);
  /// Rows and columns of these become zero.
  void cut(const std::vector<Index>& rows);
  /// A = L D Lᵀ in place. Returns −1, or the first row whose pivot is not usable.
  [[nodiscard]] Index factor();

  /// x in whole tiles: n numbers, and zeros behind them. `padded(n)` scalars from a multiple of 64 bytes on, as are those below.
  void load(const T* from, T* x) const;
  /// The n numbers of y in whole tiles.
  void store(const T* y, T* to) const;
  /// y = A x of x in whole tiles.
  void multiply(const T* x, T* y) const;
  /// x ← A⁻¹ x after `factor`, in whole tiles.
  void solve(T* x) const;

  [[nodiscard]] Index bytes() const;

 private:
  [[nodiscard]] Index length() const { return panels() * width; }
  [[nodiscard]] Index panels() const { return static_cast<Index>(tiles_.first.size()) - 1; }
  [[nodiscard]] T* tile(Index t) { return values_.data() + t * width * width; }
  [[nodiscard]] const Column* columns(Index t) const { return reinterpret_cast<const Column*>(values_.data() + t * width * width); }
  [[nodiscard]] Column* columns(Index t) { return reinterpret_cast<Column*>(tile(t)); }
  [[nodiscard]] Index factor_diagonal(Index panel);
  void eliminate(Index panel);

  Index n_ = 0;
  Fill tiles_;                   // per panel
  VectorX<T> values_;            // per tile: width columns of width rows
  VectorX<T> pivots_;            // D
  VectorX<T> upper_;             // per panel: the diagonal tile of Lᵀ without its diagonal
  VectorX<T> scaled_;            // L D of one panel
  std::vector<char> cut_;        // per row
};

}  // namespace delassus
