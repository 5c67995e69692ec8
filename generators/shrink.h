// Structural shrinking: from a spec that fails to a small one that still does. Every move leaves a mechanism, and makes
// it simpler in a way that no other move takes back, so shrinking ends.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "generators/spec.h"

namespace delassus::generators {

enum class MoveKind : std::uint8_t {
  drop_bodies,       ///< bodies [at, at + count); children and constraints go to the nearest ancestor left
  drop_links,        ///< link constraints [at, at + count)
  drop_joint_rows,   ///< joint constraint `at`
  detach,            ///< body number `count` of link constraint `at`
  one_row_less,      ///< a link constraint with fewer rows: weld and hinge to point, contact and point to plane, generic by one
  one_joint_row,     ///< rows on a joint by one less, an identity of several rows to a single row
  reparent,          ///< body `at` to its grandparent
  to_revolute,
  unit_mass,
  no_armature,
  no_bend,           ///< the small angle of a nearly straight arm to 0
  plain_axis,        ///< axis z
  plain_offset,      ///< one length along x
  unit_length,
  plain_damping,     ///< of link constraint `at` (joint constraints after them): 1 on every row
  zero_seed,         ///< of body `at`, then of link and joint constraints
  ends
};

struct Move {
  MoveKind kind;
  std::size_t at = 0, count = 1;
};

/// The moves that may be tried on this spec, in their fixed order: large pieces first.
[[nodiscard]] std::vector<Move> moves(const Spec& spec);
/// nullopt where the move changes nothing or does not exist.
[[nodiscard]] std::optional<Spec> moved(const Spec& spec, const Move& move);

struct Shrunk {
  Spec spec;
  int tried = 0, kept = 0;
  bool finished = true;   ///< no move left that keeps the failure; false: `most_tries` used up
};

/// Greedy: a move is kept when `still_fails` holds for its result; repeated until no move is kept. Deterministic when
/// the predicate is. Cost: at most `most_tries` calls of the predicate.
[[nodiscard]] Shrunk shrink(Spec spec, const std::function<bool(const Spec&)>& still_fails, int most_tries = 3000);

}  // namespace delassus::generators
