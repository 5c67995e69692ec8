// Other mechanisms with the same rows: moved, described about other bodies and joints, or made stiffer.
// Coefficients that are not dyadic are formed in Quad and rounded once (double), or exact (Rational).
#pragma once

#include "property_tests/laws/parts.h"

namespace delassus::laws {

/// Every tree in its own place: S → X S, H → X⁻ᵀ H X⁻¹, K → K X⁻¹, X a rational rotation and a small translation.
template <class T> [[nodiscard]] Second<T> world_moved(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Free bodies that carry others, and neither armature nor joint rows.
[[nodiscard]] std::vector<Index> free_bases(const Problem<double>& p);
/// A free base (6 freedoms) exchanged for another body of its tree: the joints between them are listed from the other
/// side, S → −S.
template <class T> [[nodiscard]] Second<T> rerooted(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Some joint without joint rows has two freedoms or more.
[[nodiscard]] bool can_split(const Structure& s);
/// Those joints as a chain of joints of one freedom with massless links between them.
template <class T> [[nodiscard]] Second<T> joints_split(const Problem<T>& p, const Damping<T>& d);

/// Every body in two halves welded by a joint of no freedom; every other K moved to the second half.
template <class T> [[nodiscard]] Second<T> bodies_in_two(const Problem<T>& p, const Damping<T>& d);

/// One joint, chosen by `seed`, with one freedom less (unless that leaves joint rows without any), and the inertia of
/// every other body doubled: A decreases.
template <class T> [[nodiscard]] Second<T> stiffened(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Bodies whose joint has one freedom and armature.
[[nodiscard]] std::vector<Index> geared_joints(const Problem<double>& p);
/// The armature of one such joint as a body of its own: a rotor on the ground, tied to the joint by a hard row 1:1.
template <class T> [[nodiscard]] Second<T> with_rotor(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

/// Bodies whose joint has less than six freedoms, no armature and no joint rows.
[[nodiscard]] std::vector<Index> joints_to_cut(const Problem<double>& p);
/// One such joint cut: its body is free, and 6 − n_i hard rows N (a_i − a_π(i)), N S_i = 0, take the joint's place.
template <class T> [[nodiscard]] Second<T> joint_cut(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed);

}  // namespace delassus::laws
