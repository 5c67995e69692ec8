#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "generators/build.h"
#include "property_tests/laws/laws_conduct.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/laws_routes.h"
#include "property_tests/laws/maximal_condition.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

using X = Rational;

constexpr auto can_apply = why_not_function<double, apply>;
constexpr auto can_solve = why_not_function<double, solve>;
constexpr auto has_apply = why_not_called<apply>;
constexpr auto has_solve = why_not_called<solve>;
constexpr auto can_apply_exactly = why_not_function<X, apply>;
constexpr auto can_solve_exactly = why_not_function<X, solve>;

/// Whether `is` holds for the case or for a variant of it that a law formed.
bool any_variant(const Case& c, const std::function<bool(const Case&)>& is) {
  if (!why_no_bound(Function::solve, c) && is(c)) return true;
  for (const auto& [name, variant] : c.known->variants)
    if (any_variant(variant, is)) return true;
  return false;
}

/// An operator may give up, and say so (eps: unit roundoff of its factor's arithmetic):
///   an iteration      where κ(A) is beyond 1/√eps, or products A f are 30 m times less accurate than by the explicit matrix
///   a factorisation   where κ(A), that factor, or R (J M⁻¹Jᵀ) where it needs R, is beyond 2⁻¹³/eps, or where M may be
///                     singular within 30 eps; refinement on it too. Where it decides ranks, it may find A singular there
///   maximal coordinates   where H of a body is singular, or κ of that system is beyond 1/√eps
const char* excuse(const LawRow& law, const Broken& broken, const OperatorRow& op, const Case& c) {
  if (law.name.starts_with("exact ")) return nullptr;
  const double eps = law.name.ends_with("in float") ? std::max<double>(op.factor_eps, unit_roundoff<float>) : op.factor_eps;
  const bool iteration = broken.status == Status::not_converged;
  const bool factor = broken.status == Status::lost_pivot || (op.decides_rank && broken.status == Status::inconsistent);
  if (iteration && any_variant(c, [&](const Case& v) {
        return condition(v) > std::sqrt(0.5 / eps) || product_condition(v) > pass_below * static_cast<double>(v.rows());
      }))
    return "not_converged, and says so, where κ(A) > 1/√eps or A f itself is not that accurate";
  if ((iteration || factor) && any_variant(c, [&](const Case& v) {
        const double stiff = op.zero_damping ? 0 : stiffness(v);
        return std::max({condition(v), product_condition(v), stiff}) > 0x1p-13 / eps ||
               static_cast<double>(condition_of_M(v)) > 1 / (pass_below * eps);
      }))
    return "gives up, and says so, where κ(A) or R (J M⁻¹Jᵀ) > 2⁻¹³/eps, or κ(M) > 1/(30 eps)";
  if (op.maximal && (iteration || factor) && any_variant(c, [&](const Case& v) { return maximal_condition(v.problem, v.damping) > std::sqrt(0.5 / eps); }))
    return "gives up, and says so, where H of a body is singular, or κ of the system in maximal coordinates > 1/√eps";
  return nullptr;
}

std::vector<LawRow> first_laws() {
  return {
      {"apply symmetric", "xᵀ(A y) = (A x)ᵀ y", of_apply, can_apply, symmetric<double, apply>},
      {"solve symmetric", "xᵀ(A⁻¹ y) = (A⁻¹ x)ᵀ y", of_solve, can_solve, symmetric<double, solve>},
      {"apply positive", "0 ≤ xᵀ A x", of_apply, can_apply, positive<double, apply>},
      {"solve positive", "(A⁻¹x)ᵀ R⁻¹ (A⁻¹x) ≤ xᵀ A⁻¹ x", of_solve, can_solve, positive<double, solve>},
      {"apply linear", "A(2x − 3y) = 2 A x − 3 A y", of_apply, can_apply, linear<double, apply>},
      {"solve linear", "A⁻¹(2x − 3y) = 2 A⁻¹ x − 3 A⁻¹ y", of_solve, can_solve, linear<double, solve>},
      {"columns = definition", "A e_j = J M⁻¹ Jᵀ e_j + R⁻¹ e_j", of_apply, can_apply, is_definition<double, apply>},
      {"damped inverse = definition", "Λ_R e_j = (J M⁻¹ Jᵀ + R⁻¹)⁻¹ e_j", of_solve, can_solve, is_definition<double, solve>},
      {"apply = maximal", "A x = every joint a constraint", of_apply, why_not_witness<apply, Witness::maximal>,
       witnessed<apply, Witness::maximal>},
      {"damped inverse = maximal", "Λ_R x = every joint a constraint", of_solve, why_not_witness<solve, Witness::maximal>,
       witnessed<solve, Witness::maximal>},
      {"apply = kkt", "A x = the sparse system by CHOLMOD", "apply_sensitivity + largest entry",
       why_not_witness<apply, Witness::kkt>, witnessed<apply, Witness::kkt>},
      {"damped inverse = kkt", "Λ_R x = the sparse system by CHOLMOD", "by error class + largest entry",
       why_not_witness<solve, Witness::kkt>, witnessed<solve, Witness::kkt>},
      {"round trip", "A⁻¹ (A x) = x", of_solve, can_solve, round_trip<double>},
      {"resolvent", "V_R(a + (R⁻¹ − R'⁻¹) V_R' a) = V_R' a", of_solve, can_solve, resolvent<double>},
      {"apply relabelled", "A x = A x with bodies renumbered", of_apply, can_apply, relabelling<double, apply>},
      {"solve relabelled", "A⁻¹ x = A⁻¹ x with bodies renumbered", of_solve, can_solve, relabelling<double, solve>},
      {"apply joint row = link rows", "𝒦_i = (𝒦_i S⁺, −𝒦_i S⁺) on (i, π(i))", of_apply, why_not_joint_rows<double, apply>,
       joint_rows<double, apply>},
      {"solve joint row = link rows", "𝒦_i = (𝒦_i S⁺, −𝒦_i S⁺) on (i, π(i))", of_solve, why_not_joint_rows<double, solve>,
       joint_rows<double, solve>},
      {"armature = joint row", "armature A_i = rows 1 on joint i with R = A_i, a = 0", of_solve, why_not_armature<double>,
       armature<double>},
      {"apply multi-column", "A [x y …] = [A x, A y, …]", of_apply, can_apply, multi_column<apply>},
      {"solve multi-column", "A⁻¹ [x y …] = [A⁻¹ x, A⁻¹ y, …]", of_solve, can_solve, multi_column<solve>},
      {"apply after update twice", "second update = fresh operator", "identical bits", has_apply, update_twice<apply>},
      {"solve after update twice", "second update = fresh operator", "identical bits", has_solve, update_twice<solve>},
      {"apply after update_damping", "update_damping = update", of_apply, can_apply, damping_update<apply>},
      {"solve after update_damping", "update_damping = update", of_solve, can_solve, damping_update<solve>},
      {"solve in few steps", "as many steps as it takes: the same; one fewer: says so", of_solve, has_solve, few_steps},
      {"no allocation", "allocations after analyze = 0", "zero", why_not_allocation, no_allocation},
      {"apply with poisoned workspace", "NaN-filled = zero workspace", "identical bits", has_apply, poisoned_workspace<apply>},
      {"solve with poisoned workspace", "NaN-filled = zero workspace", "identical bits", has_solve, poisoned_workspace<solve>},
      {"empty sizes", "no rows or no columns: ok", "zero", why_not_zero_columns, empty_sizes},
      {"zero damping", "R⁻¹ = 0: solved, or refused by row", of_solve, why_not_zero_damping, zero_damping},
      {"apply keeps NaN", "NaN in ⇒ NaN out and a status", "NaN", has_apply, nan_stays<apply>},
      {"solve keeps NaN", "NaN in ⇒ NaN out and a status", "NaN", has_solve, nan_stays<solve>},
      // Exact twins: the same in rational numbers, by equality.
      {"exact apply symmetric", "xᵀ(A y) = (A x)ᵀ y", "equality", can_apply_exactly, symmetric<X, apply>},
      {"exact solve symmetric", "xᵀ(A⁻¹ y) = (A⁻¹ x)ᵀ y", "equality", can_solve_exactly, symmetric<X, solve>},
      {"exact apply positive", "0 ≤ xᵀ A x", "equality", can_apply_exactly, positive<X, apply>},
      {"exact solve positive", "(A⁻¹x)ᵀ R⁻¹ (A⁻¹x) ≤ xᵀ A⁻¹ x", "equality", can_solve_exactly, positive<X, solve>},
      {"exact columns = definition", "A e_j = J M⁻¹ Jᵀ e_j + R⁻¹ e_j", "equality", can_apply_exactly,
       is_definition<X, apply>},
      {"exact damped inverse = definition", "Λ_R e_j = (J M⁻¹ Jᵀ + R⁻¹)⁻¹ e_j", "equality", can_solve_exactly,
       is_definition<X, solve>},
      {"exact round trip", "A⁻¹ (A x) = x", "equality", can_solve_exactly, round_trip<X>},
      {"exact resolvent", "V_R(a + (R⁻¹ − R'⁻¹) V_R' a) = V_R' a", "equality", can_solve_exactly, resolvent<X>},
      {"exact apply relabelled", "A x = A x with bodies renumbered", "equality", can_apply_exactly, relabelling<X, apply>},
      {"exact solve relabelled", "A⁻¹ x = A⁻¹ x with bodies renumbered", "equality", can_solve_exactly,
       relabelling<X, solve>},
      {"exact apply joint row = link rows", "𝒦_i = (𝒦_i S⁺, −𝒦_i S⁺) on (i, π(i))", "equality",
       why_not_joint_rows<X, apply>, joint_rows<X, apply>},
      {"exact solve joint row = link rows", "𝒦_i = (𝒦_i S⁺, −𝒦_i S⁺) on (i, π(i))", "equality",
       why_not_joint_rows<X, solve>, joint_rows<X, solve>},
      {"exact armature = joint row", "armature A_i = rows 1 on joint i with R = A_i, a = 0", "equality",
       why_not_armature<X>, armature<X>},
  };
}

}  // namespace

const std::vector<LawRow>& laws() {
  static const std::vector<LawRow> table = [] {
    std::vector<LawRow> all;
    for (const auto group : {first_laws, order_laws, row_laws, pair_laws, rank_laws, mechanism_laws, scalar_laws})
      for (const LawRow& row : group()) all.push_back(row);
    return all;
  }();
  return table;
}

const LawRow& find_law(std::string_view name) {
  for (const LawRow& row : laws())
    if (row.name == name) return row;
  throw ModelError("", "law", "there is no law " + in_quotes(name), accepted_names(name, laws()) + "; `delassus list laws` says what each is");
}

Case make_case(Problem<double> problem, Damping<double> damping, std::string label, std::uint64_t seed, bool exact) {
  return {std::move(problem), std::move(damping), std::move(label), seed, exact, std::make_shared<Known>()};
}

Case make_case(const generators::Spec& spec) {
  generators::Built built = generators::build(spec);
  const auto size = static_cast<Index>(spec.bodies.size());
  const bool exact = built.problem.structure->dofs() <= 40 && built.problem.structure->rows <= 40 && size <= 8;
  return make_case(std::move(built.problem), std::move(built.damping),
                   spec.family + " n=" + std::to_string(size) + " seed=" + std::to_string(spec.seed), spec.seed, exact);
}

Case make_case(std::string_view family, Index n, std::uint64_t seed) {
  const generators::FamilyRow& row = generators::find_family(family);
  Case c = make_case(row.make(n, seed));
  c.exact = n <= row.exact_size;
  c.label = std::string(family) + " n=" + std::to_string(n) + " seed=" + std::to_string(seed);
  return c;
}

Outcome check(const LawRow& law, const OperatorRow& op, const Case& c) {
  Outcome outcome{law.name, op.name, c.label, nullptr, {}};
  try {
    outcome.skipped = law.why_not(op, c);
    if (!outcome.skipped) outcome.verdict = law.check(op, c);
  } catch (const Broken& broken) {
    outcome.skipped = excuse(law, broken, op, c);
    outcome.verdict = failure(broken.what(), law.bound);
  } catch (const std::exception& e) {
    outcome.verdict = failure(e.what(), law.bound);
  }
  return outcome;
}

std::vector<Outcome> check(const OperatorRow& op, const Case& c) {
  std::vector<Outcome> outcomes;
  for (const LawRow& law : laws()) outcomes.push_back(check(law, op, c));
  return outcomes;
}

}  // namespace delassus::laws
