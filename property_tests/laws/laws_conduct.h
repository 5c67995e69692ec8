// Laws about how an operator behaves: several columns, repeated phases, memory, refusals. In double.
#pragma once

#include "property_tests/laws/laws_algebra.h"

namespace delassus::laws {

/// k columns at once = one after the other.
template <Function F> [[nodiscard]] Verdict multi_column(const OperatorRow& op, const Case& c);
/// update on other numbers, then update = update on a fresh operator, bit for bit.
template <Function F> [[nodiscard]] Verdict update_twice(const OperatorRow& op, const Case& c);
/// update at another damping, then update_damping = update.
template <Function F> [[nodiscard]] Verdict damping_update(const OperatorRow& op, const Case& c);
/// Result with a NaN-filled workspace = result with a zero one, bit for bit; no input is changed.
template <Function F> [[nodiscard]] Verdict poisoned_workspace(const OperatorRow& op, const Case& c);
/// NaN in the vector, or in the row's K: no finite number in the rows it enters, and a status that says so.
template <Function F> [[nodiscard]] Verdict nan_stays(const OperatorRow& op, const Case& c);
/// Accuracy::steps as many as a solve takes: the same bits. One fewer: not more than that, and not_converged unless the
/// answer is within its bound all the same.
[[nodiscard]] Verdict few_steps(const OperatorRow& op, const Case& c);

[[nodiscard]] const char* why_not_allocation(const OperatorRow& op, const Case& c);
/// After analyze, none of update, update_rows, update_damping, apply, solve and solve_kkt allocates.
[[nodiscard]] Verdict no_allocation(const OperatorRow& op, const Case& c);

[[nodiscard]] const char* why_not_zero_columns(const OperatorRow& op, const Case& c);
/// No rows or no columns: status ok, nothing written.
[[nodiscard]] Verdict empty_sizes(const OperatorRow& op, const Case& c);

[[nodiscard]] const char* why_not_zero_damping(const OperatorRow& op, const Case& c);
/// R⁻¹ = 0 on the first constraint: solved, or refused with zero_damping, a row of it, and NaN as result.
[[nodiscard]] Verdict zero_damping(const OperatorRow& op, const Case& c);

}  // namespace delassus::laws
