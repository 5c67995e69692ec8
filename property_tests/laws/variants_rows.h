// Variants of a problem that change its rows or its units only. Instantiated for double and Rational.
#pragma once

#include "property_tests/laws/parts.h"

namespace delassus::laws {

/// The number of constraints of both kinds.
[[nodiscard]] Index constraint_count(const Structure& s);

/// One constraint, chosen by `seed`, left out. Needs two.
template <class T> [[nodiscard]] Second<T> one_left_out(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);
/// These rows (ascending) left out, and with the last row of a constraint the constraint.
template <class T> [[nodiscard]] Second<T> rows_left_out(const Problem<T>& p, const Damping<T>& d, const std::vector<Index>& rows);
/// The constraints in a random order.
template <class T> [[nodiscard]] Second<T> reordered(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);
/// Every link constraint has one body more, with K = 0. A is the same.
template <class T> [[nodiscard]] Second<T> with_idle_links(const Problem<T>& p, const Damping<T>& d);
/// One constraint, chosen by `seed`, twice: R⁻¹ times 3 on the first, times 3/2 on the copy, which comes last and has
/// the same `from`. Their R are a third and two thirds of the given one.
template <class T> [[nodiscard]] Second<T> doubled(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// There is a constraint of several rows whose R⁻¹ has no block.
[[nodiscard]] bool can_split_rows(const Problem<double>& p, const Damping<double>& d);
/// Every constraint of k rows whose R⁻¹ has no block as k constraints of one row. A is the same.
template <class T> [[nodiscard]] Second<T> rows_split(const Problem<T>& p, const Damping<T>& d);
/// There are two constraints on bodies, or on one joint.
[[nodiscard]] bool can_stack(const Problem<double>& p, const Damping<double>& d);
/// All constraints on the same bodies, or on the same joint, as one of all their rows; where there are none, any two on
/// bodies, chosen by `seed`, with K = 0 where a body is in one of them only. A is the same but for its order.
template <class T> [[nodiscard]] Second<T> rows_stacked(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Lengths times `length`, masses times `mass`, rows times `row`; A' = row²/mass A. Powers of two in double.
template <class T> struct Units {
  T length, mass, row;
};
template <class T> [[nodiscard]] Units<T> other_units();
template <class T> [[nodiscard]] Second<T> in_units(const Problem<T>& p, const Damping<T>& d, const Units<T>& u);

}  // namespace delassus::laws
