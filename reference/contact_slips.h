// Directions in which two to four contacts slip at once: all of them, by branch and prune in interval arithmetic.
//
//   S_ij = A_ninj − μ_j A_nitj d_j,   S λ_n = −b_n by Cramer's rule: λ_n,j = N_j / D, nothing is divided
//   d_i × (A_tn λ_n − μ A_tt d λ_n + b_t)_i D = 0,   N_j D > 0,   d_i · (…)_i D > 0
// with d = ± ((1 − t²), 2t)/(1 + t²), t ∈ [−1, 1]. A box is dropped where one of these cannot hold in it, and else halved; Krawczyk's
// operator certifies that a box holds exactly one root and makes it narrow. What stays narrower than 2⁻²⁰ without an answer is returned as such.
// Cost     some thousand boxes for two, more for three and four; at most `max_boxes`.
// Source   R. Krawczyk 1969; R. Moore, R. Kearfott, M. Cloud 2009.
#pragma once

#include <vector>

#include "algorithms/kit/exact.h"
#include "algorithms/kit/spatial.h"

namespace delassus::reference {

struct SlipBox {
  bool certified = false;   ///< exactly one root, and the inequalities hold in all of it
  double width = 0;         ///< of the box in t
  VectorX<double> lambda;   ///< in its middle: normal and two tangents of each contact
};

inline constexpr int max_slip_boxes = 100000;

/// A (3k × 3k) and b of the k contacts alone, k = 2 … 4; rows normal, tangent, tangent.
[[nodiscard]] std::vector<SlipBox> contact_slips(const MatrixX<Rational>& A, const VectorX<Rational>& b, const std::vector<double>& mu);

}  // namespace delassus::reference
