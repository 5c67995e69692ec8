// The symbolic phase: in which order joints are eliminated, which 6×6 blocks fill in, and the integer plan the numeric
// sweeps follow. Depends on the structure only.
//
// What     Minimum degree among the joints whose children are all gone (a joint must be eliminated before its parent),
//          ties: deepest first, then by number of degrees of freedom, so that equal steps stand together.
//          Joints whose subtree carries no row come first ("phase A"): their part of the factor does not depend on the
//          damping, and forces on the rows never visit them.
// Ground   is never a node: it has no acceleration, so it couples nothing.
// Cost     O((N + fill) log N), once.
// Source   paper, Algorithm 4, lines 16–20 (neighbour sets) and the elimination order S^E.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// Which matrix is factored: M couples a joint with its ancestors only, M_R = M + JᵀRJ also all links of a constraint.
enum class Matrix : std::uint8_t { M, M_R };

struct Plan {
  /// One of the nodes a step updates: Q_i = N_i ∪ {π(i)}, in ascending order of steps.
  struct Member {
    int step;   ///< eliminated later than i
    int block;  ///< the 6×6 block coupling i to it; −1 for a parent not coupled to i but by the joint
  };
  /// A run of equal consecutive steps: no test inside.
  struct Run {
    int begin, end, dofs;
    bool simple;  ///< no couplings, and a parent: the plain articulated-body step
    bool chain;   ///< of one degree of freedom, simple, and the parent of each but the last is the next one
  };

  Matrix matrix = Matrix::M;
  int steps = 0;         ///< N
  int first_active = 0;  ///< steps before it are phase A
  int blocks = 0;        ///< 6×6 off-diagonal blocks, fill included

  std::vector<int> body;           ///< step → body
  std::vector<int> step;           ///< body → step
  std::vector<int> parent;         ///< step → parent's step, −1 at roots
  std::vector<int> first_column;   ///< steps + 1: degrees of freedom in sweep order
  std::vector<int> first_member;   ///< steps + 1
  std::vector<Member> members;
  std::vector<int> first_w;        ///< steps + 1: per step |Q_i| × n_i columns W
  /// Per step the blocks of all pairs of Q_i, (0,1) (0,2) … (1,2) …; a block's columns belong to the earlier step.
  std::vector<int> first_pair;
  std::vector<int> pairs;
  std::vector<Run> runs;           ///< over all steps; none reaches from phase A into the active steps
  int first_active_run = 0;

  /// Initial couplings: for each link constraint the blocks of the pairs of its links, (0,1) (0,2) … (1,2) ….
  std::vector<int> first_constraint_pair;
  std::vector<int> constraint_pairs;

  /// Step i has no couplings, and a parent: the plain articulated-body step.
  [[nodiscard]] bool simple(int i) const {
    return first_member[i + 1] - first_member[i] == 1 && parent[i] >= 0 && members[first_member[i]].block < 0;
  }
  using Runs = std::span<const Run>;
  [[nodiscard]] Runs all_runs() const { return runs; }
  [[nodiscard]] Runs active_runs() const { return Runs(runs).subspan(static_cast<std::size_t>(first_active_run)); }
  [[nodiscard]] int active() const { return steps - first_active; }
  [[nodiscard]] int active_columns() const { return first_column[steps] - first_column[first_active]; }
  [[nodiscard]] Index bytes() const;
};

/// Which joints are active: those with rows in their subtree, or every one.
enum class Branches : std::uint8_t { with_rows, all };
[[nodiscard]] Plan make_plan(const Structure& structure, Matrix matrix, Branches branches = Branches::with_rows);

}  // namespace delassus
