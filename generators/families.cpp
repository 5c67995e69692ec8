#include "generators/families.h"

#include <algorithm>
#include <string>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"
#include "generators/draft.h"
#include "generators/families_hard.h"
#include "generators/families_linkages.h"

namespace delassus::generators {
namespace {

using enum JointKind;
using C = ConstraintKind;
using D = DampingKind;

Spec chain(Index n, std::uint64_t seed) {
  Draft d("chain", seed);
  const Index tip = limb(d, -1, n);
  if (n > 0) d.link(C::point, {tip});
  if (n > 2) d.link(C::plane, {tip / 2});
  d.damp(D::rows, -4, -2);
  return d.spec;
}

Spec swimmer(Index n, std::uint64_t seed) {
  Draft d("swimmer", seed);
  d.body(-1, floating);
  const Index tip = limb(d, 0, n - 1);
  d.link(C::contact, {0});
  if (tip > 0) d.link(C::weld, {tip});
  d.damp(D::rows, -4, 0);
  return d.spec;
}

Spec star(Index n, std::uint64_t seed) {
  Draft d("star", seed);
  d.body(-1, floating);
  for (Index k = 1; k < n; ++k) {
    d.body(0, k % 3 == 0 ? spherical : revolute);
    d.link(C::contact, {k});
  }
  d.damp(D::rows, -3, -3);
  return d.spec;
}

Spec comb(Index n, std::uint64_t seed) {
  Draft d("comb", seed);
  Index spine = -1;
  for (Index k = 0; k + 1 < n; k += 2) {
    d.body(spine);
    spine = d.last();
    d.body(spine, universal);
    d.link(C::plane, {d.last()});
    d.link(C::point, {spine, d.last()});
  }
  d.damp(D::rows, -4, 0);
  return d.spec;
}

Spec random_tree(Index n, std::uint64_t seed) {
  Draft d("random_tree", seed);
  for (Index k = 0; k < n; ++k) d.any_body(k == 0 ? -1 : d.pick());
  for (Index k = 0; k < 3 && n > 0; ++k) d.link(static_cast<C>(d.random.integer(0, 6)), {d.pick()}).rows = 2;
  for (Index k = 0; k < 2 && n > 0; ++k) d.joint_rows(d.pick());
  d.damp(D::rows, -4, 0);
  return d.spec;
}

/// Trunk with a head, two legs and two arms of (n − 2)/4 bodies, four contacts per foot, the hands holding each other.
Spec humanoid_with(std::string_view name, Index n, std::uint64_t seed, D kind, int low, int high) {
  Draft d(name, seed);
  d.body(-1, floating).mass_decade = 1;
  d.body(0);
  const Index length = std::max<Index>(1, (n - 2) / 4);
  const Index feet[2] = {limb(d, 0, length), limb(d, 0, length)};
  const Index hands[2] = {limb(d, 0, length), limb(d, 0, length)};
  for (BodySpec& b : d.spec.bodies)
    if (b.joint == revolute) b.armature_decade = -2;
  for (const Index foot : feet)
    for (int k = 0; k < 4; ++k) d.link(C::contact, {foot});
  d.link(C::weld, {hands[0], hands[1]});
  for (Index k = 1; k <= d.last(); ++k) d.joint_rows(k);
  d.damp(kind, low, high);
  return d.spec;
}

Spec humanoid(Index n, std::uint64_t seed) { return humanoid_with("humanoid", n, seed, D::rows, -4, -4); }

Spec mixed_damping(Index n, std::uint64_t seed) { return humanoid_with("mixed_damping", n, seed, D::rows, -8, 12); }

/// n/3 planar four-bar linkages on a rotating base: three rows of each closure, of which two are independent.
Spec four_bar(Index n, std::uint64_t seed) {
  Draft d("four_bar", seed);
  d.body(-1).axis = {0, 0, 1};
  for (Index k = 1; k + 2 < n || k == 1; k += 3) {
    for (Index j = 0; j < 3; ++j) {
      BodySpec& b = d.body(j == 0 ? 0 : d.last());
      b.axis = {0, 0, 1};
      b.offset = {j == 1 ? 0 : 1, j == 1 ? 1 : 0, 0};
    }
    d.link(C::point, {0, d.last()});
  }
  d.damp(D::rows, -4, -2);
  return d.spec;
}

Spec ring(Index n, std::uint64_t seed) {
  Draft d("ring", seed);
  d.body(-1, floating);
  const Index tip = limb(d, 0, n - 1);
  if (tip > 0) d.link(C::weld, {0, tip});
  if (tip > 1) d.link(C::hinge, {tip / 2, tip});
  d.damp(D::rows, -3, 0);
  return d.spec;
}

/// A square grid of about n free bodies, neighbours joined at a point: as many loops as bodies.
Spec lattice(Index n, std::uint64_t seed) {
  Draft d("lattice", seed);
  Index side = 1;
  while ((side + 1) * (side + 1) <= n) ++side;
  for (Index k = 0; k < side * side; ++k) d.body(-1, floating);
  for (Index k = 0; k < side * side; ++k) {
    if (k % side + 1 < side) d.link(C::point, {k, k + 1});
    if (k + side < side * side) d.link(C::point, {k, k + side});
  }
  d.link(C::weld, {0});
  d.damp(D::rows, -4, -1);
  return d.spec;
}

/// Every closure twice, once at the same place, and a body welded to the ground by three points more than it needs.
Spec redundant(Index n, std::uint64_t seed) {
  Draft d("redundant", seed);
  limb(d, -1, n);
  for (Index k = 0; k + 1 < n; k += 2) {
    d.spec.links.push_back(d.link(C::point, {k, k + 1}));
    d.link(C::point, {k, k + 1});
  }
  if (n > 0) d.link(C::weld, {n - 1});
  if (n > 0) d.link(C::point, {n - 1});
  d.damp(D::rows, -2, 0);
  return d.spec;
}

Spec stack(std::string_view name, Index n, std::uint64_t seed, D kind, int low, int high) {
  Draft d(name, seed);
  for (Index k = 0; k < n; ++k) {
    d.body(-1, floating);
    for (int p = 0; p < 4; ++p) d.link(C::contact, k == 0 ? std::vector<Index>{0} : std::vector<Index>{k, k - 1});
  }
  d.damp(kind, low, high);
  return d.spec;
}

Spec contacts(Index n, std::uint64_t seed) { return stack("contacts", n, seed, D::rows, -4, -4); }

Spec block_damping(Index n, std::uint64_t seed) { return stack("block_damping", n, seed, D::block, -3, 1); }

Spec joint_friction(Index n, std::uint64_t seed) {
  Draft d("joint_friction", seed);
  for (Index k = 0; k < n; ++k) d.any_body(k == 0 ? -1 : d.pick());
  for (Index k = 0; k < n; ++k) d.joint_rows(k);
  d.damp(D::rows, -3, 0);
  return d.spec;
}

Spec mass_ratio(Index n, std::uint64_t seed) {
  Draft d("mass_ratio", seed);
  limb(d, -1, n);
  for (Index k = 0; k < n; ++k) d.spec.bodies[static_cast<std::size_t>(k)].mass_decade = k + 1 == n ? 4 : (k % 2 == 0 ? -3 : 0);
  if (n > 0) d.link(C::point, {n - 1});
  if (n > 1) d.link(C::point, {0, n - 1});
  d.damp(D::rows, -4, 0);
  return d.spec;
}

/// An arm with parallel axes stretched out to a bend of 1e-4: its tip hardly moves along the arm.
Spec near_singular(Index n, std::uint64_t seed) {
  Draft d("near_singular", seed);
  limb(d, -1, n);
  for (BodySpec& b : d.spec.bodies) {
    b.axis = {0, 0, 1};
    b.offset = {1, 0, 0};
    b.bend_decade = -4;
  }
  if (n > 0) d.link(C::point, {n - 1});
  d.damp(D::rows, -8, -6);
  return d.spec;
}

Spec several_trees(Index n, std::uint64_t seed) {
  Draft d("several_trees", seed);
  for (Index k = 0; k < n; ++k) d.any_body(k % 3 == 0 ? -1 : k - 1);
  for (Index k = 3; k < n; k += 3) d.link(k % 2 == 0 ? C::weld : C::point, {k - 1, k});
  for (Index k = 0; k + 1 < n; k += 4) d.link(C::generic, {k, n - 1}).rows = 2;
  d.damp(D::rows, -4, 0);
  return d.spec;
}

/// What exposes every transposed index: rows that are not antisymmetric, constraints between parent and child, joints
/// of unequal sizes, armature and rows on one joint, loops that share a link, three-link constraints.
Spec generic_pool(Index n, std::uint64_t seed) {
  Draft d("generic", seed);
  for (Index k = 0; k < n; ++k) d.any_body(k == 0 ? -1 : d.pick()).armature_decade = k % 2 == 0 ? std::optional(-1) : std::nullopt;
  if (n > 0) d.link(C::generic, {0}).rows = 2;
  if (n > 1) d.link(C::generic, {std::max<Index>(0, d.spec.bodies.back().parent), n - 1}).rows = 3;
  for (Index k = 1; k + 2 < n; k += 2) {
    d.link(C::generic, {k, k + 2}).rows = 1;
    d.link(C::generic, {k + 2, 0, k + 1}).rows = 2;
  }
  for (Index k = 0; k < n; k += 2) {
    d.joint_rows(k);
    d.joint_rows(k, 2);
  }
  d.damp(D::rows, -2, 1);
  return d.spec;
}

/// Massless intermediate links with armature or a massive child: what a joint split in two looks like.
Spec massless(Index n, std::uint64_t seed) {
  Draft d("massless", seed);
  limb(d, -1, n);
  for (Index k = 0; k + 1 < n; k += 2) {
    BodySpec& b = d.spec.bodies[static_cast<std::size_t>(k)];
    b.mass_decade.reset();
    b.armature_decade = 0;
  }
  if (n > 0) d.link(C::point, {n - 1});
  if (n > 1) d.link(C::generic, {0, n - 1}).rows = 2;
  d.damp(D::rows, -3, 0);
  return d.spec;
}

/// Hard rows of full rank: a foot fixed at a point, and every third joint locked.
Spec hard(Index n, std::uint64_t seed) {
  Draft d("hard", seed);
  d.body(-1, floating);
  const Index tip = limb(d, 0, n - 1);
  d.link(C::point, {tip});
  for (Index k = 2; k <= tip; k += 3) d.joint_rows(k);
  d.damp(D::zero, 0, 0);
  return d.spec;
}

/// Hard rows beside damped ones.
Spec partly_hard(Index n, std::uint64_t seed) {
  Spec s = hard(n, seed);
  s.family = "partly_hard";
  for (JointConstraintSpec& c : s.joints) c.damping.kind = D::rows;
  Draft more("partly_hard", seed + 1);
  more.link(C::contact, {0});
  more.damp(D::rows, -3, 0);
  s.links.push_back(more.spec.links[0]);
  return s;
}

Spec hard_redundant(Index n, std::uint64_t seed) {
  Spec s = redundant(n, seed);
  s.family = "hard_redundant";
  for (LinkConstraintSpec& c : s.links) c.damping.kind = D::zero;
  return s;
}

Spec no_rows(Index n, std::uint64_t seed) {
  Draft d("no_rows", seed);
  for (Index k = 0; k < n; ++k) d.any_body(k - 1);
  return d.spec;
}

Spec no_bodies(Index, std::uint64_t seed) { return Draft("no_bodies", seed).spec; }

std::vector<FamilyRow> common_families() {
  return {
      {"chain", "fixed base, revolute joints, its tip held", chain, {1, 2, 3, 8, 30}, 3},
      {"swimmer", "free base, revolute joints, both ends held", swimmer, {1, 2, 8, 24}, 2},
      {"star", "free hub, a contact at every arm", star, {2, 4, 12}, 3},
      {"comb", "a spine with a tooth at every body, loops between them", comb, {2, 6, 20}, 4},
      {"random_tree", "random parents, every joint kind, mixed constraints", random_tree, {1, 2, 5, 12, 24}, 4},
      {"humanoid", "free trunk, limbs, four contacts per foot, hands joined, joint friction", humanoid, {10, 26}, 6},
      {"four_bar", "planar four-bar linkages: one dependent row per loop", four_bar, {4, 10, 22}, 4},
      {"ring", "a free chain welded into a ring, and a chord", ring, {2, 4, 12}, 3},
      {"lattice", "free bodies on a square grid joined at points", lattice, {4, 9, 16}, 4},
      {"redundant", "coincident and dependent rows", redundant, {2, 5, 10}, 2},
      {"contacts", "a stack of free bodies, four contacts per pair", contacts, {1, 3, 8}, 2},
      {"joint_friction", "one row per degree of freedom of every joint", joint_friction, {1, 4, 16}, 4},
      {"mass_ratio", "masses from 1e-3 to 1e4 kg, the heaviest at the tip", mass_ratio, {2, 4, 10}, 3},
      {"near_singular", "an arm stretched to a bend of 1e-4", near_singular, {2, 3, 6}, 3},
      {"several_trees", "trees coupled by constraints, each about its own point", several_trees, {4, 9, 18}, 5},
      {"mixed_damping", "the humanoid with R⁻¹ from 1e-8 to 1e12", mixed_damping, {10, 18}, 6},
      {"block_damping", "3×3 blocks of R⁻¹ over four decades", block_damping, {1, 3, 6}, 2},
      {"massless", "massless links between massive ones", massless, {2, 5, 12}, 3},
      {"generic", "the pool that exposes transposed indices", generic_pool, {1, 2, 4, 5, 8, 13}, 5},
      {"hard", "R⁻¹ = 0, independent rows", hard, {1, 3, 9, 20}, 4},
      {"partly_hard", "R⁻¹ = 0 for some rows", partly_hard, {3, 9}, 4},
      {"hard_redundant", "R⁻¹ = 0, dependent rows: A is singular", hard_redundant, {2, 5}, 2, false},
      {"no_rows", "no constraint", no_rows, {1, 4}, 2},
      {"no_bodies", "nothing", no_bodies, {0}, 0},
  };
}

std::vector<FamilyRow> joined(std::vector<FamilyRow> first, const std::vector<FamilyRow>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

}  // namespace

const std::vector<FamilyRow>& families() {
  static const std::vector<FamilyRow> table = joined(joined(common_families(), hard_families()), linkage_families());
  return table;
}

const FamilyRow& find_family(std::string_view name) {
  for (const FamilyRow& row : families())
    if (row.name == name) return row;
  throw ModelError("", "family", "there is no family " + in_quotes(name), accepted_names(name, families()) + "; `delassus list families` says what each is");
}

}  // namespace delassus::generators
