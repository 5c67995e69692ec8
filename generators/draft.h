// Helpers that write specs: used by the families and by the random specs of the tests.
#pragma once

#include <string_view>

#include "generators/random.h"
#include "generators/spec.h"

namespace delassus::generators {

/// A spec being written, with its random stream.
class Draft {
 public:
  Draft(std::string_view family, std::uint64_t seed);

  /// Appends a body with random axis, offset and inertia; returns it for further settings (valid until the next one).
  BodySpec& body(Index parent, JointKind joint = JointKind::revolute);
  /// The same with any joint, in the shares of the random tree (fixed joints and generic ones among them).
  BodySpec& any_body(Index parent);
  /// Appends a link constraint; bodies must be distinct.
  LinkConstraintSpec& link(ConstraintKind kind, std::vector<Index> bodies);
  /// Appends rows on a joint (rows = 0: the identity); none on a joint without degrees of freedom.
  void joint_rows(Index body, Index rows = 0);

  [[nodiscard]] Index last() const { return static_cast<Index>(spec.bodies.size()) - 1; }
  [[nodiscard]] Index pick() { return random.integer(0, static_cast<int>(last())); }
  /// Sets the damping of every constraint, a fresh seed each.
  void damp(DampingKind kind, int low, int high);

  Spec spec;
  Random random;
};

/// Appends `n` revolute bodies in a chain below `parent`; returns the last.
Index limb(Draft& d, Index parent, Index n);

/// A spec with every feature at random: joints, loops, several trees, dampings, armature. For searches.
[[nodiscard]] Spec random_spec(Index bodies, std::uint64_t seed);

}  // namespace delassus::generators
