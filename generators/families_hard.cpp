// Hard cases: extreme damping, mass and length, singular postures, far points, deep loops.
#include "generators/families_hard.h"

#include <algorithm>

#include "algorithms/errors/status.h"
#include "generators/draft.h"

namespace delassus::generators {
namespace {

using enum JointKind;
using C = ConstraintKind;
using D = DampingKind;

/// A common family with other damping: R⁻¹ between two decades.
Spec damped(std::string_view base, std::string_view name, Index n, std::uint64_t seed, int low, int high) {
  Spec s = find_family(base).make(n, seed);
  s.family = name;
  const auto set = [&](DampingSpec& d) { d = {D::rows, low, high, d.seed}; };
  for (LinkConstraintSpec& c : s.links) set(c.damping);
  for (JointConstraintSpec& c : s.joints) set(c.damping);
  return s;
}

/// A common family in other units: lengths, masses and R⁻¹ moved by whole decades, so that the machine stays similar. R⁻¹
/// stays within 10^±300.
Spec scaled(std::string_view base, std::string_view name, Index n, std::uint64_t seed, int length, int mass) {
  Spec s = find_family(base).make(n, seed);
  s.family = name;
  for (BodySpec& b : s.bodies) {
    b.length_decade += length;
    if (b.mass_decade) *b.mass_decade += mass;
    if (b.armature_decade) *b.armature_decade += mass + 2 * length;
  }
  for (LinkConstraintSpec& c : s.links) {
    c.damping.low = std::clamp(c.damping.low - mass, -300, 300);
    c.damping.high = std::clamp(c.damping.high - mass, -300, 300);
  }
  return s;
}

/// A massless rigid boom of 10^length_decade m: what is fixed to its end is that far from `parent`.
Index boom(Draft& d, Index parent, int length_decade) {
  BodySpec& b = d.body(parent, generic);
  b.dof = 0;
  b.mass_decade.reset();
  b.offset = {1, 0, 0};
  b.length_decade = length_decade;
  return d.last();
}

/// All axes along z, joint points one length apart along x, forward or (fold) there and back.
void straighten(Draft& d, bool fold) {
  for (std::size_t k = 0; k < d.spec.bodies.size(); ++k) {
    d.spec.bodies[k].axis = {0, 0, 1};
    d.spec.bodies[k].offset = {fold && k % 2 == 0 ? -1 : 1, 0, 0};
  }
}

// ---- damping ----------------------------------------------------------------------------------------------------

Spec stiffest(Index n, std::uint64_t seed) { return damped("swimmer", "stiffest", n, seed, -14, -14); }
Spec softest(Index n, std::uint64_t seed) { return damped("swimmer", "softest", n, seed, 14, 14); }

Spec uniform_damping(Index n, std::uint64_t seed) {
  const int decade = static_cast<int>(seed * 4 % 15) * 2 - 14;
  return damped("swimmer", "uniform_damping", n, seed, decade, decade);
}

Spec stiff_contacts(Index n, std::uint64_t seed) { return damped("contacts", "stiff_contacts", n, seed, -12, -12); }
Spec mixed_contacts(Index n, std::uint64_t seed) { return damped("contacts", "mixed_contacts", n, seed, -8, 12); }
Spec stiff_redundant(Index n, std::uint64_t seed) { return damped("redundant", "stiff_redundant", n, seed, -10, -10); }
Spec stiff_ring(Index n, std::uint64_t seed) { return damped("ring", "stiff_ring", n, seed, -12, -10); }
Spec stiff_lattice(Index n, std::uint64_t seed) { return damped("lattice", "stiff_lattice", n, seed, -12, -8); }

// ---- contacts ---------------------------------------------------------------------------------------------------

/// A free trunk of 10 kg on four legs of (n − 1)/4 bodies, `points` contacts under each.
Spec legged(std::string_view name, Index n, std::uint64_t seed, int points) {
  Draft d(name, seed);
  d.body(-1, floating).mass_decade = 1;
  for (int leg = 0; leg < 4; ++leg) {
    const Index foot = limb(d, 0, std::max<Index>(1, (n - 1) / 4));
    for (int p = 0; p < points; ++p) d.link(C::contact, {foot});
  }
  d.damp(D::rows, -4, -4);
  return d.spec;
}

Spec quadruped(Index n, std::uint64_t seed) { return legged("quadruped", n, seed, 1); }
Spec quadruped_feet(Index n, std::uint64_t seed) { return legged("quadruped_feet", n, seed, 4); }

/// The stack with every second body of 1e9 kg, the first of 1 kg.
Spec unequal_stack(Index n, std::uint64_t seed) {
  Spec s = find_family("contacts").make(n, seed);
  s.family = "unequal_stack";
  for (std::size_t k = 1; k < s.bodies.size(); k += 2) s.bodies[k].mass_decade = 9;
  return s;
}

// ---- postures ---------------------------------------------------------------------------------------------------

/// Doors on two hinges each, all axes parallel: at least eight of ten rows say nothing new.
Spec parallel_hinges(Index n, std::uint64_t seed) {
  Draft d("parallel_hinges", seed);
  limb(d, -1, n);
  straighten(d, false);
  for (Index k = 1; k < n; k += 2)
    for (int hinge = 0; hinge < 2; ++hinge) d.link(C::hinge, {k - 1, k});
  d.link(C::weld, {n - 1});
  d.damp(D::rows, -8, -6);
  return d.spec;
}

/// An arm along x held at a point 10^bend m off its line.
Spec arm(std::string_view name, Index n, std::uint64_t seed, bool fold, int bend, int low, int high) {
  Draft d(name, seed);
  limb(d, -1, n);
  straighten(d, fold);
  d.link(C::point, {boom(d, n - 1, bend)});
  d.damp(D::rows, low, high);
  return d.spec;
}

Spec stretched(Index n, std::uint64_t seed) { return arm("stretched", n, seed, false, -9, -10, -8); }
Spec folded(Index n, std::uint64_t seed) { return arm("folded", n, seed, true, -6, -10, -8); }

// ---- masses -----------------------------------------------------------------------------------------------------

/// n revolute bodies with masses 10^mass(k), held at the tip.
template <class Mass> Spec weighted(std::string_view name, Index n, std::uint64_t seed, int damping, Mass mass) {
  Draft d(name, seed);
  limb(d, -1, n);
  for (Index k = 0; k < n; ++k) d.spec.bodies[static_cast<std::size_t>(k)].mass_decade = mass(k);
  d.link(C::point, {n - 1});
  if (n > 2) d.link(C::point, {0, n - 2});
  d.damp(D::rows, damping, damping + 2);
  return d.spec;
}

Spec heavy_tip(Index n, std::uint64_t seed) {
  return weighted("heavy_tip", n, seed, -4, [n](Index k) { return k + 1 == n ? 6 : -6; });
}
Spec heavy_base(Index n, std::uint64_t seed) {
  return weighted("heavy_base", n, seed, -4, [](Index k) { return k == 0 ? 6 : -6; });
}

/// Every other link of 1e-12 kg, its joint with a rotor of 1e-10 kg m².
Spec near_massless(Index n, std::uint64_t seed) {
  Spec s = weighted("near_massless", n, seed, -4, [](Index k) { return k % 2 == 0 ? -12 : 0; });
  for (std::size_t k = 0; k < s.bodies.size(); k += 2) s.bodies[k].armature_decade = -10;
  return s;
}

// ---- many bodies, many loops ------------------------------------------------------------------------------------

Spec long_chain(Index n, std::uint64_t seed) {
  Draft d("long_chain", seed);
  const Index tip = limb(d, -1, n);
  d.link(C::point, {tip});
  d.link(C::point, {tip / 2});
  d.damp(D::rows, -6, -6);
  return d.spec;
}

/// Closures (k, n − 1 − k): each loop goes round all the inner ones; and a row that couples three of their bodies.
Spec nested_loops(Index n, std::uint64_t seed) {
  Draft d("nested_loops", seed);
  d.body(-1, floating);
  limb(d, 0, n - 1);
  for (Index k = 0; k < n - 1 - k; ++k) d.link(C::point, {k, n - 1 - k});
  if (n > 2) d.link(C::generic, {0, n / 2, n - 1});
  d.damp(D::rows, -6, -4);
  return d.spec;
}

/// Two rails from one base, joined by a rung at every step.
Spec rungs(Index n, std::uint64_t seed) {
  Draft d("rungs", seed);
  d.body(-1, floating);
  Index left = 0, right = 0;
  for (Index k = 0; k < std::max<Index>(1, n / 2); ++k) {
    left = limb(d, left, 1);
    right = limb(d, right, 1);
    d.link(C::point, {left, right});
  }
  d.damp(D::rows, -8, -4);
  return d.spec;
}

/// Free bodies joined by rods: three to the next, two to the next but one; the first welded to the ground.
Spec truss(Index n, std::uint64_t seed) {
  Draft d("truss", seed);
  for (Index k = 0; k < n; ++k) d.body(-1, floating);
  d.link(C::weld, {0});
  for (Index k = 1; k < n; ++k) {
    for (int rod = 0; rod < 3; ++rod) d.link(C::distance, {k - 1, k});
    for (int rod = 0; rod < 2 && k > 1; ++rod) d.link(C::distance, {k - 2, k});
  }
  d.damp(D::rows, -8, -6);
  return d.spec;
}

// ---- distances and units ----------------------------------------------------------------------------------------

/// A free robot held at a point 10^decade m away from it.
Spec held_from_afar(std::string_view name, Index n, std::uint64_t seed, int decade) {
  Draft d(name, seed);
  d.body(-1, floating);
  const Index tip = limb(d, 0, n - 1);
  d.link(C::contact, {0});
  d.link(C::point, {boom(d, tip, decade)});
  d.damp(D::rows, -4, -2);
  return d.spec;
}

Spec far_point(Index n, std::uint64_t seed) { return held_from_afar("far_point", n, seed, 3); }
Spec farthest_point(Index n, std::uint64_t seed) { return held_from_afar("farthest_point", n, seed, 9); }

/// Robots of two bodies, each tied to the next at a point 1 m, 1 km, 1000 km or 10⁶ km from it.
Spec large_world(Index n, std::uint64_t seed) {
  Draft d("large_world", seed);
  Index before = -1;
  for (Index k = 0; 2 * k < n; ++k) {
    d.body(-1, floating);
    const Index hand = limb(d, d.last(), 1);
    const Index point = boom(d, hand, static_cast<int>(k % 4) * 3);
    if (before >= 0) d.link(C::point, {before, point});
    d.link(C::contact, {hand});
    before = point;
  }
  d.damp(D::rows, -4, -2);
  return d.spec;
}

/// A robot whose quantities are taken about a point 1 km away, as world coordinates do.
Spec world_frame(Index n, std::uint64_t seed) {
  Draft d("world_frame", seed);
  const Index origin = boom(d, -1, 0);
  const Index place = boom(d, origin, 3);
  d.body(place, floating);
  const Index tip = limb(d, d.last(), n - 1);
  d.link(C::contact, {tip});
  d.link(C::point, {d.last()});
  d.damp(D::rows, -4, -2);
  return d.spec;
}

Spec micrometre(Index n, std::uint64_t seed) { return scaled("swimmer", "micrometre", n, seed, -6, -15); }
Spec kilometre(Index n, std::uint64_t seed) { return scaled("swimmer", "kilometre", n, seed, 3, 12); }
/// Here n is the decade: 10^307 kg is the largest mass there is, 10^-320 kg about the smallest.
int decade(Index n, Index most) {
  if (n < 0 || n > most) throw ModelError("", "n", "10^±" + std::to_string(n) + " kg is no number in double", "0 to " + std::to_string(most) + "; n is the power of ten here");
  return static_cast<int>(n);
}
Spec tiny_numbers(Index n, std::uint64_t seed) { return scaled("swimmer", "tiny_numbers", 3, seed, 0, -decade(n, 320)); }
Spec huge_numbers(Index n, std::uint64_t seed) { return scaled("swimmer", "huge_numbers", 3, seed, 0, decade(n, 307)); }

/// Links of 1 cm and 1 mg to 100 m and 1000 t, turning and sliding, rows in newton and newton metre.
Spec mixed_units(Index n, std::uint64_t seed) {
  Draft d("mixed_units", seed);
  for (Index k = 0; k < n; ++k) {
    BodySpec& b = d.body(k - 1, k % 2 == 0 ? revolute : prismatic);
    b.length_decade = static_cast<int>(k % 3) * 2 - 2;
    b.mass_decade = 3 * b.length_decade;
  }
  d.link(C::weld, {n - 1});
  d.link(C::contact, {n / 2});
  for (Index k = 0; k < n; k += 2) d.joint_rows(k);
  d.damp(D::rows, -6, 2);
  return d.spec;
}

}  // namespace

std::vector<FamilyRow> hard_families() {
  return {
      {"stiffest", "the swimmer with R⁻¹ = 1e-14", stiffest, {4}, 2},
      {"softest", "the swimmer with R⁻¹ = 1e14", softest, {4}, 1},
      {"uniform_damping", "the swimmer with one R⁻¹ from 1e-14 to 1e14, by the seed", uniform_damping, {5}, 2},
      {"stiff_contacts", "the stack with R⁻¹ = 1e-12", stiff_contacts, {3}, -1},
      {"mixed_contacts", "the stack with R⁻¹ from 1e-8 to 1e12", mixed_contacts, {3}, -1},
      {"stiff_redundant", "coincident and dependent rows with R⁻¹ = 1e-10", stiff_redundant, {4}, 2},
      {"stiff_ring", "the ring with R⁻¹ from 1e-12 to 1e-10", stiff_ring, {5}, 2},
      {"stiff_lattice", "the lattice with R⁻¹ from 1e-12 to 1e-8", stiff_lattice, {4}, -1},
      {"quadruped", "a free trunk on four legs, a contact under each", quadruped, {5, 13}, -1},
      {"quadruped_feet", "a free trunk on four legs, four contacts under each", quadruped_feet, {5}, -1},
      {"unequal_stack", "the stack with bodies of 1 kg and 1e9 kg in turn", unequal_stack, {2}, -1},
      {"parallel_hinges", "doors on two hinges each, all axes parallel", parallel_hinges, {4}, 2},
      {"stretched", "a straight arm held 1e-9 m off its line", stretched, {2, 5}, 2},
      {"folded", "an arm folded on itself, held 1e-6 m off its line", folded, {2, 5}, 2},
      {"heavy_tip", "1e6 kg at the end of links of 1e-6 kg", heavy_tip, {2, 5}, 2},
      {"heavy_base", "links of 1e-6 kg on a base of 1e6 kg", heavy_base, {2, 5}, 2},
      {"near_massless", "links of 1e-12 kg between links of 1 kg", near_massless, {2, 5}, 2},
      {"long_chain", "a chain of up to 10⁴ joints held at two points", long_chain, {40}, 3},
      {"nested_loops", "closures round closures", nested_loops, {8}, 3},
      {"rungs", "two rails with a rung at every step", rungs, {9}, 3},
      {"truss", "free bodies joined by rods", truss, {5}, 2},
      {"far_point", "a free robot held at a point 1 km away", far_point, {4}, 2},
      {"farthest_point", "a free robot held at a point 10⁶ km away", farthest_point, {4}, 2},
      {"large_world", "robots tied at points 1 m to 10⁶ km away", large_world, {8}, -1},
      {"world_frame", "a robot described from a point 1 km away", world_frame, {4}, 2},
      {"micrometre", "the swimmer at lengths of 1e-6 m", micrometre, {4}, 2},
      {"kilometre", "the swimmer at lengths of 1 km", kilometre, {4}, 2},
      {"mixed_units", "links of 1 cm and 1 mg to 100 m and 1000 t", mixed_units, {6}, 2},
      {"tiny_numbers", "a swimmer with masses of 10^-n kg", tiny_numbers, {30}, 3},
      {"huge_numbers", "a swimmer with masses of 10^n kg", huge_numbers, {30}, 3},
  };
}

}  // namespace delassus::generators
