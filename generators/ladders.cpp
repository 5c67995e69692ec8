#include "generators/ladders.h"

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"
#include "generators/draft.h"

namespace delassus::generators {
namespace {

using enum JointKind;
using C = ConstraintKind;

Spec damped(Draft& d) {
  d.damp(DampingKind::rows, 0, 0);  // R⁻¹ = 1/kg: as many steps at every size, as far as A allows
  return d.spec;
}

Spec chain(Index s) {
  Draft d("chain", 1);
  for (Index k = 0; k < s; ++k) d.body(k - 1), d.link(C::contact, {k});
  return damped(d);
}

/// A complete binary tree with s leaves, one row on each, on a trunk that slides along and turns about x, y, z: the mobility of every
/// body above has full rank. What rounding leaves of a lower one (pv_osimr) would be counted; on the trunk it is exactly zero. A row on
/// each of its bodies keeps them apart.
Spec tree(Index s) {
  Draft d("tree", 1);
  for (int k = 0; k < 7; ++k) {
    BodySpec& b = d.body(k - 1, k == 0 || k > 3 ? revolute : prismatic);
    b.axis = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
    b.offset = {0, 0, 0};
    d.link(C::plane, {k});
  }
  for (Index k = 1; k < 2 * s; ++k) d.body(k == 1 ? 6 : k / 2 + 6);
  for (Index k = s; k < 2 * s; ++k) d.link(C::plane, {k + 6});
  return damped(d);
}

/// s humanoids of 26 bodies in a line, four contacts per foot, each with a hand on the next one's.
Spec crowd(Index s) {
  Draft d("crowd", 1);
  Index hand = -1;
  for (Index k = 0; k < s; ++k) {
    d.body(-1, floating).mass_decade = 1;
    const Index trunk = d.last();
    d.body(trunk);
    for (int leg = 0; leg < 2; ++leg) {
      const Index foot = limb(d, trunk, 6);
      for (int c = 0; c < 4; ++c) d.link(C::contact, {foot});
    }
    const Index left = limb(d, trunk, 6), right = limb(d, trunk, 6);
    if (hand >= 0) d.link(C::contact, {hand, left});
    hand = right;
  }
  return damped(d);
}

/// Four contacts between two boxes, or with the ground.
void rests(Draft& d, Index box, Index below, int contacts = 4) {
  for (int c = 0; c < contacts; ++c) d.link(C::contact, below < 0 ? std::vector<Index>{box} : std::vector<Index>{box, below});
}

Spec tower(Index s) {
  Draft d("tower", 1);
  for (Index k = 0; k < s; ++k) d.body(-1, floating), rests(d, k, k - 1);
  return damped(d);
}

/// s layers of s bricks in running bond: a brick rests on two, by two contacts each.
Spec wall(Index s) {
  Draft d("wall", 1);
  for (Index layer = 0; layer < s; ++layer)
    for (Index k = 0; k < s; ++k) {
      d.body(-1, floating);
      const Index brick = d.last(), beside = k + (layer % 2 == 0 ? 1 : -1);
      if (layer == 0) rests(d, brick, -1);
      if (layer == 0) continue;
      rests(d, brick, brick - s, 2);
      if (beside >= 0 && beside < s) rests(d, brick, (layer - 1) * s + beside, 2);
    }
  return damped(d);
}

/// s layers of s², (s − 1)², …, 1 boxes; each rests on four, by one contact on each.
Spec pyramid(Index s) {
  Draft d("pyramid", 1);
  for (Index side = s, below = -1; side > 0; --side) {
    const Index first = d.last() + 1;
    for (Index k = 0; k < side * side; ++k) {
      d.body(-1, floating);
      if (below < 0) rests(d, d.last(), -1);
      for (const Index corner : {Index{0}, Index{1}, side + 1, side + 2})
        if (below >= 0) rests(d, d.last(), below + k / side * (side + 1) + k % side + corner, 1);
    }
    below = first;
  }
  return damped(d);
}

/// s × s free bodies, neighbours joined at a point: loops wherever one looks, and any order of elimination is allowed.
Spec lattice(Index s) {
  Draft d("lattice", 1);
  for (Index k = 0; k < s * s; ++k) d.body(-1, floating);
  for (Index k = 0; k < s * s; ++k) {
    if (k % s + 1 < s) d.link(C::point, {k, k + 1});
    if (k + s < s * s) d.link(C::point, {k, k + s});
  }
  return damped(d);
}

/// Two chains of s links; row k joins link k of one with link s − 1 − k of the other, so that every loop crosses every other.
Spec crossed(Index s) {
  Draft d("crossed", 1);
  limb(d, -1, s);
  limb(d, -1, s);
  for (Index k = 0; k < s; ++k) d.link(C::distance, {k, 2 * s - 1 - k});
  return damped(d);
}

/// s loops in series: a loop of `bars` bars starts on the middle one of the loop before.
template <Index bars> Spec loops(Index s) {
  Draft d("loops_" + std::to_string(bars), 1);
  d.body(-1);
  Index base = 0;
  for (Index k = 0; k < s; ++k) {
    const Index first = d.last() + 1, last = limb(d, base, bars - 1);
    d.link(C::point, {base, last});
    base = first + bars / 2 - 1;
  }
  return damped(d);
}

constexpr Index rows_bodies = 16, depth_bodies = 256;

/// A chain of 16 links with s rows, dealt out from the root.
Spec rows(Index s) {
  Draft d("rows", 1);
  limb(d, -1, rows_bodies);
  for (Index k = 0; k < s; ++k) d.link(C::plane, {k % rows_bodies});
  return damped(d);
}

/// 256 links in chains of s, eight rows on the tip of the first.
Spec depth(Index s) {
  Draft d("depth", 1);
  for (Index k = 0; k < depth_bodies / s; ++k) limb(d, -1, s);
  for (int k = 0; k < 8; ++k) d.link(C::plane, {s - 1});
  return damped(d);
}

}  // namespace

const std::vector<LadderRow>& ladders() {
  static const std::vector<LadderRow> table{
      {"chain", "links", "three rows per link", "n, m and d grow together: the worst tree for whoever pays for depth", chain, 8, 8192, 2048, {0, 1, 2, 3}},
      {"tree", "leaves", "one row per leaf, a trunk of 7 links", "a binary tree: n and m grow, the depth is a logarithm", tree, 2, 8192, 256, {0, 1, 1, 1, 2, 2, 3}},
      {"crowd", "humanoids", "26 bodies and 24 rows per robot, 3 between two", "many small trees: does the work of one robot depend on the others?", crowd, 1, 1024, 128, {0, 1, 2, 3}},
      {"tower", "boxes", "12 rows between two", "free bodies in a line, coupled", tower, 2, 8192, 512, {0, 1, 2, 3}},
      {"wall", "layers, and bricks per layer", "6 rows between two", "free bodies in a plane, coupled to 10⁴ of them", wall, 2, 96, 16, {}},
      {"pyramid", "layers", "3 rows between two", "free bodies in space, coupled: s³/3 of them", pyramid, 2, 32, 8, {}},
      {"lattice", "side", "3 rows between neighbours", "as many loops as bodies, in any order of elimination", lattice, 2, 96, 16, {}},
      {"crossed", "links of each chain", "one row per pair", "every loop crosses every other: the O(m² d) of the worst case", crossed, 4, 1024, 256, {0, 1, 2, 3}},
      {"loops_4", "loops", "4 bars and 3 rows per loop", "local loops in series, ever deeper", loops<4>, 4, 4096, 512, {0, 1, 2, 3}},
      {"loops_6", "loops", "6 bars and 3 rows per loop", "the same, longer loops", loops<6>, 4, 2048, 512, {0, 1, 2, 3}},
      {"loops_8", "loops", "8 bars and 3 rows per loop", "the same, longer still", loops<8>, 4, 2048, 512, {0, 1, 2, 3}},
      {"rows", "rows", "16 links", "what a row costs", rows, 16, 16384, 2048, {0, 1, 2, 3}},
      {"depth", "links per chain", "256 links, 8 rows on one tip", "what depth alone costs", depth, 4, 256, 256, {-1, 0, 1, 2, 3}},
  };
  return table;
}

const LadderRow& find_ladder(std::string_view name) {
  for (const LadderRow& row : ladders())
    if (row.name == name) return row;
  throw ModelError("", "ladder", "there is no ladder " + in_quotes(name), accepted_names(name, ladders()) + "; `delassus bench --ladders` without names takes all of them");
}

}  // namespace delassus::generators
