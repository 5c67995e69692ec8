// ltl_kkt: the KKT system eliminated along the tree, rows along with their bodies.
//
// What     A = J M⁻¹ Jᵀ + R⁻¹ as what elimination leaves of  [M  −Jᵀ; J  R⁻¹]  behind the last degree of freedom.
// Formula  U D Uᵀ of the (n + m)-matrix, rows of J first: from the leaves, for each degree of freedom k
//            J_ri −= J_rk L_ki for i above k,    A_rs += J_rk J_sk / D_k    for the rows r, s that k reaches.
// Singular M: lost_pivot at a joint's first degree of freedom.
// How      The pattern is known: k reaches what is above it and the rows with a body below it (branch_rows.h), loops included, and
//          no step adds to it but among rows. L of M is that of branch_factor.h. A joint's degrees of freedom are one step of the
//          sum into A, which ltl_osim sums by pairs of rows.
// Cost     as ltl_osim: update O(n d² + m d² + m² d), only pairs of rows that meet.
// Workspace  n for a pair. Holds n d + m d + 3 m² numbers.
// Error    apply within the data's sensitivity, as ltl_osim; solve normwise κ(A).
// Source   J. Carpentier, R. Budhiraja, N. Mansard 2021, Proximal and sparse resolution of constrained dynamic equations (paper's [22]).
#pragma once

#include "algorithms/operators/ltl.h"

namespace delassus {

template <class T> class LtlKkt : public Ltl<T> {
 protected:
  void analyze_form() override;
  void form(const Problem<T>& problem, MatrixX<T>& A0) override;
  [[nodiscard]] Index form_bytes() const override;

 private:
  struct Reached {  // a group that a joint reaches, and the place of the joint's first degree of freedom there
    Index group, place;
  };
  std::vector<Index> first_reached_;  // per body + 1
  std::vector<Reached> reached_;      // ascending in rows
  std::vector<T> scaled_;             // J_·k / D_k of one joint and group
};

}  // namespace delassus
