// Which coefficients a contact has of its own.
#pragma once

#include "models/scene_motion.h"

namespace delassus {

/// What the entries say of a contact, later ones before earlier ones; negative: nothing. Cost O(entries).
[[nodiscard]] inline SceneMotion::Between own_coefficients(const std::vector<SceneMotion::Between>& entries, const ContactPoint& p) {
  using Between = SceneMotion::Between;
  const Index other = p.standing >= 0 ? -3 - p.standing : p.other;
  const auto is = [](Index end, Index who) { return end == Between::any || end == who; };
  Between out;
  for (const Between& e : entries) {
    if (!(is(e.a, p.body) && is(e.b, other)) && !(is(e.a, other) && is(e.b, p.body))) continue;
    for (double Between::*const c : {&Between::friction, &Between::torsional, &Between::rolling, &Between::restitution})
      if (e.*c >= 0) out.*c = e.*c;
  }
  return out;
}

}  // namespace delassus
