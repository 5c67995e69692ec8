// The factor of A where rows are hard (R⁻¹ = 0), and which of them are independent.
//
// What     y_r = L⁻¹Jᵀe_r with M = L D Lᵀ, and e_r, the unit vector of a damped row, below it: A is the matrix of their
//          products in the metric diag(D⁻¹, R⁻¹). Modified Gram–Schmidt in this metric, without square roots: after k steps
//          y_r = Σ l_rk q_k + rest; the l_rk and the pivots d_k = ‖q_k‖² are a factor L D Lᵀ of A. Elimination of A would give
//          the same with the square of the error: a row that is off the others by an angle δ has a pivot of δ² there, lost
//          below √eps; here the angle itself is seen.
// Size     of a hard row: B_r = Σ_j b_rj² (M⁻¹)_jj, b_rj² = Σ |k_ω|²|s_ω|² + |k_v|²|s_v|² over the products K S that J_rj is
//          summed from. Errors of eps in K and S move y_r by eps √B_r, whatever is left of the sum. Norms of angular and of
//          linear parts: no rotation, no order of rows and no unit of length, mass or time changes d_k / B_r.
// Rank     hard rows come first, the one with the largest rest, relative to its size, next; it depends on those before when
//          that is not above (30 eps · steps)². Damped rows follow in their order; their pivot is at least R⁻¹_rr, whatever
//          rounding left of it, and in a dense block of R⁻¹ lost when not above 30 eps · steps of what it was.
// How      rows are compared by ‖rest‖² less l_rk² d_k with every step, summed anew before a row is taken that has lost six digits of it.
//          Rows stand side by side in lanes: no sum over lanes.
// Cost     half a sweep per row for Y, 4 n m per hard row and 4 (n + m) m per damped one. Memory 2 n m + 2 m².
// Source   Å. Björck, Solving linear least squares problems by Gram–Schmidt orthogonalization, BIT 7, 1967: the factor is
//          that of a matrix within eps of Y. ‖rest‖²: P. Businger, G. Golub, Numerische Mathematik 7, 1965.
#pragma once

#include "algorithms/factors/factor.h"
#include "algorithms/kit/columns.h"

namespace delassus {

template <class T> class HardRows {
 public:
  void analyze(const Structure& structure);
  /// Sizes; the columns of Y when next asked for. `M` is the factor of M, every joint active.
  void update(const Problem<T>& problem, const Factor<T>& M);
  /// Factors A of the rows; `kinds` says (m) which are hard (R⁻¹ = 0) or off (R⁻¹ = ∞), `damping` holds R⁻¹. order[0 … rank) are
  /// the rows in the order of their pivots, the hard ones first; those left out, and those that are off, follow. Returns the rank.
  /// `work` needs workspace(M).
  enum class Kind : std::uint8_t { damped, hard, off };
  Index factor(const std::vector<Kind>& kinds, const BlockDiagonal<T>& damping, const Factor<T>& M, Index* order, T* work);

  /// B_r.
  [[nodiscard]] const T& size(Index row) const { return sizes_[row]; }
  /// l_rk of any row for k < rank; d_k at the row of order[k].
  [[nodiscard]] const T& share(Index row, Index k) const { return shares_[k * panels_ * width + row]; }
  /// Column of J M⁻¹Jᵀ of a row, shape m; after factor.
  void column(Index row, T* out);
  [[nodiscard]] Index workspace(const Factor<T>& M) const { return width * (M.workspace() + structure_->rows); }
  [[nodiscard]] Index bytes() const;

 private:
  using V = std::conditional_t<has_lanes<T>, Lanes<T>, T>;  // rows side by side
  static constexpr Index width = columns_in<V>;
  void columns(const Factor<T>& M, T* work);
  void measure();
  T bring(const VectorX<T>& from, Index row);
  [[nodiscard]] Index largest();
  Index next_hard(Index k, T& pivot);
  void take(Index row, Index k, const T& pivot, const BlockDiagonal<T>& damping);
  Index take_damped(const BlockDiagonal<T>& damping, Index* order, Index k, Index left_out);

  const Structure* structure_ = nullptr;
  Index panels_ = 0, columns_ = 0;       // rows / width, rounded up; n
  std::vector<T> mobility_;              // n
  VectorX<T> sizes_;                     // panels V
  std::vector<T> angular_, linear_;      // per body: Σ |s_ω|² (M⁻¹)_jj and Σ |s_v|² (M⁻¹)_jj on its path
  std::vector<T> of_rows_;               // m: what is left of a unit vector, in the metric
  std::vector<SixBySix<T>> omega_;
  VectorX<T> weights_, row_, of_motion_; // n: D, a row, and it in the metric; zero up to their padded ends
  VectorX<T> Y_, rest_;                  // per panel n V: Y, what is left of it
  VectorX<T> shares_;                    // per step panels V
  VectorX<T> left_, measured_;           // panels V: ‖rest‖², and when it was summed
  VectorX<T> to_take_, relative_;        // panels V: 1 where a hard row is open, else 0; its ‖rest‖²/B_r
  MatrixX<T> ends_;                      // m × m: what is left of the unit vectors
  std::vector<char> open_;               // per row: 0 taken or off, 1 hard, 2 damped
  bool columns_are_current_ = false;
};

}  // namespace delassus
