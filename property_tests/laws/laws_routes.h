// Laws that compare an operator with itself on another description of the same mechanism, or with a reference.
#pragma once

#include "property_tests/laws/laws_algebra.h"

namespace delassus::laws {

/// Bodies renumbered, links of constraints listed in another order: the same answers.
template <class T, Function F> [[nodiscard]] Verdict relabelling(const OperatorRow& op, const Case& c);

template <class T, Function F> [[nodiscard]] const char* why_not_joint_rows(const OperatorRow& op, const Case& c);
/// Joint rows 𝒦_i = link rows 𝒦_i S⁺ on i and −𝒦_i S⁺ on its parent.
template <class T, Function F> [[nodiscard]] Verdict joint_rows(const OperatorRow& op, const Case& c);

template <class T> [[nodiscard]] const char* why_not_armature(const OperatorRow& op, const Case& c);
/// Armature A_i = identity rows on joint i with R = A_i and a = 0: the same forces on the other rows.
template <class T> [[nodiscard]] Verdict armature(const OperatorRow& op, const Case& c);

/// Which reference.
enum class Witness : std::uint8_t { maximal, kkt };
template <Function F, Witness W> [[nodiscard]] const char* why_not_witness(const OperatorRow& op, const Case& c);
/// F x = the reference's answer.
template <Function F, Witness W> [[nodiscard]] Verdict witnessed(const OperatorRow& op, const Case& c);

}  // namespace delassus::laws
