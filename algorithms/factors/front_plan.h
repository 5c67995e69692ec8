// The symbolic phase of the square-root elimination: which rows meet in which front, and the room they need.
//
// What     Front i (step i of a Plan) has the n_i columns μ_i of its joint, then blocks a_b for b in Q_i, and these rows, in
//          this order: rows on the joint, link constraints whose first eliminated body is i, rows handed on by earlier
//          fronts. The n_i rows of M of the joint (mass_root.h) come and go one by one; the others are handed on to the
//          members of Q_i: all to the first of them, or, where they are too many, six to each after a reduction.
// Cost     O(rows handed on), once.
#pragma once

#include "algorithms/factors/plan.h"

namespace delassus {

struct FrontPlan {
  static constexpr int surplus = 12;  ///< rows handed on beyond their columns; more: fewer, longer reflections

  struct Front {
    int rows, dofs, members;       ///< rows but those of M; n_i; |Q_i|
    int first_member;              ///< in the plan's members
    int parent_block;              ///< block of the parent (1 + k: member k), 0 for a root
    int joint_rows;                ///< how many of the first rows are on the joint
    int first_constraint, constraints;
    int first_given, given;        ///< in `given`
    Index stride;                  ///< of vectors with one number per row and one for a row of M, a multiple of eight
    Index row, v, c;               ///< offsets: of its rows; of reflections × stride numbers; of |Q_i| × n_i
    Index reflection;              ///< offset of its reflections
    int reflections;               ///< n_i, then six per reduced member; none without rows

    /// Where reflection k puts the row that it completes; it meets the rows up to there.
    [[nodiscard]] int last(int k) const { return k < dofs ? rows : rows - 1 - (k - dofs); }
  };
  struct Constraint {
    Index id;                      ///< link constraints first, then joint constraints
    Index row, rows;               ///< rows of J
    int first_link, links;         ///< in `links`; none: on the joint
    Index first_joint_row;         ///< of the rows on joints, in this order
  };
  struct Link {
    int block;                     ///< 0: a_i itself, 1 + k: member k
    Index first;                   ///< row of Problem::K
  };
  /// Rows that a front hands on to one member of its Q, in the blocks from that member's on.
  struct Handed {
    int source, row, rows, blocks; ///< they stand at its rows from `row` on
    bool reduced;                  ///< on that member's columns; rows before `row` are free of them
    Index first;                   ///< offset of rows × blocks
    int first_block;               ///< in `handed_block`: the block of the receiving front for each of them
  };

  std::vector<Front> fronts;
  std::vector<Constraint> constraints;
  std::vector<Link> links;
  std::vector<int> given;          ///< per front the handed rows it receives
  std::vector<Handed> handed;      ///< per member of the plan; rows 0: nothing
  std::vector<int> handed_block;
  Index rows = 0, reflections = 0, v = 0, c = 0, handed_size = 0, joint_rows = 0;  ///< totals of the offsets
  Index largest = 0;               ///< blocks × (rows + 1) of the largest front

  [[nodiscard]] Index bytes() const;
};

[[nodiscard]] FrontPlan make_front_plan(const Structure& structure, const Plan& plan);

}  // namespace delassus
