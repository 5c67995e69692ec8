// The rows of J, and of J L⁻¹ for M = LᵀDL of a tree (branch_factor.h), at the degrees of freedom they can reach.
//
// What     The support of a row is the union of the ways from its bodies to their roots: closed under ancestors, whatever loops the
//          row closes. So  Y L = J  keeps it:  from the leaves,  Y_i −= Y_k L_ki  for i above k.
//          Rows that follow each other on the same bodies make a group: one support, their numbers side by side.
// Cost     per group of g rows and a support of s degrees of freedom: 12 g per link and degree of freedom above it for J, 2 g per
//          entry of L in the support for Y; products 2 g s. Memory g s.
// Source   R. Featherstone 2010 (Exploiting sparsity in operational-space dynamics), for one body per row; its extension to loops.
#pragma once

#include <vector>

#include "algorithms/factors/branch_factor.h"

namespace delassus {

template <class T> class BranchRows {
 public:
  struct Group {
    Index row, rows;     // of J
    Index first, count;  // its places: degrees of freedom, ascending
    Index values;        // of Y, rows × count, column by column
  };

  /// Both arguments must outlive this.
  void analyze(const Structure& structure, const BranchFactor<T>& factor);
  /// J.
  void assemble(const Problem<T>& problem);
  /// J ← J L⁻¹ at place p and above, of group g: the step of the elimination at its degree of freedom.
  void eliminate(const Group& g, Index p) {
    T* const y = column(g, p);
    const T* const l = factor_->row(dof(g, p));
    for (Index q = above(g, p), t = factor_->depth(dof(g, p)); q >= 0; q = above(g, q)) {
      T* const x = column(g, q);
      --t;
      for (Index r = 0; r < g.rows; ++r) x[r] -= y[r] * l[t];
    }
  }

  /// z += Yᵀ x, and x −= Y D⁻¹ z. Shapes n, m.
  void add_transposed(const T* x, T* z) const;
  void subtract_scaled(const T* z, T* x) const;

  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
  [[nodiscard]] Index dof(const Group& g, Index p) const { return dofs_[g.first + p]; }
  /// The place of the degree of freedom above that of p; −1 at a root.
  [[nodiscard]] Index above(const Group& g, Index p) const { return above_[g.first + p]; }
  [[nodiscard]] const T* column(const Group& g, Index p) const { return values_.data() + g.values + p * g.rows; }
  [[nodiscard]] T* column(const Group& g, Index p) { return values_.data() + g.values + p * g.rows; }
  [[nodiscard]] Index bytes() const;

 private:
  struct OnLink {  // K_e^i in the rows of its group from `offset` on
    Index group, offset, rows, first, place;
  };
  struct OnJoint {  // 𝒦_i
    Index group, offset, rows, first, place, dofs;
  };
  void find_support(Group& g, const std::vector<Index>& bodies);
  [[nodiscard]] Index place_of(const Group& g, Index dof) const;

  const BranchFactor<T>* factor_ = nullptr;
  std::vector<Group> groups_;
  std::vector<Index> dofs_, above_;  // per place
  std::vector<OnLink> on_links_;
  std::vector<OnJoint> on_joints_;
  std::vector<T> values_;
};

}  // namespace delassus
