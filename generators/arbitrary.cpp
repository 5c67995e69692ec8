#include "generators/arbitrary.h"

#include <algorithm>

#include "generators/draft.h"
#include "generators/families_linkages.h"

namespace delassus::generators {
namespace {

using C = ConstraintKind;

bool one_in(Random& r, int n) { return r.integer(1, n) == 1; }

/// Any joint but one of six freedoms below another body: that restrains nothing and is a second tree.
void add_body_below(Draft& d, Index parent) {
  BodySpec& b = d.any_body(parent);
  if (parent < 0) return;
  if (b.joint == JointKind::floating) b.joint = JointKind::spherical;
  b.dof = std::min<Index>(b.dof, 5);
}

/// Chains, trees and forests, a free base on every third.
void add_bodies(Draft& d, Index n) {
  Random& r = d.random;
  const int shape = r.integer(0, 3);
  const bool floating = one_in(r, 3);
  for (Index k = 0; k < n; ++k) {
    const int last = static_cast<int>(k) - 1;
    const Index parent = shape < 2 || k == 0 ? last : r.integer(shape == 2 ? 0 : -1, last);
    if (k == 0 && floating) d.body(-1, JointKind::floating);
    else add_body_below(d, parent);
  }
}

void set_masses(Draft& d) {
  Random& r = d.random;
  std::vector<BodySpec>& bodies = d.spec.bodies;
  const int reach = std::array{0, 1, 1, 4}[static_cast<std::size_t>(r.integer(0, 3))];
  for (BodySpec& b : bodies) b.mass_decade = r.integer(-reach, reach);
  if (reach == 4 && bodies.size() > 1) {
    bodies.front().mass_decade = r.coin() ? -4 : 4;
    bodies.back().mass_decade = -*bodies.front().mass_decade;
  }
  if (bodies.empty() || !one_in(r, 12)) return;
  BodySpec& massless = bodies[static_cast<std::size_t>(d.pick())];
  massless.mass_decade.reset();
  massless.armature_decade = 0;
}

/// Bodies of unequal size, or an arm with parallel axes stretched out to a small bend.
void set_geometry(Draft& d) {
  Random& r = d.random;
  const bool unequal = one_in(r, 8), stretched = one_in(r, 12);
  for (BodySpec& b : d.spec.bodies) {
    if (unequal) b.length_decade = r.integer(-1, 1);
    if (!stretched) continue;
    b.axis = {0, 0, 1};
    b.offset = {1, 0, 0};
    b.bend_decade = -4;
  }
}

/// One to three distinct bodies.
std::vector<Index> some_bodies(Draft& d) {
  std::vector<Index> on{d.pick()};
  const int more = std::array{0, 1, 1, 1, 2}[static_cast<std::size_t>(d.random.integer(0, 4))];
  for (int k = 0; k < more; ++k) {
    const Index b = d.pick();
    if (std::find(on.begin(), on.end(), b) == on.end()) on.push_back(b);
  }
  return on;
}

void add_links(Draft& d) {
  Random& r = d.random;
  for (int e = r.integer(0, 4); e > 0; --e) {
    const std::vector<Index> on = some_bodies(d);
    const C kind = on.size() > 2 ? C::generic : static_cast<C>(r.integer(0, 6));
    LinkConstraintSpec& c = d.link(kind, on);
    if (kind == C::generic) c.rows = r.integer(1, 4);
    const LinkConstraintSpec again = c;
    if (one_in(r, 8)) d.spec.links.push_back(again);  // the same rows twice
  }
}

void add_joint_rows(Draft& d) {
  Random& r = d.random;
  if (r.coin()) return;
  for (int e = r.integer(1, 3); e > 0; --e) d.joint_rows(d.pick(), std::max(0, r.integer(-2, 2)));
}

/// R⁻¹ from 1e-8 to 1e12: the first and the last constraint hold the ends.
void damp_over_twenty_decades(Draft& d) {
  d.damp(DampingKind::rows, -8, 12);
  std::vector<DampingSpec*> all;
  for (LinkConstraintSpec& c : d.spec.links) all.push_back(&c.damping);
  for (JointConstraintSpec& c : d.spec.joints) all.push_back(&c.damping);
  if (all.size() < 2) return;
  all.front()->high = all.front()->low;
  all.back()->low = all.back()->high;
}

void set_damping(Draft& d) {
  Random& r = d.random;
  const int mode = r.integer(0, 15), low = r.integer(-6, 0), high = low + r.integer(0, 6);
  if (mode < 9) d.damp(DampingKind::rows, low, high);
  else if (mode < 12) d.damp(DampingKind::block, low, high);
  else if (mode < 14) damp_over_twenty_decades(d);
  else d.damp(DampingKind::rows, low, low);
  if (mode < 14) return;
  for (LinkConstraintSpec& c : d.spec.links)
    if (mode == 15 || r.coin()) c.damping.kind = DampingKind::zero;
  for (JointConstraintSpec& c : d.spec.joints)
    if (mode == 15 || r.coin()) c.damping.kind = DampingKind::zero;
}

/// Above 200 bodies in one path. Five joints of six are fixed, so that dense references stay affordable.
void add_long_chain(Draft& d) {
  Random& r = d.random;
  const Index n = r.integer(201, 230);
  for (Index k = 0; k < n; ++k) {
    const bool moves = one_in(r, 6);
    BodySpec& b = d.body(k - 1, moves ? JointKind::revolute : JointKind::generic);
    b.dof = moves ? 1 : 0;
  }
}

Index size(Random& r) {
  const int k = r.integer(0, 255);
  if (k < 2) return 0;
  if (k < 6) return r.integer(13, 24);
  const int first = r.integer(1, 12), second = r.integer(1, 12);
  return std::min(first, second);
}

}  // namespace

Spec arbitrary(std::uint64_t seed) {
  if (Random linkages(seed ^ 0x6c696e6b); one_in(linkages, 64)) {
    Spec s = any_linkage(seed);
    s.family = "arbitrary";
    return s;
  }
  Draft d("arbitrary", seed);
  if (one_in(d.random, 256)) add_long_chain(d);
  else add_bodies(d, size(d.random));
  set_masses(d);
  if (d.spec.bodies.size() < 100) set_geometry(d);
  if (d.spec.bodies.empty() || one_in(d.random, 32)) return d.spec;
  add_links(d);
  add_joint_rows(d);
  set_damping(d);
  return d.spec;
}

}  // namespace delassus::generators
