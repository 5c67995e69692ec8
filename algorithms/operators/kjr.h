// kjr: the Delassus matrix in mobility form, every pair of bodies by itself.
//
// What     A₀ as mobility_form.h; A = A₀ + R⁻¹ as explicit.h.
// Formula  Ω_ij for each pair of bodies with rows, carried outwards body by body from their lowest common ancestor l:
//            X ← Ω_l;   X ← X P along the path to j;   X ← Pᵀ X along the path to i
// Singular M: lost_pivot at a joint's first degree of freedom; A as explicit.h.
// Cost     update: the factor of M, 330 n, and Ω, 300 n; 138 n_i per joint i on the path of each pair: O(n + m²d); m³/3.
// Workspace  for a pair that of the sweeps; a path.
// Error    apply componentwise: sums over paths of products that the entry's own sensitivity contains. solve normwise κ(A).
// Source   K. Kreutz-Delgado, A. Jain, G. Rodriguez, Recursive formulation of operational-space control, 1992; loops:
//          docs/paper_notes.md.
#pragma once

#include "algorithms/operators/mobility_form.h"

namespace delassus {

template <class T> class Kjr : public MobilityForm<T> {
 protected:
  void analyze_pairs() override { path_.assign(static_cast<std::size_t>(2 * this->plan_.active()), 0); }
  void add_pairs() override;
  [[nodiscard]] Index pair_bytes() const override { return static_cast<Index>(path_.size() * sizeof(int)); }

 private:
  void add_bodies(int i, int j);
  void add_joints_of(int site);
  void outwards(const int* begin, const int* end, SixBySix<T>& X) const;
  std::vector<int> path_;  // the steps from i in to l, and those from j, from the middle on
};

}  // namespace delassus
