// A random-looking mechanism as a plain value: structure, enumerations, small integers and decades, never raw doubles.
// Everything a failing case is can be read, edited, shrunk, stored as JSON and built again bit for bit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus::generators {

/// Joints by their motion subspace; `generic` has `dof` (0…6) linearly independent columns of small integers.
enum class JointKind : std::uint8_t {
  revolute, prismatic, cylindrical, universal, planar, spherical, floating, generic
};

/// Rows of a link constraint. All but `generic` are physical: K on the first body, −K on the second, about one point.
///   point 3, weld 6, hinge 5 (free axis random), distance 1, plane 1 (contact normal), contact 3 (skewed axes)
///   generic: `rows` rows, independent small integers on each body (not antisymmetric, not of full rank by construction)
enum class ConstraintKind : std::uint8_t { point, weld, hinge, distance, plane, contact, generic };

enum class DampingKind : std::uint8_t {
  zero,   ///< R⁻¹ = 0: hard rows
  rows,   ///< a power of ten (rounded to a power of two) per row, between two decades
  block,  ///< one symmetric positive definite block over the rows of the constraint
};

struct BodySpec {
  Index parent = -1;                          ///< earlier body, or −1: the ground
  JointKind joint = JointKind::revolute;
  Index dof = 1;                              ///< generic joints only
  std::array<int, 3> axis{0, 0, 1};           ///< of the joint, not zero; scaled by a power of two to about unit length
  std::array<int, 3> offset{1, 0, 0};         ///< joint point from the parent's joint point, in 10^length_decade m
  std::optional<int> bend_decade;             ///< adds 10^bend_decade · length along y to the offset (nearly straight)
  std::optional<int> mass_decade = 0;         ///< 10^decade kg; absent: massless (M must stay regular by armature or children)
  int length_decade = 0;                      ///< size of the body and unit of `offset`
  std::optional<int> armature_decade;         ///< absent: none
  std::uint64_t seed = 0;                     ///< of its centre of mass, inertia and generic columns
};

struct DampingSpec {
  DampingKind kind = DampingKind::rows;
  int low = -2, high = -2;                    ///< decades of R⁻¹ [1/kg]
  std::uint64_t seed = 0;
};

struct LinkConstraintSpec {
  ConstraintKind kind = ConstraintKind::point;
  Index rows = 1;                             ///< generic only
  std::vector<Index> bodies;                  ///< 1, 2 or more distinct bodies (one: to the ground); physical kinds 1 or 2
  std::uint64_t seed = 0;                     ///< equal seeds, kinds and bodies give coincident constraints
  std::optional<std::array<int, 3>> at, axis; ///< of physical kinds: the point, from the first body's joint point in its
                                              ///< 10^length_decade m, and the free axis; absent: by the seed
  DampingSpec damping;
};

struct JointConstraintSpec {
  Index body = 0;
  Index rows = 0;                             ///< 0: the identity on the joint (friction, lock); otherwise `rows` generic rows
  std::uint64_t seed = 0;
  DampingSpec damping;
};

struct Spec {
  std::string family;
  std::uint64_t seed = 0;
  std::vector<BodySpec> bodies;
  std::vector<LinkConstraintSpec> links;
  std::vector<JointConstraintSpec> joints;    ///< their rows follow those of `links`
  std::optional<std::uint64_t> turn;          ///< the whole in axes turned by a rotation of this seed, which rounds the numbers
};

/// Degrees of freedom of a body's joint.
[[nodiscard]] Index dof_count(const BodySpec& b);

/// JSON text, and back. @throws ModelError naming `file`, the element and what is accepted.
[[nodiscard]] std::string to_json(const Spec& spec);
[[nodiscard]] Spec from_json(const std::string& text, const std::string& file);

}  // namespace delassus::generators
