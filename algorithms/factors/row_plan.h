// Which rows meet at which step of a factor, and where their forces go from there: the symbolic part of row_propagation.h.
//
// What     a slot is a force of one row on one body (κ_i, six numbers), moved in place from body to body. A node is a step where
//          something happens to it:
//            plain     all rows that arrive are added up row by row, leave their part of J M⁻¹Jᵀ at the joint, and go on to the
//                      members of Q_i; nodes that the same rows pass one after the other make a span, and leave their part together
//            meeting   a body whose joint is simple (plan.h): rows that come from different children, or act on the body itself,
//                      pass their part of all joints above to the sum at once, and go on together
// Whole    every step is plain. Contracted: those that are not simple are, and the bodies meet where rows act or branches join;
//          what lies between is passed at once.
// Cost     O(rows on each path), once.
#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/factors/pair_sums.h"
#include "algorithms/factors/plan.h"

namespace delassus {

enum class Tree : std::uint8_t { whole, contracted };

struct RowPlan {
  struct Entry {
    int row, slot;
  };
  struct List {
    int first_entry = 0, entries = 0, first_run = 0, runs = 0;  // runs count from the node's first entry
    bool here = false;                                          // of a group: they act on the body itself
  };
  struct Merge {
    int from, into;  // slots of one row
  };
  struct JointRow {
    int slot, entry;  // entry among those that leave a plain node
  };
  /// The G of nodes that the same rows pass: entries × columns.
  struct Span {
    int first_value = 0, first_column = 0, columns = 0;
  };
  struct Node {
    int step;
    bool plain;
    int span = -1, column = 0;  // of a plain node; its first column in it
    bool last = true;           // of its span
    int first_group, first_merge, first_joint_row, first_slot;  // up to those of the next one; first_slot: of members but π
    List leaving;
    int to = -1;          // a meeting node: the next node on the way in
    bool matrix = false;  // rows go there by one 6×6 for all
  };

  std::vector<Node> nodes;  // and one past the end
  std::vector<List> groups;
  std::vector<Entry> entries;
  std::vector<RowRun> runs;
  std::vector<Merge> merges;
  std::vector<JointRow> joint_rows;  // in the order of Factor::for_joint_rows
  std::vector<int> slots_of_members; // first of as many as leave, per member but π
  std::vector<Span> spans;
  int values = 0, columns = 0;       // of all spans
  int most_columns = 6;              // of a span
  int slots = 0;                     // the first ones are the rows of Problem::K
  int most_entries = 0;              // of a node

  [[nodiscard]] RowRuns of(const List& list) const { return RowRuns(runs).subspan(static_cast<std::size_t>(list.first_run), static_cast<std::size_t>(list.runs)); }
  [[nodiscard]] Index bytes() const;
};

[[nodiscard]] RowPlan make_row_plan(const Structure& structure, const Plan& plan, Tree tree);

}  // namespace delassus
