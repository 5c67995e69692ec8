// The sums over pairs of rows of which J M⁻¹Jᵀ is made, each pair once.
//
// What     F(r, s) or F(s, r), whichever comes, += Σ_c x_rc d_c y_sc; `finish` adds the two up in the lower triangle.
// How      four columns of F at a time in a panel (thin_product.h), which is added run by run: rows of a list that follow each other
//          (RowRun) are neighbours in F too.
// Cost     2 operations per pair and column of x, 1 per pair; m² to finish.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "algorithms/kit/thin_product.h"

namespace delassus {

/// Entries from `entry` on are the rows from `row` on.
struct RowRun {
  int entry, row, count;
};
using RowRuns = std::span<const RowRun>;

/// Appends the runs of rows that stand in places first … of a list. Place k holds row(k).
template <class Row> void append_runs(std::vector<RowRun>& runs, int first, int count, Row&& row) {
  for (int k = 0; k < count; ++k) {
    if (k == 0 || row(k) != row(k - 1) + 1) runs.push_back({first + k, row(k), 0});
    ++runs.back().count;
  }
}

template <class T> class PairSums {
 public:
  /// Numbers of rows: entry e of column c stands at x[c · stride + e]; seven more may be read behind the last. `runs` count their
  /// entries from x on.
  struct Side {
    const T* x;
    Index stride;
    RowRuns runs;
    int first, count;  // entries
  };

  /// At most so many rows and columns of x.
  void analyze(Index rows, Index columns) {
    own_.assign(static_cast<std::size_t>(rows), T(0));
    panel_.assign(static_cast<std::size_t>(width * rows), T(0));
    y_.assign(static_cast<std::size_t>(width * columns), T(0));
  }
  /// F: zeros, m × m, until `finish`.
  void start(MatrixX<T>& F) {
    F_ = &F;
    std::fill(own_.begin(), own_.end(), T(0));
  }
  /// The pair of two rows, which may be the same one.
  void add(int r, int s, const T& value) { (*F_)(r, s) += value; }
  void add_own(int r, const T& value) { own_[r] += value; }
  /// The pairs of `row`, whose n numbers are z, with all of a side.
  void add(const Side& side, const T* z, int n, int row) {
    T* const column = F_->data() + row * F_->rows();
    for (const RowRun& run : side.runs) {
      const int begin = std::max(side.first, run.entry), count = std::min(side.first + side.count, run.entry + run.count) - begin;
      if (count <= 0) continue;
      Eigen::Map<VectorX<T>> of(column + run.row + begin - run.entry, count);
      for (int c = 0; c < n; ++c) of += Eigen::Map<const VectorX<T>>(side.x + c * side.stride + begin, count) * z[c];
    }
  }
  /// Pairs of all rows of `left` with all of `right`; d = nullptr: 1.
  void add_pairs(const Side& left, const Side& right, const T* d, int columns) {
    if (left.count == 0) return;
    for (int e = 0; e < right.count; e += width) {
      const int some = std::min(width, right.count - e);
      take(right, right.first + e, some, d, columns);
      multiply(left.x + left.first, left.stride, left.count, some, columns);
      for_rows(right, right.first + e, some, [&](int l, int row) { add_panel(left, left.first, left.count, l, row); });
    }
  }
  /// Pairs of the rows of one side, and each with itself. `right`: the same entries with other numbers.
  void add_own_pairs(const Side& side, const Side& right, const T* d, int columns) {
    for (int e = 0; e < side.count; e += width) {
      const int some = std::min(width, side.count - e), rows = side.count - e;
      take(right, side.first + e, some, d, columns);
      multiply(side.x + side.first + e, side.stride, rows, some, columns);
      for_rows(side, side.first + e, some, [&](int l, int row) {
        own_[row] += panel_[l * rows + l];
        add_panel(side, side.first + e, rows, l, row, l + 1);
      });
    }
  }
  /// The lower triangle; the upper one holds what is left.
  void finish() {
    MatrixX<T>& F = *F_;
    for (Index c = 0; c < F.cols(); ++c) {
      F(c, c) += F(c, c) + own_[c];
      for (Index r = c + 1; r < F.rows(); ++r) F(r, c) += F(c, r);
    }
  }
  [[nodiscard]] Index bytes() const { return static_cast<Index>((own_.size() + panel_.size() + y_.size()) * sizeof(T)); }

 private:
  static constexpr int width = std::is_same_v<T, double> ? 4 : 1;

  // y ← d x of `some` entries
  void take(const Side& side, int first, int some, const T* d, int columns) {
    for (int c = 0; c < columns; ++c)
      for (int l = 0; l < some; ++l) y_[c * some + l] = d == nullptr ? side.x[c * side.stride + first + l] : T(side.x[c * side.stride + first + l] * d[c]);
  }
  void multiply(const T* x, Index stride, int rows, int some, int columns) {
    std::fill_n(panel_.begin(), some * rows, T(0));
    add_thin_product(panel_.data(), Index(rows), x, stride, Index(rows), y_.data(), Index(some), Index(columns));
  }
  /// use(l, row) of the l-th of `some` entries from `first` on.
  template <class Use> static void for_rows(const Side& side, int first, int some, Use&& use) {
    for (const RowRun& run : side.runs)
      for (int k = std::max(first, run.entry); k < std::min(first + some, run.entry + run.count); ++k) use(k - first, run.row + k - run.entry);
  }
  /// F of column `row` += column l of the panel, whose entries begin at `first`, from its place `from` on.
  void add_panel(const Side& side, int first, int rows, int l, int row, int from = 0) {
    T* const column = F_->data() + row * F_->rows();
    const T* const panel = panel_.data() + l * rows;
    for (const RowRun& run : side.runs) {
      const int begin = std::max(first + from, run.entry), end = std::min(first + rows, run.entry + run.count);
      for (int k = begin; k < end; ++k) column[run.row + k - run.entry] += panel[k - first];
    }
  }

  MatrixX<T>* F_ = nullptr;
  std::vector<T> own_;           // of a row with itself
  std::vector<T> panel_, y_;     // scratch
};

}  // namespace delassus
