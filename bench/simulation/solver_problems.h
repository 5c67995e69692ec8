// Contact problems that solvers are profiled on: generated ones that sweep the contact density 3 n_c / n and the rank of G, and files.
#pragma once

#include <string>
#include <vector>

#include "simulation/contact_problem.h"

namespace delassus::bench {

struct SolverProblem {
  std::string set;     ///< what is asked of generated ones: equality, relaxed, exact; elsewhere: files
  std::string name;
  simulation::ContactProblem<double> problem;
  double density = 0;  ///< 3 n_c / n; NaN: a given matrix does not say n
};

/// Densities of the sweep. 30 degrees of freedom hold each of them to the digit.
inline constexpr double densities[] = {0.3, 0.5, 1, 2, 3, 5, 10};

/// Per density, `seeds` of: free bodies and a chain, either with contacts of its own frames each and with every second one (of the chain three in
/// four) the repeat of another, so that the rank is halved (quartered) before the density does it; hard rows, and R⁻¹ = 1e-4 of G's mean diagonal;
/// asked for exact Coulomb and for its relaxation. Equality: the same rows, hard, all free. All have solutions (contact_families.h).
[[nodiscard]] std::vector<SolverProblem> generated_problems(int seeds);
/// All files *.dat of a folder in the format of problem_file.h, by name. @throws ModelError where one cannot be read, or there is none.
[[nodiscard]] std::vector<SolverProblem> problems_of(const std::string& folder);

}  // namespace delassus::bench
