// The symbolic phase of the square-root elimination: which rows meet in which front, and the room they need.
//
// What     Front i (step i of a Plan) has the block columns a_i, then a_b for b in Q_i, and these rows, in this order:
//          rows on the joint, link constraints whose first eliminated body is i, rows handed on by earlier fronts, and
//          the own rows (inertia, at most 6, and armature, at most n_i). n_i rows stay; the others are handed on to the
//          members of Q_i in turn: all of them once they are at most `handed_limit`, six before.
//          Counts of rows are the largest possible: numbers decide how many inertia and armature rows are not zero.
// Cost     O(rows handed on), once.
#pragma once

#include "algorithms/elimination.h"

namespace delassus {

struct FrontPlan {
  static constexpr int handed_limit = 18;  ///< at least 6; more: fewer, longer reflections (18 measured fastest)

  struct Front {
    int capacity, dofs, members;   ///< most rows; n_i; |Q_i|
    int first_member;              ///< in the plan's members
    int parent_block;              ///< block of the parent, 0 for a root
    int joint_rows;                ///< how many of the first rows are on the joint
    int first_constraint, constraints;
    int first_given, given;        ///< in `given`
    int reflections;               ///< at most
    Index stride;                  ///< of vectors with one number per row: capacity, a multiple of eight
    Index row, v, c;               ///< offsets: of its rows; of reflections × stride numbers; of |Q_i| × n_i
  };
  struct Constraint {
    Index id;                      ///< link constraints first, then joint constraints
    Index row, rows;               ///< rows of J
    int first_link, links;         ///< in `links`; none: on the joint
    Index first_joint_row;         ///< of the rows on joints, in this order
  };
  struct Link {
    int block;                     ///< 0: a_i, 1 + k: member k
    Index first;                   ///< row of Problem::K
  };
  /// Rows that a front hands on to one member of its Q: its rows from `row` on, in the blocks from that member's on.
  struct Handed {
    int source, row, capacity, blocks;
    Index first;                   ///< offset of capacity × blocks
    int first_block;               ///< in `handed_block`: the block of the receiving front for each of them
  };

  std::vector<Front> fronts;
  std::vector<Constraint> constraints;
  std::vector<Link> links;
  std::vector<int> given;          ///< per front the handed rows it receives
  std::vector<Handed> handed;      ///< per member of the plan; capacity 0: nothing
  std::vector<int> handed_block;
  Index rows = 0, v = 0, c = 0, handed_size = 0, joint_rows = 0;  ///< totals of the offsets
  Index largest = 0, tallest = 0;  ///< blocks × rows of the largest front; rows of the tallest

  [[nodiscard]] Index bytes() const;
};

[[nodiscard]] FrontPlan make_front_plan(const Structure& structure, const Plan& plan);

}  // namespace delassus
