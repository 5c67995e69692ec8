// Contact problems to judge solvers by: piles of free bodies with as many contacts as wanted, and chains on the ground.
#pragma once

#include <cstdint>

#include "simulation/contact_problem.h"

namespace delassus {

struct PileSpec {
  Index bodies = 4;
  Index contacts = 6;            ///< 3 n_c / n = contacts / (2 bodies); with joints 3 contacts / (bodies + 5)
  Index distinct = 0;            ///< contacts beyond so many repeat the earlier ones, whose rows they depend on; 0: none repeats
  double friction = 0.5;         ///< coefficients between half of it and it
  double damping = 0;            ///< R⁻¹ over the mean diagonal of G; 0: hard
  bool joints = false;           ///< chains of revolute joints in the place of free bodies
  int mass_decades = 0;          ///< masses between 1 and 10^this
  simulation::FrictionLaw law = simulation::FrictionLaw::exact;
  std::uint64_t seed = 0;
};

/// g = J v_f, so that u = 0 is possible and a solution exists (V. Acary, F. Cadoux 2013). Every contact is one constraint of three
/// rows, beside the ground or between two bodies.
[[nodiscard]] simulation::ContactProblem<double> pile(const PileSpec& spec);

/// The same as a given matrix G, symmetric to the last bit.
[[nodiscard]] simulation::ContactProblem<double> as_matrix(const simulation::ContactProblem<double>& p);

}  // namespace delassus
