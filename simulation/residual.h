// How far an answer is from solving a contact problem, in units: what ends every solver, and what it reports.
//
//   natural          r_c = γ_c ‖λ_c − Π(λ_c − ũ_c/γ_c)‖                         [m/s]   the one that ends
//   penetration      how far ũ is from K*: ‖(μ_i u_i)‖ − ũ_n, −u, |u|            [m/s]
//   cone             how far λ is from K                                         [N s]
//   complementarity  |λ·ũ|; box: |u| |λ − the bound that u asks for|              [J]
// ũ = u + Γ e_n for exact Coulomb, u otherwise; γ_c: mean diagonal of G + R⁻¹ over the rows of the cone, by which an impulse
// becomes the velocity that it gives its own contact. Each is the largest over the groups. reference/contact_residual.h says the same by
// other lines.
// Cost     O(m). Nothing allocates.
#pragma once

#include "simulation/cones.h"

namespace delassus::simulation {

struct Residuals {
  double natural = 0;          ///< [m/s]
  double penetration = 0;      ///< [m/s]
  double cone = 0;             ///< [N s]
  double complementarity = 0;  ///< [J]
  Index worst = -1;            ///< the group with the largest natural residual
};

/// Of λ with its u; diagonal: of G + R⁻¹. Shapes m. NaN in any of them is NaN in natural.
template <class T> [[nodiscard]] Residuals residuals(const ContactProblem<T>& p, const T* lambda, const T* u, const T* diagonal);

}  // namespace delassus::simulation
