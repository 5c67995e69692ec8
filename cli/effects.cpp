#include "cli/effects.h"

#include <cmath>

#include "bench/text.h"

namespace delassus::cli {

namespace {

using Kind = Constraint::Kind;

struct Counts {
  Index contacts = 0, friction_contacts = 0, loops = 0, closures = 0, friction_rows = 0, lock_rows = 0, couplings = 0;
  Index limits = 0, limit_rows = 0, damped = 0, friction_joints = 0, armature = 0;
};

bool any(const std::vector<double>& values, bool (*test)(double)) {
  for (const double v : values)
    if (test(v)) return true;
  return false;
}

Counts count(const Scene& scene) {
  Counts n;
  for (const Constraint& c : scene.model.constraints) {
    n.contacts += c.kind == Kind::contact;
    n.friction_contacts += c.kind == Kind::contact && c.friction > 0;
    n.loops += c.loop;
    n.couplings += c.kind == Kind::coupling;
    if (c.kind == Kind::joint_friction) n.friction_rows += row_count(scene.model, c);
    else if (c.kind == Kind::joint_lock) n.lock_rows += row_count(scene.model, c);
    else if (c.kind == Kind::joint_limit) ++n.limit_rows;
    else if (c.kind != Kind::contact && c.kind != Kind::coupling && !c.loop) ++n.closures;
  }
  const auto positive = +[](double v) { return v > 0; };
  for (const Body& b : scene.model.bodies) {
    n.limits += any(b.joint.lower, +[](double v) { return std::isfinite(v); }) || any(b.joint.upper, +[](double v) { return std::isfinite(v); });
    n.damped += any(b.joint.damping, positive);
    n.friction_joints += any(b.joint.friction, positive);
    n.armature += any(b.joint.armature, positive);
  }
  return n;
}

std::string number(Index n, const char* noun) { return bench::format("%lld %s%s", static_cast<long long>(n), noun, n == 1 ? "" : "s"); }

/// In the order in which a scene's effects are told.
constexpr struct {
  const char *name, *summary;
} effects[] = {{"gravity", "a uniform field; not part of A"},
               {"contacts", "contact points of boxes, feet and ground, 3 rows each"},
               {"contact friction", "a friction coefficient of contacts; the cone is not part of A"},
               {"loops", "closures of kinematic loops, closed by assembly"},
               {"other joints", "further constraints between frames: points, welds, hinges, distances"},
               {"joint friction", "a row per degree of freedom of the joints it is asked for"},
               {"joint locks", "rows that hold joints where they are"},
               {"couplings", "gears and mimic joints, a row each"},
               {"armature", "rotor inertia reflected to joints, on the diagonal of M"},
               {"joint damping", "viscous damping in joints; not part of A"},
               {"joint limits", "one-sided rows of the joint limits they are asked for"}};

}  // namespace

json effects_list() {
  json out = json::array();
  for (const auto& e : effects) out.push_back({{"name", e.name}, {"summary", e.summary}});
  return out;
}

json effects_json(const Scene& scene) {
  const Counts n = count(scene);
  json out = json::array();
  const auto add = [&](std::string_view name, bool called, const std::string& yes, const std::string& no) {
    require(out.size() < std::size(effects) && name == effects[out.size()].name, "effects_json: not in the order of the table");
    out.push_back({{"name", name}, {"called_for", called}, {"why", called ? yes : no}});
  };
  const std::string not_in_A = "; not part of A";
  add("gravity", scene.has_gravity, bench::format("gravity is (%g, %g, %g) m/s²", scene.gravity[0], scene.gravity[1], scene.gravity[2]) + not_in_A,
      "the scene gives no gravity");
  add("contacts", n.contacts > 0, number(n.contacts, "contact point") + ", 3 rows each", "no contacts");
  add("contact friction", n.friction_contacts > 0, number(n.friction_contacts, "contact") + " with a friction coefficient; the cone is not part of A",
      "no contact has a friction coefficient");
  add("loops", n.loops > 0, number(n.loops, "loop closure") + ", closed by assembly", "no constraint closes a loop");
  add("other joints", n.closures > 0, number(n.closures, "constraint") + " between frames", "no further constraints");
  add("joint friction", n.friction_rows > 0, number(n.friction_rows, "row"),
      n.friction_joints ? number(n.friction_joints, "joint") + " give friction, but the scene asks for no joint_friction rows"
                        : "no joint has friction");
  add("joint locks", n.lock_rows > 0, number(n.lock_rows, "row"), "no joint is locked");
  add("couplings", n.couplings > 0, number(n.couplings, "coupled row") + " (gear or mimic)", "no gear, no mimic joint");
  add("armature", n.armature > 0, number(n.armature, "joint") + " with armature, added to the diagonal of M", "no joint has armature");
  add("joint damping", false, "", n.damped ? number(n.damped, "joint") + " give viscous damping, which A does not contain" : "no joint has viscous damping");
  add("joint limits", n.limit_rows > 0, number(n.limit_rows, "row") + ", one-sided",
      n.limits ? number(n.limits, "joint") + " with limits, but the scene asks for no joint_limit rows" : "no joint has limits");
  return out;
}

}  // namespace delassus::cli
