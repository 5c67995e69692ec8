// efp: the Delassus matrix in mobility form, one force after the other through the tree.
//
// What     A₀ as mobility_form.h; A = A₀ + R⁻¹ as explicit.h.
// Formula  for each row on each of its bodies j: inwards κ_π = P κ, outwards a_b = Ω_b κ_b on the path of j, a_b = Pᵀ a_π beside it,
//          a_b += S D⁻¹𝒦ᵀ at the joint of a joint row; A₀,rs = κ_r a_i of all other bodies i.
// Singular M: lost_pivot at a joint's first degree of freedom; A as explicit.h.
// Cost     update: the factor of M, 330 n, and Ω, 300 n; 66 to 89 n_i per row, its bodies, and joint i of their tree: O(n m + m²); m³/3.
// Workspace  for a pair that of the sweeps; 12 per active body.
// Error    apply componentwise: sums over paths of products that the entry's own sensitivity contains. solve normwise κ(A).
// Source   K.-S. Chang, O. Khatib, Efficient recursive algorithm for the operational space inertia matrix of branching mechanisms,
//          2001; loops: docs/paper_notes.md.
#pragma once

#include "algorithms/operators/mobility_form.h"

namespace delassus {

template <class T> class Efp : public MobilityForm<T> {
 protected:
  void analyze_pairs() override;
  void add_pairs() override;
  [[nodiscard]] Index pair_bytes() const override;

 private:
  struct OfTree {
    int root, first_step, first_site;  // up to those of the next one
  };
  /// Row `row`, force κ on body `start` (−1: none), motion `push` of all beyond joint `joint` (−1: none): pairs with sites of the
  /// tree before `end`.
  void add_row(const OfTree& tree, int row, int start, Six<T> kappa, int joint, const Six<T>& push, int end);

  std::vector<OfTree> trees_;           // and one past the end
  std::vector<int> steps_, sites_of_;   // tree by tree: its steps, descending; its sites, ascending
  std::vector<int> on_path_;            // per active step: the row that it was last on the path of
  std::vector<Six<T>> force_, motion_;  // per active step
  int count_ = 0;
};

}  // namespace delassus
