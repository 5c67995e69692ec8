// The symbolic phase: in which order joints are eliminated, which 6×6 blocks fill in, and the integer plan the numeric
// sweeps follow. Depends on the structure only.
//
// What     A joint is eliminated before its parent, otherwise the one of minimum degree; many trees also by nested dissection, where
//          that is counted to be less work (elimination.h).
//          Joints whose subtree carries no row come first ("phase A"): their part of the factor does not depend on the
//          damping, and forces on the rows never visit them.
// Ground   is never a node: it has no acceleration, so it couples nothing.
// One order  serves M and M_R: children come before parents. Only couplings, and with them Q_i and runs, differ (mass_plan).
// Cost     O(N) where constraints couple no bodies, else O((N + fill) log N), once; a few allocations, one of them kept.
// Source   paper, Algorithm 4, lines 16–20 (neighbour sets) and the elimination order S^E.
#pragma once

#include <cstdint>
#include <span>

#include "algorithms/kit/slab.h"
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

  std::span<const int> body;           ///< step → body
  std::span<const int> step;           ///< body → step
  std::span<const int> parent;         ///< step → parent's step, −1 at roots
  std::span<const int> first_column;   ///< steps + 1: degrees of freedom in sweep order
  std::span<const int> first_member;   ///< steps + 1
  std::span<const Member> members;
  std::span<const int> first_w;        ///< steps + 1: per step |Q_i| × n_i columns W
  /// Per step the blocks of all pairs of Q_i, (0,1) (0,2) … (1,2) …; a block's columns belong to the earlier step.
  std::span<const int> first_pair;
  std::span<const int> pairs;
  std::span<const Run> runs;           ///< over all steps; none reaches from phase A into the active steps
  int first_active_run = 0;

  /// Initial couplings: for each link constraint the blocks of the pairs of its links, (0,1) (0,2) … (1,2) ….
  std::span<const int> first_constraint_pair;
  std::span<const int> constraint_pairs;

  /// Step i has no couplings, and a parent: the plain articulated-body step.
  [[nodiscard]] bool simple(int i) const {
    return first_member[i + 1] - first_member[i] == 1 && parent[i] >= 0 && members[first_member[i]].block < 0;
  }
  using Runs = std::span<const Run>;
  [[nodiscard]] Runs all_runs() const { return runs; }
  [[nodiscard]] Runs active_runs() const { return runs.subspan(static_cast<std::size_t>(first_active_run)); }
  [[nodiscard]] int active() const { return steps - first_active; }
  [[nodiscard]] int active_columns() const { return first_column[steps] - first_column[first_active]; }
  [[nodiscard]] Index bytes() const { return lists.bytes(); }

  Lists lists;  ///< where all of the above stand
};

/// Which joints are active: those with rows in their subtree, or every one.
enum class Branches : std::uint8_t { with_rows, all };
[[nodiscard]] Plan make_plan(const Structure& structure, Matrix matrix, Branches branches = Branches::with_rows);
/// The plan of M in the order of a plan of M_R: the same bodies, columns and phase A. Cost O(N).
[[nodiscard]] Plan mass_plan(const Structure& structure, const Plan& of_M_R);

}  // namespace delassus
