// The rows of the table of laws that stand in the files that check them; laws.cpp lists them after its own.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/known.h"

namespace delassus::laws {

[[nodiscard]] std::vector<LawRow> order_laws();       ///< inequalities between quadratic forms, and the fixed point
[[nodiscard]] std::vector<LawRow> row_laws();         ///< fewer, other, parallel rows; other units
[[nodiscard]] std::vector<LawRow> pair_laws();        ///< motion and force together; rows that come and go
[[nodiscard]] std::vector<LawRow> rank_laws();        ///< which hard rows depend on others, in any description
[[nodiscard]] std::vector<LawRow> mechanism_laws();   ///< other descriptions of the same mechanism
[[nodiscard]] std::vector<LawRow> scalar_laws();      ///< float, Quad, refusals, threads

inline constexpr Function apply = Function::apply, solve = Function::solve;

/// The laws on other descriptions are many: exact arithmetic takes the smaller half of its cases only.
using Reason = const char* (*)(const OperatorRow&, const Case&);
template <Reason why_not> [[nodiscard]] const char* why_not_twin(const OperatorRow& op, const Case& c) {
  if (c.rows() > 20 || c.problem.structure->dofs() > 20) return "more than 20 rows or freedoms: too long in exact arithmetic";
  return why_not(op, c);
}

/// A law in double against `bound`, and its exact twin. Laws and reasons are templates over <scalar, function>.
#define DELASSUS_TWINS(name, identity, bound, function, why_not, check)          \
  {name, identity, bound, why_not<double, function>, check<double, function>},   \
  {"exact " name, identity, "equality", why_not_twin<why_not<Rational, function>>, check<Rational, function>}

inline constexpr const char* of_apply = "apply_sensitivity";
inline constexpr const char* of_solve = "by error class (docs/verification.md)";

}  // namespace delassus::laws
