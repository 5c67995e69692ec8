// Other problems with the same answer, or one that follows from it: the second route of a law.
// Templates are instantiated for double (coefficients formed in Quad and rounded once), Rational and PrimeField.
#pragma once

#include "algorithms/kit/scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::laws {

/// What the errors of a scalar are computed in, and coefficients before they are rounded once.
template <class T> using Wide = std::conditional_t<ScalarTraits<T>::exact, T, Quad>;

template <class T> struct Variant {
  Problem<T> problem;
  Damping<T> damping;
};

/// The bodies renumbered at random (children stay after parents), links of a constraint listed in another order.
/// The rows, and with them A, are the same.
template <class T>
[[nodiscard]] Variant<T> relabelled(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Every joint constraint 𝒦_i as link constraint: 𝒦_i S⁺ on i and −𝒦_i S⁺ on its parent. A is the same.
template <class T> [[nodiscard]] Variant<T> joint_rows_as_links(const Problem<T>& p, const Damping<T>& d);

/// Armature A_i as rows 1 on joint i with R = A_i, appended after the others. With a = 0 there, the forces on the
/// first m rows are the same: eliminating the added rows puts R back on the diagonal of M.
template <class T> [[nodiscard]] Variant<T> armature_as_rows(const Problem<T>& p, const Damping<T>& d);

/// Other numbers on the same structure: H and armature doubled, K and 𝒦 halved, R⁻¹ times four.
template <class T> [[nodiscard]] Variant<T> other_numbers(const Problem<T>& p, const Damping<T>& d);

/// R⁻¹ of constraint k (in order of rows) multiplied by 2, 4 or 8, in turn.
template <class T> [[nodiscard]] Damping<T> other_damping(const Structure& s, const Damping<T>& d);

/// The first constraint made hard: R⁻¹ = 0 on its rows.
template <class T> [[nodiscard]] Damping<T> first_constraint_hard(const Structure& s, const Damping<T>& d);

}  // namespace delassus::laws
