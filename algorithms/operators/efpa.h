// efpa: the Delassus matrix in mobility form, forces carried across spans by propagators that all rows of a body share.
//
// What     A₀ as mobility_form.h; A = A₀ + R⁻¹ as explicit.h.
// Formula  P_{j→l} of every body j with rows to each of its ancestors l where another branch with rows joins, that has rows, or
//          whose joint has;  Z_jl = Ω_l P_{j→l};  Ω_ij = P_{i→l}ᵀ Z_jl, one product per pair of bodies
// Singular M: lost_pivot at a joint's first degree of freedom; A as explicit.h.
// Cost     update: the factor of M, 330 n, and Ω, 300 n; 138 n_i per body with rows and joint i between it and the root, 396 per
//          ancestor l, 396 per pair of bodies, 66 per row and 11 per pair of rows: O(n + m d + m²); m³/3.
// Memory   a 6×6 matrix per body with rows and ancestor l.
// Workspace  for a pair that of the sweeps.
// Error    apply componentwise: sums over paths of products that the entry's own sensitivity contains. solve normwise κ(A).
// Source   P. Wensing, R. Featherstone, D. Orin, A reduced-order recursive algorithm for the computation of the operational-space
//          inertia matrix, 2012; loops: docs/paper_notes.md.
#pragma once

#include "algorithms/operators/mobility_form.h"

namespace delassus {

template <class T> class Efpa : public MobilityForm<T> {
 protected:
  void analyze_pairs() override;
  void add_pairs() override;
  [[nodiscard]] Index pair_bytes() const override;

 private:
  struct Pair {
    int site, of_site, of_other;  // the earlier site; which of the ancestors of each is l
  };
  void propagate(int site);
  void add_bodies(int site);
  void add_joints_of(int site);

  std::vector<char> meeting_;           // per active step: an l
  std::vector<int> first_propagator_;   // per site; the first one is 1, at the body itself
  std::vector<int> at_;                 // per propagator: l
  std::vector<int> first_pair_;         // per site, as the later one
  std::vector<Pair> pairs_;
  std::vector<SixBySix<T>> propagators_, pushed_;  // P_{j→l}; Z of one site
};

}  // namespace delassus
