#include "simulation/solvers.h"

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "simulation/solvers/admm.h"
#include "simulation/solvers/direct.h"
#include "simulation/solvers/newton_convex.h"
#include "simulation/solvers/per_contact.h"
#include "simulation/solvers/pgs.h"
#include "simulation/solvers/projected_gradient.h"
#include "simulation/solvers/proximal.h"

namespace delassus::simulation {
namespace {

template <template <class> class S> std::unique_ptr<ContactSolver<double>> make() { return std::make_unique<S<double>>(); }

}  // namespace

const std::vector<SolverRow>& solvers() {
  static const std::vector<SolverRow> table = {
      {.name = "direct", .summary = "equality rows by one solve of the ladder", .equations = "(G + R⁻¹) λ = target − g",
       .certificate = "natural residual", .source = "paper, equations 2–5", .cost = "O(n + m) with local loops, no iteration",
       .half_lines = false, .boxes = false, .relaxed = false, .exact = false, .hard_rows = true, .given_matrix = true, .make = make<Direct>},
      {.name = "newton_convex", .summary = "Newton on the motion, lcaba's factor as its Hessian, line search",
       .equations = "(M + JᵀHJ) d = Jᵀλ − M w", .certificate = "duality gap, natural residual",
       .source = "Todorov 2014; Castro, Permenter, Han 2022", .cost = "O(n + m) an iteration with local loops",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = false, .hard_rows = false, .given_matrix = false, .make = make<NewtonConvex>},
      {.name = "proximal", .summary = "hard and redundant rows by proximal points, Newton inside; exact Coulomb by steps of Newton on Γ",
       .equations = "the same from λ with R⁻¹ + E and b = u + Γ e_n − (R⁻¹ + E) λ", .certificate = "natural residual",
       .source = "Rockafellar 1976; Acary, Cadoux 2013", .cost = "O(n + m) an iteration with local loops",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = true, .hard_rows = true, .given_matrix = false, .make = make<ProximalNewton>},
      {.name = "admm", .summary = "alternating directions between the damped inverse and the cones, spectral ρ",
       .equations = "x = (A + P)⁻¹(P z − y − b − Γ e_n), z = Π(x + P⁻¹y)", .certificate = "natural residual",
       .source = "Carpentier, Le Lidec, Montaut 2024", .cost = "O(n + m) an iteration with local loops",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = true, .hard_rows = true, .given_matrix = true, .make = make<Admm>},
      {.name = "pgs", .summary = "projected Gauss–Seidel, cone after cone", .equations = "λ_c ← Π(λ_c − (u_c + Γ e_n)/γ_c)",
       .certificate = "natural residual", .source = "Moreau 1988; Jourdan, Alart, Jean 1998", .cost = "O(m²) a sweep",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = true, .hard_rows = true, .given_matrix = true, .make = make<Pgs>},
      {.name = "per_contact", .summary = "Gauss–Seidel, every contact solved exactly by bisection", .equations = "u_n = 0, d × u_t = 0, λ_t = −μ λ_n d",
       .certificate = "natural residual", .source = "Hwangbo, Lee, Hutter 2018", .cost = "O(m²) a sweep",
       .half_lines = true, .boxes = true, .relaxed = false, .exact = true, .hard_rows = true, .given_matrix = true, .make = make<PerContact>},
      {.name = "apgd", .summary = "accelerated projected gradients", .equations = "λ⁺ = Π(y − ∇f(y)/L), y = λ⁺ + β (λ⁺ − λ)",
       .certificate = "natural residual", .source = "Mazhar, Heyn, Negrut, Tasora 2015", .cost = "O(n + m) an iteration",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = false, .hard_rows = true, .given_matrix = true, .make = make<Apgd>},
      {.name = "ccp", .summary = "projected gradients with a fixed step", .equations = "λ ← Π(λ − ω (Aλ + b)/γ)",
       .certificate = "natural residual", .source = "Tasora, Anitescu 2011", .cost = "O(n + m) an iteration",
       .half_lines = true, .boxes = true, .relaxed = true, .exact = false, .hard_rows = true, .given_matrix = true, .make = make<Ccp>},
  };
  return table;
}

const SolverRow& find_solver(std::string_view wanted) {
  for (const SolverRow& row : solvers())
    if (row.name == wanted) return row;
  throw ModelError("", "solver", "there is no solver " + in_quotes(wanted), accepted_names(wanted, solvers()) + "; see `delassus list solvers`");
}

}  // namespace delassus::simulation
