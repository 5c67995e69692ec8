// The table of solvers: a row is tested, benchmarked, listed and documented.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "simulation/solver.h"

namespace delassus::simulation {

/// One row of the table of solvers. What exactly a row takes of one problem, its refusal() says.
struct SolverRow {
  std::string_view name, summary, equations, certificate, source, cost;
  bool half_lines, boxes;        ///< beside equality rows, which every solver takes
  bool relaxed, exact;           ///< Coulomb groups by the convex relaxation, exactly
  bool hard_rows;                ///< R⁻¹ = 0
  bool given_matrix;             ///< problems without a mechanism
  std::unique_ptr<ContactSolver<double>> (*make)();
};

[[nodiscard]] const std::vector<SolverRow>& solvers();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const SolverRow& find_solver(std::string_view name);

}  // namespace delassus::simulation
