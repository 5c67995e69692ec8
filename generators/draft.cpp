#include "generators/draft.h"

#include <algorithm>

namespace delassus::generators {

Draft::Draft(std::string_view family, std::uint64_t seed) : random(seed * 1000003 + 17) {
  spec.family = family;
  spec.seed = seed;
}

BodySpec& Draft::body(Index parent, JointKind joint) {
  BodySpec b;
  b.parent = parent;
  b.joint = joint;
  do {
    for (int& x : b.axis) x = random.integer(-1, 1);
  } while (b.axis == std::array<int, 3>{0, 0, 0});
  b.offset = {random.integer(-1, 1), random.integer(-1, 1), random.integer(0, 1)};
  b.seed = random.next();
  spec.bodies.push_back(b);
  return spec.bodies.back();
}

BodySpec& Draft::any_body(Index parent) {
  const int kind = random.integer(0, 11);
  BodySpec& b = body(parent, kind < 8 ? static_cast<JointKind>(kind) : JointKind::revolute);
  if (b.joint == JointKind::generic) b.dof = random.integer(0, 6);
  if (random.integer(0, 3) == 0) b.armature_decade = random.integer(-2, 1);
  return b;
}

LinkConstraintSpec& Draft::link(ConstraintKind kind, std::vector<Index> bodies) {
  LinkConstraintSpec c;
  c.kind = kind;
  c.bodies = std::move(bodies);
  c.seed = random.next();
  c.damping.seed = random.next();
  spec.links.push_back(c);
  return spec.links.back();
}

void Draft::joint_rows(Index body, Index rows) {
  if (dof_count(spec.bodies[static_cast<std::size_t>(body)]) == 0) return;
  JointConstraintSpec c;
  c.body = body;
  c.rows = rows;
  c.seed = random.next();
  c.damping.seed = random.next();
  spec.joints.push_back(c);
}

void Draft::damp(DampingKind kind, int low, int high) {
  for (LinkConstraintSpec& c : spec.links) c.damping = {kind, low, high, random.next()};
  for (JointConstraintSpec& c : spec.joints) c.damping = {kind, low, high, random.next()};
}

Index limb(Draft& d, Index parent, Index n) {
  for (Index k = 0; k < n; ++k) {
    d.body(parent);
    parent = d.last();
  }
  return parent;
}

Spec random_spec(Index bodies, std::uint64_t seed) {
  Draft d("random", seed);
  Random& r = d.random;
  for (Index i = 0; i < bodies; ++i) {
    const Index parent = r.integer(0, 5) == 0 ? -1 : static_cast<Index>(r.integer(-1, static_cast<int>(i) - 1));
    d.any_body(parent).mass_decade = r.integer(-1, 1);
  }
  for (int e = r.integer(0, 4); bodies > 0 && e > 0; --e) {
    std::vector<Index> on{d.pick()};
    for (int k = r.integer(0, 2); k > 0; --k) {
      const Index b = d.pick();
      if (std::find(on.begin(), on.end(), b) == on.end()) on.push_back(b);
    }
    const auto kind = on.size() > 2 ? ConstraintKind::generic : static_cast<ConstraintKind>(r.integer(0, 6));
    LinkConstraintSpec& c = d.link(kind, on);
    if (kind == ConstraintKind::generic) c.rows = r.integer(1, 4);
    if (r.integer(0, 5) == 0) d.spec.links.push_back(c);  // the same rows twice
  }
  for (int e = r.integer(0, 3); bodies > 0 && e > 0; --e) d.joint_rows(d.pick(), r.integer(0, 2));
  const int low = r.integer(-6, 0);
  d.damp(r.integer(0, 3) == 0 ? DampingKind::block : DampingKind::rows, low, low + r.integer(0, 6));
  return d.spec;
}

}  // namespace delassus::generators
