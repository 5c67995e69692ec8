// Everything A = J M⁻¹ Jᵀ depends on, as plain numbers at one configuration.
//
// World axes, each tree about its own reference point (see kinematics.h), so that a robot kilometres from the origin
// loses no digit. K blocks act on single bodies, so trees with different reference points couple without transforms.
// No sine, no cosine, no joint type: every recursion on a Problem runs in exact arithmetic too.
#pragma once

#include <memory>
#include <vector>

#include "algorithms/errors/status.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

inline constexpr Index ground = -1;  ///< the parent of a root body; never a body of its own

/// What of a problem does not depend on the configuration: the tree, and which bodies each constraint touches.
struct Structure {
  /// One body of a link constraint e: its K_e^i are rows [first, first + m_e) of Problem::K.
  struct Attachment {
    Index body, first;
  };
  /// e ∈ E: Σ_i K_e^i a_i, on any number of distinct bodies (bodies fixed to the ground are left out).
  struct LinkConstraint {
    Index row, rows;  ///< rows [row, row + rows) of J
    std::vector<Attachment> links;
  };
  /// i ∈ J: 𝒦_i ν_i; 𝒦_i is rows × n_i, row-major, from Problem::joint_K[first].
  struct JointConstraint {
    Index row, rows, body, first;
  };

  std::vector<Index> parent;          ///< π(i) < i, or ground
  std::vector<Index> first_dof{0};    ///< N+1 entries; joint i has n_i = first_dof[i+1] − first_dof[i] ∈ 0…6
  std::vector<LinkConstraint> link_constraints;
  std::vector<JointConstraint> joint_constraints;
  Index rows = 0;                     ///< m; every row belongs to exactly one constraint

  [[nodiscard]] Index bodies() const { return static_cast<Index>(parent.size()); }
  [[nodiscard]] Index dofs() const { return first_dof.back(); }
  [[nodiscard]] Index dofs(Index i) const { return first_dof[i + 1] - first_dof[i]; }

  /// Appends a body; returns its index. @throws ModelError if the parent is no earlier body or n is not 0…6.
  Index add_body(Index parent_body, Index n);
  /// Appends `m` rows acting on `bodies`; fills `first` in order. Returns the constraint's index.
  Index add_link_constraint(Index m, const std::vector<Index>& bodies);
  /// Appends `m` rows 𝒦 on the joint of `body`. Returns the constraint's index.
  Index add_joint_constraint(Index m, Index body);
  /// @throws ModelError when an invariant above does not hold (duplicate body in a constraint, gap in the rows, …).
  void validate() const;

  Index K_rows = 0, joint_K_size = 0;  ///< sizes of Problem::K and Problem::joint_K
};

/// The numbers. Shapes: n = dofs, N = bodies, m = rows.
template <class T> struct Problem {
  std::shared_ptr<const Structure> structure;
  std::vector<Vector6<T>> S;       ///< n columns: joint i's motion subspace S_i is columns first_dof[i]…
  std::vector<T> armature;         ///< n, ≥ 0 [kg m² or kg]: added to the diagonal of M
  std::vector<Matrix6<T>> H;       ///< N spatial inertias, symmetric positive semidefinite
  std::vector<Vector6<T>> K;       ///< K_rows rows of the blocks K_e^i, each as a 6-vector
  std::vector<T> joint_K;          ///< entries of the blocks 𝒦_i, row-major

  Problem() = default;
  /// Zero numbers of the right sizes.
  explicit Problem(std::shared_ptr<const Structure> s);
  /// @throws std::logic_error when an array does not fit the structure.
  void check_sizes() const;
  /// The same numbers in another scalar (exact when U holds every T: double → Rational, Quad).
  template <class U> [[nodiscard]] Problem<U> cast() const;
};

/// R⁻¹: one non-negative number per row [1/kg], or symmetric positive semidefinite blocks over the rows of one
/// constraint. Zero means a hard constraint; ∞ switches a row off: λ_r = 0 exactly, as if the row were not there. So rows come
/// and go, up to the capacity that analyze saw, without a new plan.
template <class T> struct Damping {
  struct Block {
    Index row;              ///< first row; size from the matrix
    MatrixX<T> R_inverse;   ///< symmetric positive semidefinite
  };
  std::vector<T> diagonal;    ///< m entries; rows inside a block have 0 here, or ∞: then the rest of the block holds
  std::vector<Block> blocks;  ///< disjoint, in ascending order of rows

  [[nodiscard]] static Damping uniform(Index rows, const T& value) {
    return {std::vector<T>(static_cast<std::size_t>(rows), value), {}};
  }
  /// y = R⁻¹ x, 0 in rows that are off. Shapes: m.
  void multiply(const VectorX<T>& x, VectorX<T>& y) const;
  /// @throws std::logic_error when the sizes do not fit, or a block is not within the rows of one constraint. Cost: one pass
  /// over blocks and constraints where these are in the order of their rows.
  void check_sizes(const Structure& s) const;
  /// bad_damping at the first row that is negative, −∞ or NaN, is given twice (in a block and on the diagonal), or whose
  /// block is not symmetric or not positive semidefinite (beyond rounding, in arithmetic that rounds); ok. `scratch` needs the
  /// entries of the largest block. Cost O(m), and m_e³/3 per block of m_e rows.
  [[nodiscard]] Report judged(std::vector<T>& scratch) const;
  /// @throws ModelError for an entry that is negative or NaN, a block that is not symmetric or overlaps.
  void validate(const Structure& s) const;
  template <class U> [[nodiscard]] Damping<U> cast() const;
};

}  // namespace delassus
