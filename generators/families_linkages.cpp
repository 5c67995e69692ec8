// Linkages with hard rows: joint points and axes of small integers, chosen so that the loops close exactly.
#include "generators/families_linkages.h"

#include <algorithm>
#include <array>

#include "generators/draft.h"

namespace delassus::generators {
namespace {

using enum JointKind;
using C = ConstraintKind;
using D = DampingKind;
using Whole = std::array<int, 3>;

constexpr Whole x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};

/// One linkage being written below a base.
class Linkage {
 public:
  Linkage(Draft& to, Index base) : d_(to), base_(base), decade_(to.random.integer(-1, 0)) {}

  /// A link on a joint at `offset` from its parent's joint point.
  Index link(Index parent, const Whole& offset, const Whole& axis = z_axis, JointKind kind = revolute) {
    BodySpec& b = d_.body(parent, kind);
    b.axis = axis;
    b.offset = offset;
    b.length_decade = decade_;
    b.mass_decade = d_.random.integer(-1, 0);
    return d_.last();
  }
  Index on_base(const Whole& offset, const Whole& axis = z_axis, JointKind kind = revolute) { return link(base_, offset, axis, kind); }
  Index driver(const Whole& offset, const Whole& axis = z_axis) {
    const Index i = on_base(offset, axis);
    d_.joint_rows(i);
    return i;
  }
  /// A hinge at `at` from the joint point of a.
  void close(Index a, Index b, const Whole& at, const Whole& axis = z_axis) {
    LinkConstraintSpec& c = d_.link(C::hinge, {a, b});
    c.at = at;
    c.axis = axis;
  }
  [[nodiscard]] Index base() const { return base_; }

 private:
  Draft& d_;
  Index base_;
  int decade_;
};

/// A (0, 0) B (1, 2) C (4, 3) D (5, 0).
void four_bar(Linkage& l) {
  const Index crank = l.driver({0, 0, 0}), coupler = l.link(crank, {1, 2, 0}), rocker = l.on_base({5, 0, 0});
  l.close(coupler, rocker, {3, 1, 0});
}

/// Crank to (3, 4), rod to a slider along x at (10, 0).
void slider_crank(Linkage& l) {
  const Index crank = l.driver({0, 0, 0}), rod = l.link(crank, {3, 4, 0}), slider = l.on_base({10, 0, 0}, x_axis, prismatic);
  l.close(rod, slider, {7, -4, 0});
}

/// T. Jansen's leg: crank to A (2, 1), pivot G (−5, −1), B (−4, 5), C (−9, 2), D (−3, −6), E (−8, −5).
void jansen(Linkage& l) {
  const Index crank = l.driver({0, 0, 0}), upper = l.link(crank, {2, 1, 0}), lower = l.link(crank, {2, 1, 0});
  const Index beam = l.on_base({-5, -1, 0}), strut = l.on_base({-5, -1, 0});
  const Index rod = l.link(beam, {-4, 3, 0}), foot = l.link(strut, {2, -5, 0});
  l.close(upper, beam, {-6, 4, 0});
  l.close(lower, foot, {-5, -7, 0});
  l.close(rod, foot, {1, -7, 0});
}

/// Four axes of one family of lines on the surface z = x y: three of them span all.
void bennett(Linkage& l) {
  const Index first = l.driver({0, 0, 0}, {0, 1, 0}), second = l.link(first, {1, 0, 0}, {0, 1, 1}), third = l.link(second, {1, 0, 0}, {0, 1, 2});
  l.close(third, l.base(), {1, 0, 0}, {0, 1, 3});
}

/// A plate that two pairs of links, hinged along x and along y, let move along z only.
void sarrus(Linkage& l) {
  const Index a = l.driver({0, 3, 0}, x_axis), b = l.link(a, {0, 2, 2}, x_axis), plate = l.link(b, {0, -2, 2}, x_axis);
  const Index c = l.on_base({3, 0, 0}, y_axis), d = l.link(c, {2, 0, 2}, y_axis);
  l.close(d, plate, {-2, 0, 2}, y_axis);
}

/// A platform on three legs of two links, the first of each driven.
void planar_robot(Linkage& l) {
  const Index u = l.driver({0, 0, 0}), v = l.driver({9, 0, 0}), w = l.driver({4, 10, 0});
  const Index platform = l.link(l.link(u, {-1, 3, 0}), {3, 1, 0});  // at (2, 4)
  l.close(l.link(v, {1, 3, 0}), platform, {-4, 1, 0});              // elbow (10, 3), platform (6, 4)
  l.close(l.link(w, {3, -1, 0}), platform, {-3, -2, 0});            // elbow (7, 9), platform (4, 7)
}

struct Kind {
  std::string_view name, summary;
  void (*write)(Linkage&);
  Index bodies, mobility;
};

constexpr std::array kinds{
    Kind{"crank_rocker", "four-bar linkages closed by hinges, R⁻¹ = 0", four_bar, 3, 1},
    Kind{"slider_crank", "slider-cranks closed by hinges, R⁻¹ = 0", slider_crank, 3, 1},
    Kind{"jansen", "Jansen's leg: three planar loops, R⁻¹ = 0", jansen, 7, 1},
    Kind{"bennett", "four skew hinges that move all the same, R⁻¹ = 0", bennett, 3, 1},
    Kind{"sarrus", "a plate led along a line by hinges, R⁻¹ = 0", sarrus, 5, 1},
    Kind{"planar_robot", "platforms in a plane on three legs, R⁻¹ = 0", planar_robot, 7, 3},
};

Spec linkages(const Kind& kind, Index n, std::uint64_t seed) {
  Draft d(kind.name, seed);
  const bool free = d.random.coin();
  d.body(-1, free ? floating : generic).dof = 0;  // links on the ground itself would each have their own reference point
  for (Index k = 0; k < std::max<Index>(1, (n - 1) / kind.bodies); ++k) {
    Linkage l(d, 0);
    kind.write(l);
  }
  d.damp(D::zero, 0, 0);
  if (seed % 2 == 0)
    for (JointConstraintSpec& c : d.spec.joints) c.damping = {D::rows, -4, 0, c.damping.seed};
  if (seed % 4 != 1) d.spec.turn = seed;
  return d.spec;
}

template <std::size_t k> Spec make(Index n, std::uint64_t seed) { return linkages(kinds[k], n, seed); }

template <std::size_t k> FamilyRow row() {
  return {kinds[k].name, kinds[k].summary, make<k>, {kinds[k].bodies + 1, 2 * kinds[k].bodies + 1}, kinds[k].bodies + 1, false};
}

}  // namespace

std::vector<FamilyRow> linkage_families() { return {row<0>(), row<1>(), row<2>(), row<3>(), row<4>(), row<5>()}; }

Spec any_linkage(std::uint64_t seed) {
  Random r(seed ^ 0x11a6e);
  const Kind& kind = kinds[static_cast<std::size_t>(r.integer(0, static_cast<int>(kinds.size()) - 1))];
  Spec s = linkages(kind, r.integer(1, 2) * kind.bodies + 1, seed);
  s.turn = seed;
  if (r.integer(1, 4) == 1)
    for (LinkConstraintSpec& c : s.links)
      if (r.coin()) c.damping = {D::rows, -6, 0, c.damping.seed};
  return s;
}

Index mobility(const Spec& spec) {
  for (const Kind& kind : kinds) {
    if (spec.family != kind.name) continue;
    const bool free = spec.bodies[0].joint == floating;
    return (free ? 6 : 0) + (static_cast<Index>(spec.bodies.size()) - 1) / kind.bodies * kind.mobility;
  }
  return -1;
}

}  // namespace delassus::generators
