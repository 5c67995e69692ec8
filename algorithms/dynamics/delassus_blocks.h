// Chosen blocks of the Delassus matrix, and its diagonal, exactly and without the rest.
//
// What     (J M⁻¹Jᵀ)_ef for two constraints e, f: what block Jacobi, projected Gauss–Seidel and scalings ask for. R⁻¹ is not in it.
// Formula  with the factor of M, joint by joint in the basis in which D is diagonal, W = H S,
//            outwards, the mobility of body i (its inverse inertia as seen from outside):
//              Ω_i = S D⁻¹ Sᵀ + Pᵀ Ω_π P,   P = 1 − W D⁻¹ Sᵀ
//            inwards, with κ the rows of e and f as forces on the bodies that they have reached (κ = K to begin with):
//              G = κ S + 𝒦,   block += G_e D⁻¹ G_fᵀ,   κ_π += κ − G D⁻¹ Wᵀ
//            until all of them have come to one body i:   block += κ_e Ω_i κ_fᵀ.
// How      The body farthest from the roots goes first, so a body is passed when everything below it has arrived; rows at a root end.
//          A row with one body needs no step at all.
// Cost     update that of the factor, where none is given, and about 300 operations per degree of freedom; a block 80 per row and 6 m_e m_f, and 24 per row and degree of
//          freedom between its bodies and the one where they meet (or the roots). Diagonal: O(m + Σ of these ways).
// Error    within the data's sensitivity, as aba_sweep.
// Source   K. Kreutz-Delgado, A. Jain, G. Rodriguez 1992 (recursive formulation of operational space control); K.-S. Chang, O. Khatib
//          2000 (extended force propagator), for loops: this file.
#pragma once

#include <memory>

#include "algorithms/dynamics/tree_operators.h"

namespace delassus {

/// Serves every scalar. Threads: one each. Nothing allocates after the first update but what comes back.
template <class T> class DelassusBlocks {
 public:
  /// @throws ModelError for a bad structure.
  explicit DelassusBlocks(std::shared_ptr<const Structure> structure);
  DelassusBlocks(DelassusBlocks&&) noexcept;
  ~DelassusBlocks();

  /// Numbers at a configuration. Report: lost_pivot with the joint's first degree of freedom where M is singular.
  [[nodiscard]] Report update(const Problem<T>& problem);
  /// Likewise, with the factor of M that is there; it must live, and keep its numbers, until the last call.
  [[nodiscard]] Report update(TreeOperators<T>& tree);

  /// d_r = (J M⁻¹Jᵀ)_rr. Shape m. Report: as that of update; NaN where it is not ok.
  [[nodiscard]] Report diagonal(VectorX<T>& d);
  /// (J M⁻¹Jᵀ)_ef of the rows of constraint e and the columns of f, counted as in the structure: link constraints first, then
  /// joint constraints. Shape m_e × m_f. @throws std::logic_error where there is no such constraint, or before the first update.
  [[nodiscard]] Report block(Index e, Index f, MatrixX<T>& out);

 private:
  struct Numbers;
  std::unique_ptr<Numbers> own_;
};

}  // namespace delassus
