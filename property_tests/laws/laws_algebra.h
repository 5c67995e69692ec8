// Laws about one operator on one problem: A is symmetric, positive, linear, and what its definition says.
// T is double (error / (eps · bound)) or Rational (equality).
#pragma once

#include "property_tests/laws/laws.h"
#include "property_tests/laws/known.h"

namespace delassus::laws {

/// Reason why a law about this function in scalar T does not apply; nullptr: it does.
template <class T> [[nodiscard]] const char* why_not(Function f, const OperatorRow& op, const Case& c);
template <class T, Function F> [[nodiscard]] const char* why_not_function(const OperatorRow& op, const Case& c) {
  return why_not<T>(F, op, c);
}

/// The same of a law that needs no bound and no reference: the operator has the function, whatever it comes to.
template <Function F> [[nodiscard]] const char* why_not_called(const OperatorRow& op, const Case& c);

/// xᵀ(F y) = (F x)ᵀ y.
template <class T, Function F> [[nodiscard]] Verdict symmetric(const OperatorRow& op, const Case& c);
/// apply: 0 ≤ xᵀ A x. solve: 0 ≤ xᵀ A⁻¹ x, and ≤ xᵀ R x where R⁻¹ > 0, here as (A⁻¹x)ᵀ R⁻¹ (A⁻¹x) ≤ xᵀ A⁻¹ x.
template <class T, Function F> [[nodiscard]] Verdict positive(const OperatorRow& op, const Case& c);
/// F(2x − 3y) = 2 F x − 3 F y.
template <class T, Function F> [[nodiscard]] Verdict linear(const OperatorRow& op, const Case& c);
/// F e_j and F x by the definition, up to 12 columns.
template <class T, Function F> [[nodiscard]] Verdict is_definition(const OperatorRow& op, const Case& c);
/// solve(apply(x)) = x; A x by the definition where the operator has no apply.
template <class T> [[nodiscard]] Verdict round_trip(const OperatorRow& op, const Case& c);
/// V_R(a + (R⁻¹ − R'⁻¹) V_R' a) = V_R' a.
template <class T> [[nodiscard]] Verdict resolvent(const OperatorRow& op, const Case& c);

}  // namespace delassus::laws
