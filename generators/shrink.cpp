#include "generators/shrink.h"

#include <algorithm>

namespace delassus::generators {
namespace {

using C = ConstraintKind;

/// New number of every body when [at, at + count) go: of a dropped body, that of its nearest ancestor left, or −1.
std::vector<Index> renumbering(const Spec& spec, std::size_t at, std::size_t count) {
  std::vector<Index> to(spec.bodies.size());
  Index next = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Index p = spec.bodies[i].parent;
    const bool dropped = i >= at && i < at + count;
    to[i] = !dropped ? next++ : p < 0 ? -1 : to[static_cast<std::size_t>(p)];
  }
  return to;
}

Spec without_bodies(const Spec& spec, std::size_t at, std::size_t count) {
  const std::vector<Index> to = renumbering(spec, at, count);
  Spec out = spec;
  out.bodies.clear();
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (i >= at && i < at + count) continue;
    out.bodies.push_back(spec.bodies[i]);
    if (const Index p = spec.bodies[i].parent; p >= 0) out.bodies.back().parent = to[static_cast<std::size_t>(p)];
  }
  out.links.clear();
  for (LinkConstraintSpec c : spec.links) {
    std::vector<Index> on;
    for (const Index b : c.bodies)
      if (const Index n = to[static_cast<std::size_t>(b)]; n >= 0 && std::find(on.begin(), on.end(), n) == on.end())
        on.push_back(n);
    c.bodies = on;
    if (!on.empty()) out.links.push_back(c);
  }
  out.joints.clear();
  for (JointConstraintSpec c : spec.joints) {
    const auto b = static_cast<std::size_t>(c.body);
    if (b >= at && b < at + count) continue;
    c.body = to[b];
    out.joints.push_back(c);
  }
  return out;
}

template <class T> void erase(std::vector<T>& from, std::size_t at, std::size_t count) {
  const auto first = from.begin() + static_cast<std::ptrdiff_t>(at);
  from.erase(first, first + static_cast<std::ptrdiff_t>(std::min(count, from.size() - at)));
}

bool fewer_rows(LinkConstraintSpec& c) {
  switch (c.kind) {
    case C::weld:
    case C::hinge: c.kind = C::point; return true;
    case C::contact:
    case C::point: c.kind = C::plane; return true;
    case C::generic: return c.rows > 1 && (--c.rows, true);
    case C::distance:
    case C::plane: return false;
  }
  return false;
}

bool fewer_joint_rows(const Spec& spec, JointConstraintSpec& c) {
  if (c.rows == 0) return dof_count(spec.bodies[static_cast<std::size_t>(c.body)]) > 1 && (c.rows = 1, true);
  return c.rows > 1 && (--c.rows, true);
}

DampingSpec& damping_of(Spec& s, std::size_t at) {
  return at < s.links.size() ? s.links[at].damping : s.joints[at - s.links.size()].damping;
}

/// Assigns; whether it was another value.
template <class T, class U> bool set(T& x, const U& value) {
  const bool other = x != T(value);
  x = T(value);
  return other;
}

bool plain(DampingSpec& d) {
  const bool kind = set(d.kind, DampingKind::rows), low = set(d.low, 0), high = set(d.high, 0), seed = set(d.seed, 0);
  return kind || low || high || seed;
}

bool clear_seed(Spec& s, std::size_t at) {
  if (at < s.bodies.size()) return set(s.bodies[at].seed, 0);
  at -= s.bodies.size();
  return at < s.links.size() ? set(s.links[at].seed, 0) : set(s.joints[at - s.links.size()].seed, 0);
}

/// A move on one body.
bool simplify(BodySpec& b, const Spec& before, MoveKind kind) {
  switch (kind) {
    case MoveKind::reparent: return b.parent >= 0 && set(b.parent, before.bodies[static_cast<std::size_t>(b.parent)].parent);
    case MoveKind::to_revolute: b.dof = 1; return set(b.joint, JointKind::revolute);
    case MoveKind::unit_mass: return set(b.mass_decade, 0);
    case MoveKind::no_armature: return b.mass_decade && set(b.armature_decade, std::nullopt);
    case MoveKind::no_bend: return set(b.bend_decade, std::nullopt);
    case MoveKind::plain_axis: return set(b.axis, std::array<int, 3>{0, 0, 1});
    case MoveKind::plain_offset: return set(b.offset, std::array<int, 3>{1, 0, 0});
    case MoveKind::unit_length: return set(b.length_decade, 0);
    default: return false;
  }
}

/// Pieces of n things: halves, quarters, …, single ones, each size from the end to the beginning.
void add_pieces(std::vector<Move>& out, MoveKind kind, std::size_t n) {
  for (std::size_t count = n; count > 0; count /= 2)
    for (std::size_t end = n; end >= count; end -= count) out.push_back({kind, end - count, count});
}

void add_each(std::vector<Move>& out, MoveKind kind, std::size_t n) {
  for (std::size_t at = 0; at < n; ++at) out.push_back({kind, at});
}

}  // namespace

std::vector<Move> moves(const Spec& spec) {
  const std::size_t bodies = spec.bodies.size(), links = spec.links.size(), joints = spec.joints.size();
  std::vector<Move> out;
  add_pieces(out, MoveKind::drop_links, links);
  add_pieces(out, MoveKind::drop_bodies, bodies);
  add_each(out, MoveKind::drop_joint_rows, joints);
  for (std::size_t e = 0; e < links; ++e)
    for (std::size_t k = spec.links[e].bodies.size(); k > 0; --k) out.push_back({MoveKind::detach, e, k - 1});
  add_each(out, MoveKind::one_row_less, links);
  add_each(out, MoveKind::one_joint_row, joints);
  for (auto k = static_cast<int>(MoveKind::reparent); k <= static_cast<int>(MoveKind::unit_length); ++k)
    add_each(out, static_cast<MoveKind>(k), bodies);
  add_each(out, MoveKind::plain_damping, links + joints);
  add_each(out, MoveKind::zero_seed, bodies + links + joints);
  return out;
}

std::optional<Spec> moved(const Spec& spec, const Move& move) {
  const std::size_t bodies = spec.bodies.size(), links = spec.links.size(), joints = spec.joints.size(), at = move.at;
  Spec out = spec;
  bool changed = true;
  switch (move.kind) {
    case MoveKind::drop_bodies:
      if (at >= bodies) return std::nullopt;
      return without_bodies(spec, at, move.count);
    case MoveKind::drop_links:
      if (at >= links) return std::nullopt;
      erase(out.links, at, move.count);
      break;
    case MoveKind::drop_joint_rows:
      if (at >= joints) return std::nullopt;
      erase(out.joints, at, 1);
      break;
    case MoveKind::detach:
      changed = at < links && spec.links[at].bodies.size() > 1 && move.count < spec.links[at].bodies.size();
      if (changed) erase(out.links[at].bodies, move.count, 1);
      break;
    case MoveKind::one_row_less: changed = at < links && fewer_rows(out.links[at]); break;
    case MoveKind::one_joint_row: changed = at < joints && fewer_joint_rows(spec, out.joints[at]); break;
    case MoveKind::plain_damping: changed = at < links + joints && plain(damping_of(out, at)); break;
    case MoveKind::zero_seed: changed = at < bodies + links + joints && clear_seed(out, at); break;
    default: changed = at < bodies && simplify(out.bodies[at], spec, move.kind); break;
  }
  return changed ? std::optional(std::move(out)) : std::nullopt;
}

Shrunk shrink(Spec spec, const std::function<bool(const Spec&)>& still_fails, int most_tries) {
  Shrunk s{std::move(spec)};
  for (int before = -1; s.finished && before != s.kept;) {
    before = s.kept;
    for (const Move& move : moves(s.spec)) {
      std::optional<Spec> next = moved(s.spec, move);
      if (!next) continue;
      if (s.tried == most_tries) {
        s.finished = false;
        break;
      }
      ++s.tried;
      if (!still_fails(*next)) continue;
      ++s.kept;
      s.spec = std::move(*next);
    }
  }
  return s;
}

}  // namespace delassus::generators
