// Coefficients of methods of Runge and Kutta: c_i = Σ a_ij is not needed, nothing depends on time.
//
//   classical           explicit, order 4                                                                 Kutta 1901
//   dormand_prince      explicit, order 5, with an answer of order 4 beside it                              Dormand, Prince 1980
//   implicit_midpoint   order 2: the method of Gauss with one stage. Symmetric: the step back is the step of −h, so that of
//                       reversible motions (integrable or nearly so) the energy swings in h² and does not drift. Quadratic
//                       invariants – the energy and |momentum| of a free top, the energy of masses on springs – are kept to
//                       what the iteration of the stage leaves. |R(z)| = 1 on the imaginary axis and R(∞) = −1: stiff springs
//                       neither grow nor vanish. Under rows the way back onto them (constrained.h) is not symmetric: energy drifts
//   sdirk4              order 4, five implicit stages of one γ = 1/4, with an answer of order 3 beside it. Its last stage is its
//                       end (stiffly accurate) and R(∞) = 0 (L-stable): what is stiff is gone after a step. No stage is an
//                       evaluation at the start, where a stiff spring that is not at its rest would give accelerations without
//                       bound; coupled stages (Gauss, Radau IIA) of order 4 and more ask for a factor of complex numbers, or of
//                       both at once, which the operators do not have                                      Hairer, Wanner 1996, IV.6
#pragma once

namespace delassus::simulation {

struct Tableau {
  int stages;
  double a[7][7];      ///< lower triangle; a_ii ≠ 0: the stage is implicit
  double b[7];
  double e[7];         ///< b − b̂; all zero: no pair
  int estimate;        ///< order of b̂; 0: no pair
  bool first_is_last;  ///< the last stage is the first of the next step
  [[nodiscard]] bool implicit() const { return a[stages - 1][stages - 1] != 0; }
};

[[nodiscard]] const Tableau& classical();
[[nodiscard]] const Tableau& dormand_prince();
[[nodiscard]] const Tableau& implicit_midpoint();
[[nodiscard]] const Tableau& sdirk4();

}  // namespace delassus::simulation
