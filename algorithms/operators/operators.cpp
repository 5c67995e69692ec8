// The table of operators. A row added here is tested, benchmarked, listed and documented.
// Compiled twice: the library delassus makes operators in double and float; delassus_exact, which stands before it where it is
// linked and then provides the table, makes them in every scalar.
#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/aba_sweep.h"
#include "algorithms/operators/caba_osim.h"
#include "algorithms/operators/cg.h"
#include "algorithms/operators/dense_cholesky.h"
#include "algorithms/operators/explicit_columns.h"
#include "algorithms/operators/efp.h"
#include "algorithms/operators/efpa.h"
#include "algorithms/operators/kjr.h"
#include "algorithms/operators/kkt_elimination.h"
#include "algorithms/operators/ladder.h"
#include "algorithms/operators/lcaba.h"
#include "algorithms/operators/lcaba_qr.h"
#include "algorithms/operators/lcaba_refined.h"
#include "algorithms/operators/ltl_kkt.h"
#include "algorithms/operators/ltl_osim.h"
#include "algorithms/operators/maximal_direct.h"
#include "algorithms/operators/maximal_free.h"
#include "algorithms/operators/proximal.h"
#include "algorithms/operators/pv_osim.h"

namespace delassus {
namespace {

template <template <class> class Op, class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<Op<T>>(); }

using Makers = decltype(OperatorRow::makers);
#define DELASSUS_MAKER(T) std::get<Maker<T>>(all) = make<Op, T>;
template <template <class> class Op> constexpr Makers makers_with_roots() {
  Makers all{make<Op, double>, make<Op, float>, nullptr, nullptr, nullptr, nullptr};
  DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_MAKER)
  return all;
}
template <template <class> class Op> constexpr Makers ordered_makers() {
  Makers all = makers_with_roots<Op>();
  DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_MAKER)
  return all;
}
template <template <class> class Op> constexpr Makers makers() {
  Makers all = ordered_makers<Op>();
  DELASSUS_FOR_EACH_SCALAR(DELASSUS_MAKER)
  return all;
}
#undef DELASSUS_MAKER
/// Of an operator for double alone: where operations are counted, too.
template <template <class> class Op> constexpr Maker<Counted> counted() {
#ifdef DELASSUS_EXACT
  return make<Op, Counted>;
#else
  return nullptr;
#endif
}

}  // namespace

std::string_view name(ErrorClass e) {
  switch (e) {
    case ErrorClass::componentwise: return "componentwise";
    case ErrorClass::normwise: return "normwise";
    case ErrorClass::refined: return "refined";
    case ErrorClass::amplified: return "amplified";
  }
  return "unknown";
}

const std::vector<OperatorRow>& operators() {
  static const std::vector<OperatorRow> table = {
      {.name = "dense_cholesky", .summary = "explicit matrix, three dense steps",
       .formula = "A = (J L⁻ᵀ) D⁻¹ (J L⁻ᵀ)ᵀ + R⁻¹, M = L D Lᵀ", .source = "paper, section II",
       .cost = "O(n³ + n² m + n m² + m³)", .applies = true, .solves = true, .zero_damping = true,
       .terminates_exactly = true, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise,
       .holds = Holds::all_squared, .makers = makers<DenseCholesky>()},
      {.name = "explicit_columns", .summary = "explicit matrix, one pair of articulated-body sweeps per row",
       .formula = "A e_r, r = 1 … m", .source = "paper, Algorithms 1–3 merged (section IV-D)",
       .cost = "O(n + m (n + m) + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<ExplicitColumns>()},
      {.name = "ltl_osim", .summary = "explicit matrix by the branch sparsity of M, J and L",
       .formula = "A = Y D⁻¹ Yᵀ + R⁻¹, Y = J L⁻¹, M = Lᵀ D L", .source = "Featherstone 2010 (paper's [21]); loops: algorithms/factors/branch_rows.h",
       .cost = "O(n d² + m d² + m² d + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<LtlOsim>()},
      {.name = "ltl_kkt", .summary = "the KKT system eliminated along the tree, its pattern known",
       .formula = "[M −Jᵀ; J R⁻¹] = U D Uᵀ, rows first", .source = "Carpentier, Budhiraja, Mansard 2021 (paper's [22])",
       .cost = "O(n d² + m d² + m² d + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<LtlKkt>()},
      {.name = "pv_osim", .summary = "explicit matrix, every row carried inwards joint by joint",
       .formula = "A = Σ_i G_i D_i⁻¹ G_iᵀ + R⁻¹, κ_π += κ_i − G_i D_i⁻¹ U_iᵀ", .source = "Sathya et al. 2024; loops: algorithms/factors/row_propagation.h",
       .cost = "O(n + m² d + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<PvOsim>()},
      {.name = "pv_osimr", .summary = "the same on the tree contracted to branchings and loaded bodies",
       .formula = "A_rs = κ_r Ω_l κ_sᵀ where r and s meet", .source = "Sathya, Decré, Swevers 2024; loops: algorithms/factors/row_propagation.h",
       .cost = "O(n + m² + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::amplified, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<PvOsimR>()},
      {.name = "kjr", .summary = "explicit matrix, the mobility of every pair of bodies by itself",
       .formula = "A_rs = Σ K_r Ω_ij K_sᵀ, Ω_ij = P_{i→l}ᵀ Ω_l P_{j→l}", .source = "Kreutz-Delgado, Jain and Rodriguez 1992; loops: algorithms/operators/mobility_form.h",
       .cost = "O(n + m² d + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::amplified, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<Kjr>()},
      {.name = "efp", .summary = "explicit matrix, one force after the other through the tree",
       .formula = "the same, a_b = Ω_b κ_b on the path, Pᵀ a_π beside it", .source = "Chang and Khatib 2001; loops: algorithms/operators/mobility_form.h",
       .cost = "O(n m + m² + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::amplified, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<Efp>()},
      {.name = "efpa", .summary = "explicit matrix, propagators across spans shared by all rows of a body",
       .formula = "the same, P_{j→l} once per body and ancestor", .source = "Wensing, Featherstone and Orin 2012; loops: algorithms/operators/mobility_form.h",
       .cost = "O(n + m d + m² + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::amplified, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<Efpa>()},
      {.name = "maximal_direct", .summary = "explicit matrix by a sparse direct factor in maximal coordinates",
       .formula = "H a + Gᵀφ = Kᵀ, G a = S ν, Sᵀφ = A ν − 𝒦ᵀ; L D Lᵀ in tree order", .source = "Baraff 1996; algorithms/operators/maximal_direct.h",
       .cost = "O(n m + m² + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .holds = Holds::rows_squared,
       .makers = makers<MaximalDirect>()},
      {.name = "aba_sweep", .summary = "Delassus operator by two articulated-body sweeps",
       .formula = "a = J M⁻¹ Jᵀ f + R⁻¹ f", .source = "paper, Algorithms 1–3 merged (section IV-D)",
       .cost = "O(n + m)", .applies = true, .solves = false, .zero_damping = false, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::componentwise,
       .makers = makers<AbaSweep>()},
      {.name = "lcaba", .summary = "damped inverse by loop-constrained articulated-body sweeps",
       .formula = "f = R a − R J (M + Jᵀ R J)⁻¹ Jᵀ R a", .source = "paper, Algorithm 4 and equation (9) merged (section V-D)",
       .cost = "O(n + m) with local loops, O(n + m² d + m³) at worst", .applies = false, .solves = true,
       .zero_damping = false, .terminates_exactly = true, .apply_error = ErrorClass::componentwise,
       .solve_error = ErrorClass::amplified, .makers = makers<Lcaba>()},
      {.name = "caba_osim", .summary = "explicit damped inverse, every row carried through lcaba's factor",
       .formula = "Λ_R = R − R (Σ_i G_i D_i⁻¹ G_iᵀ) R, factor of M + Jᵀ R J", .source = "Sathya and Carpentier 2025; loops: algorithms/factors/row_propagation.h",
       .cost = "O(n + m² d) with local loops", .applies = false, .solves = true, .zero_damping = false,
       .terminates_exactly = true, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::amplified, .holds = Holds::rows_squared, .makers = makers<CabaOsim>()},
      {.name = "caba_osimr", .summary = "the same on the tree contracted to branchings, loaded bodies and coupled joints",
       .formula = "Λ_R = R − R (Σ_i G_i D_i⁻¹ G_iᵀ) R, factor of M + Jᵀ R J", .source = "Sathya and Carpentier 2025; loops: algorithms/factors/row_propagation.h",
       .cost = "O(n + m²), O(n + m² d) where loops couple joints", .applies = false, .solves = true, .zero_damping = false,
       .terminates_exactly = true, .apply_error = ErrorClass::amplified,  // of its mobilities
        .solve_error = ErrorClass::amplified, .holds = Holds::rows_squared, .makers = makers<CabaOsimR>()},
      {.name = "lcaba_refined", .summary = "lcaba with refinement on the KKT residual and a certificate",
       .formula = "M_R δν = r₁ + Jᵀ R r₂, δλ = R (r₂ − J δν)", .source = "paper, Algorithm 4; refinement: algorithms/operators/lcaba_refined.h",
       .cost = "O(n + m) with local loops", .applies = false, .solves = true, .zero_damping = false,
       .terminates_exactly = true, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined,
       .makers = makers<LcabaRefined>()},
      {.name = "ladder", .summary = "the default: the cheapest rung that reaches the wanted accuracy",
       .formula = "Λ_R a by lcaba_refined, lcaba_qr, proximal or kkt_elimination", .source = "algorithms/operators/ladder.h",
       .cost = "that of the rungs climbed", .applies = false, .solves = true, .zero_damping = true,
       .terminates_exactly = true, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined, .grows = true,
       .makers = ordered_makers<Ladder>()},
      {.name = "lcaba_qr", .summary = "square-root elimination: accurate however stiff or redundant the constraints",
       .formula = "min ‖ν‖²_M + ‖a − J ν‖²_R, f read from its residual", .source = "algorithms/factors/square_root_factor.h",
       .cost = "O(n + m) with local loops", .applies = false, .solves = true, .zero_damping = false,
       .terminates_exactly = false, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined,
       .makers = makers_with_roots<LcabaQr>()},
      {.name = "lcaba_float", .summary = "lcaba in float with capped stiffness, refined in double",
       .formula = "as lcaba_refined with R₀⁻¹ ≥ diag(d)/2¹³ in float", .source = "algorithms/operators/proximal.h",
       .cost = "O((n + m) steps)", .applies = false, .solves = true, .zero_damping = true, .terminates_exactly = false,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined,
       .factor_eps = 0x1p-24,
       .makers = {make<LcabaFloat, double>, nullptr, nullptr, nullptr, nullptr, nullptr}},
      {.name = "proximal", .summary = "hard constraints by proximal iterations on lcaba",
       .formula = "as lcaba_refined with R₀⁻¹ ≥ diag(d)/2²⁰", .source = "Rockafellar 1976; algorithms/operators/proximal.h",
       .cost = "O((n + m) steps)", .applies = false, .solves = true, .zero_damping = true, .terminates_exactly = false,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined,
       .factor_eps = 0x1p-32,
       .makers = makers_with_roots<Proximal>()},
      {.name = "maximal_free", .summary = "matrix-free iterations on bodies and joints in maximal coordinates; refuses massless bodies",
       .formula = "(B H⁻¹Bᵀ + C) (φ; λ) = b, B all joints and rows, refined", .source = "Tasora and Anitescu 2011; algorithms/operators/maximal_free.h",
       .cost = "O((n + m) √κ(N)) per step", .applies = false, .solves = true, .zero_damping = true, .terminates_exactly = false,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined, .maximal = true,
       .makers = {make<MaximalFree, double>, nullptr, nullptr, counted<MaximalFree>(), nullptr, nullptr}},
      {.name = "kkt_elimination", .summary = "multipliers kept to the end; finds the rank and names dependent rows",
       .formula = "A λ = r₂ − J M⁻¹ r₁, ν = M⁻¹(r₁ + Jᵀλ), refined", .source = "algorithms/operators/kkt_elimination.h",
       .cost = "O((n + m) m + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .decides_rank = true, .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined,
       .holds = Holds::rows_squared, .makers = ordered_makers<KktElimination>()},
      {.name = "dense_refined", .summary = "the same for regular A: a dense factor with refinement and certificate",
       .formula = "A λ = r₂ − J M⁻¹ r₁, ν = M⁻¹(r₁ + Jᵀλ), refined", .source = "algorithms/operators/kkt_elimination.h",
       .cost = "O((n + m) m + m³)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::refined, .holds = Holds::rows_squared, .makers = ordered_makers<DenseRefined>()},
      {.name = "cg", .summary = "conjugate gradients on aba_sweep",
       .formula = "A f = a by Krylov iteration", .source = "Hestenes and Stiefel 1952",
       .cost = "O((n + m) √κ)", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = true,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise, .makers = ordered_makers<Cg>()},
      {.name = "cg_preconditioned", .summary = "conjugate gradients preconditioned by lcaba in float",
       .formula = "A f = a by Krylov iteration", .source = "Hestenes and Stiefel 1952; algorithms/factors/capped_inverse.h",
       .cost = "O((n + m) √κ(P A))", .applies = true, .solves = true, .zero_damping = true, .terminates_exactly = false,
       .apply_error = ErrorClass::componentwise, .solve_error = ErrorClass::normwise,
       .factor_eps = 0x1p-24,
       .makers = makers_with_roots<CgPreconditioned>()},
  };
  return table;
}

const OperatorRow& find_operator(std::string_view wanted) {
  for (const OperatorRow& row : operators())
    if (row.name == wanted) return row;
  throw ModelError("", "operator", "there is no operator " + in_quotes(wanted), accepted_names(wanted, operators()) + "; `delassus list operators` says what each does");
}

}  // namespace delassus
