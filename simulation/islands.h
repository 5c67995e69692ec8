// Which trees of a mechanism move together, and what of a problem is theirs alone.
//
//   tree     a root body and all that hangs on it: bodies of two trees are coupled by rows, and by nothing else
//   loops    trees joined by rows that always hold
//   island   trees joined by these and by the contacts of a step: union–find
// A part is a mechanism of its own, its bodies, degrees of freedom and rows in the order of the whole. So its numbers, and every bit
// computed from them, are those it has where nothing else is there.
// Cost     O(N + m); a part that of its own bodies and rows, N log N in order, and a copy of their numbers.
#pragma once

#include <memory>
#include <vector>

#include "algorithms/problem/problem.h"
#include "simulation/cone_rows.h"

namespace delassus::simulation {

class Islands {
 public:
  explicit Islands(const Structure& structure);
  /// The islands of a step, from the loops and its contacts.
  template <class T> void join(const std::vector<RowSet<T>>& rows) {
    island_ = loops_;
    for (const RowSet<T>& s : rows)
      if (s.kind == RowSet<T>::Kind::contact && s.other != ground) unite(island_, tree_of(s.body), tree_of(s.other));
    flatten(island_);
  }

  /// Bodies of a tree, and rows that always hold, of the constraints whose first link is in it (of the world alone: tree 0): ascending.
  struct Own {
    std::vector<Index> bodies;
    struct Rows {
      Index row;
      bool link;          // of the structure's link constraints, else of those of joints
      std::size_t which;
    };
    std::vector<Rows> rows;
  };
  [[nodiscard]] const Own& of(Index tree) const { return own_[static_cast<std::size_t>(tree)]; }

  [[nodiscard]] Index trees() const { return static_cast<Index>(loops_.size()); }
  [[nodiscard]] Index tree_of(Index body) const { return tree_of_[static_cast<std::size_t>(body)]; }
  [[nodiscard]] Index root_of(Index tree) const { return root_of_[static_cast<std::size_t>(tree)]; }
  /// Per tree: the first tree of the island, or of the loops, that it is in.
  [[nodiscard]] const std::vector<Index>& islands() const { return island_; }
  [[nodiscard]] const std::vector<Index>& loops() const { return loops_; }
  /// Per row that always holds: a tree it acts on, −1 where there is none.
  [[nodiscard]] const std::vector<Index>& tree_of_row() const { return tree_of_row_; }

 private:
  static void unite(std::vector<Index>& first, Index a, Index b);
  static void flatten(std::vector<Index>& first);
  std::vector<Index> tree_of_, root_of_, loops_, island_, tree_of_row_;
  std::vector<Own> own_;
};

template <class T> class Part {
 public:
  /// Trees in ascending order that no row joins to others.
  Part(const Structure& whole, const Islands& islands, const std::vector<Index>& trees);

  std::vector<Index> bodies, dofs, rows;  ///< of the whole, ascending
  std::shared_ptr<const Structure> structure;
  Problem<T> problem;

  /// Its numbers, from those of the whole (which may have further rows behind those that always hold).
  void take(const Problem<T>& whole);
  [[nodiscard]] Index own(Index body) const;  ///< the body here
  /// Of the whole's damping, that of its rows.
  [[nodiscard]] Damping<double> damping(const Damping<double>& whole) const;
  void gather(const VectorX<T>& whole, VectorX<T>& own) const;   ///< n of the whole → its own
  void scatter(const VectorX<T>& own, VectorX<T>& whole) const;
  [[nodiscard]] Index bytes() const;

 private:
  struct Copied {
    Index to, from, size;
  };
  std::vector<Copied> K_, joint_K_;
};

}  // namespace delassus::simulation
