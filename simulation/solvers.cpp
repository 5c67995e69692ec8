#include "simulation/solvers.h"

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "simulation/solvers/pgs.h"

namespace delassus::simulation {
namespace {

template <template <class> class S> std::unique_ptr<ContactSolver<double>> make() { return std::make_unique<S<double>>(); }

}  // namespace

const std::vector<SolverRow>& solvers() {
  static const std::vector<SolverRow> table = {
      {.name = "pgs", .summary = "projected Gauss–Seidel, cone after cone", .equations = "λ_c ← Π(λ_c − (u_c + Γ e_n)/γ_c)",
       .certificate = "natural residual", .source = "Moreau 1988; Jourdan, Alart, Jean 1998", .cost = "O(m²) a sweep",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = true, .hard_rows = true, .given_matrix = true, .make = make<Pgs>},
  };
  return table;
}

const SolverRow& find_solver(std::string_view wanted) {
  for (const SolverRow& row : solvers())
    if (row.name == wanted) return row;
  throw ModelError("", "solver", "there is no solver " + in_quotes(wanted), accepted_names(wanted, solvers()));
}

}  // namespace delassus::simulation
