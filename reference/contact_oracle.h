// All solutions of a small contact problem with exact Coulomb friction: one to four contacts, by their modes, in rational arithmetic.
//
//   open    λ = 0,  u_n ≥ 0
//   held    u = 0,  λ_n > 0, ‖λ_t‖ ≤ μ λ_n                            of equality rows and half lines likewise
//   slip    u_n = 0, λ_n > 0, λ_t = −μ λ_n d, u_t = s d, s > 0, ‖d‖ = 1
// A mode for each contact: what is held is eliminated (A_HH λ_H = −A_Hs λ_s − b_H, A = G + R⁻¹, b = g − target). Then
//   no slip               rational numbers
//   one tangent           slip to either side is linear too: every number of contacts
//   two tangents, one contact slips    with d = ((1 − t²), 2t)/(1 + t²), q(d) = A_nn − μ A_nt d, λ_n = −b_n/q:
//     −b_n (d × A_tn − μ d × A_tt d) + q (d × b_t) = 0       a quartic in t: all real roots isolated by Sturm's theorem, t = ∞ by itself;
//     each inequality is the sign of a polynomial at that root, exactly
//   two tangents, more contacts slip   contact_slips.h: branch and prune in intervals; a root is certified, or its box is undecided
// What is not decided is listed: modes whose held rows are dependent (then forces are not unique), degenerate directions, boxes.
// Cost     3 modes a contact, 81 for four. Source   P. Lötstedt 1982 (modes); D. Stewart 2000.
#pragma once

#include <string>
#include <vector>

#include "reference/polynomial.h"
#include "simulation/contact_problem.h"

namespace delassus::reference {

enum class ContactMode : std::uint8_t { open, held, slip };

struct ContactSolution {
  std::vector<ContactMode> modes;  ///< per group
  VectorX<double> lambda;          ///< within 1e-30 of the solution before it was rounded; of certified boxes within their width
  double width = 0;                ///< of the box, 0 where it is exact but for that
};

struct ContactSolutions {
  std::vector<ContactSolution> all;
  std::vector<std::string> undecided;  ///< modes and why; empty: `all` are all there are
  [[nodiscard]] bool complete() const { return undecided.empty(); }
};

/// Groups: free, half line, and Coulomb of one tangent or of two with equal coefficients. A group that is off has no impulse.
/// @throws std::logic_error for others, for the relaxed law, or for more than four Coulomb groups.
[[nodiscard]] ContactSolutions contact_solutions(const simulation::ContactProblem<double>& p);

}  // namespace delassus::reference
