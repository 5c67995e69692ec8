#include "simulation/effects.h"

#include <algorithm>
#include <cmath>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"
#include "simulation/effects/actuation.h"
#include "simulation/effects/armature.h"
#include "simulation/effects/contacts.h"
#include "simulation/effects/gravity.h"
#include "simulation/effects/joint_rows.h"
#include "simulation/effects/sleeping.h"
#include "simulation/effects/spin_friction.h"
#include "simulation/effects/springs.h"
#include "simulation/effects/velocity_products.h"
#include "simulation/effects/wrenches.h"
#include "simulation/plan.h"

namespace delassus::simulation {
namespace {

using Kind = Constraint::Kind;

std::string plural(const std::string& noun) { return noun + (noun.ends_with("ch") ? "es" : "s"); }
std::string counted(std::size_t n, const std::string& noun) { return std::to_string(n) + " " + (n == 1 ? noun : plural(noun)); }

/// " (scene.yaml:3)" of a key of the scene.
std::string at(const Scene& scene, const char* key) {
  const auto it = scene.motion.where.find(key);
  return it == scene.motion.where.end() ? "" : " (" + it->second + ")";
}

/// Called for where there are some, by the first.
template <class List, class Acts> Call by_entries(const List& list, const std::string& noun, const std::string& idle, Acts&& acts) {
  const auto first = std::find_if(list.begin(), list.end(), acts);
  if (first == list.end()) return {false, list.empty() ? "the scene has no " + plural(noun) : counted(list.size(), noun) + ", " + idle};
  const auto n = static_cast<std::size_t>(std::count_if(list.begin(), list.end(), acts));
  return {true, counted(n, noun) + (first->where.empty() ? "" : " (" + first->where + ")")};
}

/// Called for where a joint has a number that is not zero.
Call by_joints(const Scene& scene, std::vector<double> Joint::*values, const char* noun) {
  std::size_t n = 0;
  std::string first;
  for (const Body& b : scene.model.bodies) {
    const std::vector<double>& v = b.joint.*values;
    if (std::all_of(v.begin(), v.end(), [](double x) { return x == 0; })) continue;
    if (n++ == 0) first = b.joint.name;
  }
  if (n == 0) return {false, std::string("no joint has ") + noun};
  return {true, counted(n, "joint") + " with " + noun + ", the first " + in_quotes(first)};
}

/// Called for where a constraint is one of these.
Call by_constraints(const Scene& scene, bool (*holds)(const Constraint&), const char* noun, const char* none) {
  std::size_t n = 0, rows = 0;
  const Constraint* first = nullptr;
  for (const Constraint& c : scene.model.constraints) {
    if (!holds(c)) continue;
    if (n++ == 0) first = &c;
    rows += static_cast<std::size_t>(row_count(scene.model, c));
  }
  if (n == 0) return {false, none};
  return {true, counted(n, noun) + ", " + counted(rows, "row") + ", the first " + in_quotes(first->name) + at(scene, "constraints")};
}

bool between_frames(const Constraint& c) {
  return !acts_on_joint(c.kind) && c.kind != Kind::contact && c.kind != Kind::coupling;
}
bool is_loop(const Constraint& c) { return between_frames(c) && c.loop; }
bool is_other(const Constraint& c) { return between_frames(c) && !c.loop; }
bool is_lock(const Constraint& c) { return c.kind == Kind::joint_lock; }
bool is_coupling(const Constraint& c) { return c.kind == Kind::coupling; }

Call gravity(const Scene& s) {
  if (!s.has_gravity) return {false, "the scene gives no gravity"};
  const std::string g = "(" + number_text(s.gravity[0]) + ", " + number_text(s.gravity[1]) + ", " + number_text(s.gravity[2]) + ") m/s²" + at(s, "gravity");
  return has_gravity(s) ? Call{true, "gravity is " + g} : Call{false, "gravity is " + g};
}
Call wrenches(const Scene& s) {
  return by_entries(s.motion.wrenches, "wrench", "all of them zero", [](const auto& w) { return (w.force.array() != 0).any() || (w.moment.array() != 0).any(); });
}
Call springs(const Scene& s) {
  return by_entries(s.motion.springs, "spring", "without stiffness and damping", [](const auto& x) { return acts(x); });
}
Call motors(const Scene& s) {
  return by_entries(s.motion.motors, "motor", "without torque, stiffness and damping, or without effort", [](const auto& x) { return acts(x); });
}
Call damping(const Scene& s) { return by_joints(s, &Joint::damping, "viscous damping"); }
Call armature(const Scene& s) { return by_joints(s, &Joint::armature, "armature"); }
Call loops(const Scene& s) { return by_constraints(s, is_loop, "loop", "no constraint closes a loop"); }
Call others(const Scene& s) { return by_constraints(s, is_other, "constraint between frames", "no further constraints between frames"); }
Call locks(const Scene& s) { return by_constraints(s, is_lock, "lock", "no joint is locked"); }
Call couplings(const Scene& s) { return by_constraints(s, is_coupling, "coupling", "no gear, no mimic joint"); }

Call limits(const Scene& s) {
  const Index n = limit_count(s);
  return n == 0 ? Call{false, "no joint has a finite limit"} : Call{true, counted(static_cast<std::size_t>(n), "finite limit") + " of joints"};
}
Call joint_friction(const Scene& s) {
  const auto all = joint_frictions(s);
  if (all.empty()) return {false, "no joint has friction above 0"};
  return {true, counted(all.size(), "degree") + " of freedom with friction, the first of " + in_quotes(s.model.bodies[static_cast<std::size_t>(all[0].body)].joint.name)};
}
Call detection(const Scene& s) { return s.motion.detects ? Call{true, "contacts: detect" + at(s, "contacts")} : Call{false, "the scene does not ask for contacts: detect"}; }
Call contacts(const Scene& s) {
  if (s.motion.detects) return {true, "contacts are detected" + at(s, "contacts")};
  if (!has_listed_contacts(s)) return {false, "no contacts"};
  const auto n = std::count_if(s.model.constraints.begin(), s.model.constraints.end(), [](const Constraint& c) { return c.kind == Kind::contact; });
  return {true, counted(static_cast<std::size_t>(n), "listed contact") + at(s, "contacts")};
}
/// The largest that some contact may have: the scene's, and those of pairs.
double largest(const Scene& s, double value, double SceneMotion::Between::*own) {
  for (const auto& e : s.motion.between) value = std::max(value, e.*own);
  return value;
}
/// A coefficient above 0 that a contact may have.
Call contact_friction(const Scene& s) {
  if (!contacts(s).called) return {false, "no contacts"};
  const auto above = [](double mu) { return mu > 0; };
  bool any = false;
  if (!s.motion.detects) {
    for (const Constraint& c : s.model.constraints) any = any || (c.kind == Kind::contact && above(c.friction));
  } else if (s.motion.friction >= 0) {
    any = above(largest(s, s.motion.friction, &SceneMotion::Between::friction));
  } else {
    any = above(largest(s, s.ground_friction, &SceneMotion::Between::friction));
    for (const Body& b : s.model.bodies)
      for (const Shape& shape : b.shapes) any = any || above(shape.friction);
    for (const Standing& x : s.motion.search.standing) any = any || above(x.shape.friction);
  }
  return any ? Call{true, "a coefficient above 0" + at(s, "contacts")} : Call{false, "no contact has a coefficient above 0"};
}
Call by_contacts(const Scene& s, double value, const char* noun, const char* unit) {
  if (!contacts(s).called) return {false, "no contacts"};
  if (!(value > 0)) return {false, std::string("no ") + noun + " above 0"};
  return {true, std::string(noun) + " is " + number_text(value) + unit + at(s, "contacts")};
}
Call torsional_friction(const Scene& s) { return by_contacts(s, largest(s, s.motion.torsional_friction, &SceneMotion::Between::torsional), "torsional friction", " m"); }
Call rolling_friction(const Scene& s) { return by_contacts(s, largest(s, s.motion.rolling_friction, &SceneMotion::Between::rolling), "rolling friction", " m"); }
Call restitution(const Scene& s) { return by_contacts(s, largest(s, s.motion.restitution, &SceneMotion::Between::restitution), "restitution", ""); }
Call sleeping(const Scene& s) {
  const auto& l = s.motion.sleeping;
  if (l.linear < 0) return {false, "the scene does not ask for sleeping"};
  return {true, "below " + number_text(l.linear) + " m/s and " + number_text(l.angular) + " rad/s for " + number_text(l.after) + " s" + at(s, "sleeping")};
}

template <class T> void add_limits(Plan<T>& p, const Scene&) { p.template add<JointLimits<T>>(p.model); }
template <class T> void add_joint_friction(Plan<T>& p, const Scene& s) { p.template add<JointFriction<T>>(s); }
template <class T> void add_detection(Plan<T>& p, const Scene& s) { p.template add<Detection<T>>(s); }
template <class T> void add_contacts(Plan<T>& p, const Scene& s) { p.template add<Contacts<T>>(s); }
template <class T> void add_contact_friction(Plan<T>& p, const Scene&) { p.template add<ContactFriction<T>>(); }
template <class T> void add_torsional_friction(Plan<T>& p, const Scene& s) { p.template add<TorsionalFriction<T>>(s.motion.torsional_friction); }
template <class T> void add_rolling_friction(Plan<T>& p, const Scene& s) { p.template add<RollingFriction<T>>(s.motion.rolling_friction); }
template <class T> void add_restitution(Plan<T>& p, const Scene& s) { p.template add<Restitution<T>>(s.motion.restitution); }
template <class T> void add_gravity(Plan<T>& p, const Scene& s) { p.template add<Gravity<T>>(s.gravity, static_cast<Index>(p.model.bodies.size())); }
template <class T> void add_products(Plan<T>& p, const Scene&) { p.template add<VelocityProducts<T>>(p.model, *p.mechanism); }
template <class T> void add_wrenches(Plan<T>& p, const Scene& s) { p.template add<Wrenches<T>>(s.motion.wrenches); }
template <class T> void add_springs(Plan<T>& p, const Scene& s) { p.template add<Springs<T>>(p.model, s.motion.springs); }
template <class T> void add_damping(Plan<T>& p, const Scene&) { p.template add<JointDamping<T>>(p.model); }
template <class T> void add_motors(Plan<T>& p, const Scene& s) { p.template add<Motors<T>>(p.model, s.motion.motors); }
template <class T> void add_armature(Plan<T>& p, const Scene& s) { p.template add<Armature<T>>(s.model); }

template <class T> void add_sleeping(Plan<T>& p, const Scene& s) { p.template add<Sleeping<T>>(p.model, s.motion.sleeping, p.step, p.detections); }

#define DELASSUS_ADDERS(f) {&f<double>, &f<Counted>}

std::vector<EffectRow> make_effects() {
  return {
      {"gravity", "a uniform field", "gravity, not zero", Energy::conserves, gravity, "", nullptr, DELASSUS_ADDERS(add_gravity)},
      {"velocity products", "Coriolis, centrifugal and gyroscopic forces", "joints that turn, unless their effect provably vanishes", Energy::neither,
       has_velocity_products, "", nullptr, DELASSUS_ADDERS(add_products)},
      {"wrenches", "forces and moments at points of bodies", "wrenches, not zero", Energy::injects, wrenches, "", nullptr, DELASSUS_ADDERS(add_wrenches)},
      {"springs", "springs and dampers in joints, implicit", "springs, not zero", Energy::dissipates, springs, "", nullptr, DELASSUS_ADDERS(add_springs)},
      {"joint damping", "viscous damping of joints, implicit", "damping of a joint in a robot's file, not zero", Energy::dissipates, damping, "", nullptr,
       DELASSUS_ADDERS(add_damping)},
      {"motors", "torques and proportional-derivative control, implicit and cut at the effort", "motors, not zero", Energy::injects, motors, "", nullptr,
       DELASSUS_ADDERS(add_motors)},
      {"armature", "rotor inertia reflected to joints", "armature of a joint, not zero", Energy::conserves, armature, "", nullptr, DELASSUS_ADDERS(add_armature)},
      {"loops", "closures of kinematic loops, drift closed after every step", "constraints between frames with loop: true", Energy::conserves, loops, "", is_loop, {}},
      {"other joints", "further constraints between frames: points, welds, hinges, distances", "constraints between frames", Energy::conserves, others, "", is_other, {}},
      {"joint locks", "rows that hold joints where they are", "constraints of kind joint_lock", Energy::conserves, locks, "", is_lock, {}},
      {"couplings", "gears and mimic joints, a row each", "constraints of kind coupling, mimic joints", Energy::conserves, couplings, "", is_coupling, {}},
      {"joint limits", "one-sided rows of the joints that are near a limit", "finite limits of joints", Energy::conserves, limits, "", nullptr, DELASSUS_ADDERS(add_limits)},
      {"joint friction", "dry friction in joints: a box of impulses", "friction of a joint, or joint_friction rows with an effort, above 0", Energy::dissipates,
       joint_friction, "", nullptr, DELASSUS_ADDERS(add_joint_friction)},
      {"collision detection", "contact points from shapes at every configuration", "contacts: detect", Energy::neither, detection, "contacts", nullptr,
       DELASSUS_ADDERS(add_detection)},
      {"contacts", "points that do not penetrate", "contacts: detect, or a list", Energy::conserves, contacts, "", nullptr, DELASSUS_ADDERS(add_contacts)},
      {"contact friction", "Coulomb's cone at contacts", "a coefficient above 0", Energy::dissipates, contact_friction, "contacts", nullptr,
       DELASSUS_ADDERS(add_contact_friction)},
      {"torsional friction", "moments about the normals of contacts", "torsional_friction of contacts above 0", Energy::dissipates, torsional_friction, "contacts",
       nullptr, DELASSUS_ADDERS(add_torsional_friction)},
      {"rolling friction", "moments about the tangents of contacts", "rolling_friction of contacts above 0", Energy::dissipates, rolling_friction, "contacts", nullptr,
       DELASSUS_ADDERS(add_rolling_friction)},
      {"restitution", "contacts that bounce", "restitution of contacts above 0", Energy::dissipates, restitution, "contacts", nullptr, DELASSUS_ADDERS(add_restitution)},
      {"sleeping", "islands at rest are not moved until something touches them", "sleeping, with the speeds below which it is rest", Energy::dissipates, sleeping, "",
       nullptr, DELASSUS_ADDERS(add_sleeping)},
  };
}

}  // namespace

std::string_view name(Energy e) {
  switch (e) {
    case Energy::conserves: return "conserves";
    case Energy::dissipates: return "dissipates";
    case Energy::injects: return "injects";
    case Energy::neither: return "no work";
  }
  return "unknown";
}

const std::vector<EffectRow>& effects() {
  static const std::vector<EffectRow> table = make_effects();
  return table;
}

const EffectRow& find_effect(std::string_view name, const std::vector<EffectRow>& table) {
  for (const EffectRow& row : table)
    if (row.name == name) return row;
  std::vector<std::string_view> names;
  for (const EffectRow& row : table) names.push_back(row.name);
  std::string all;
  for (const std::string_view n : names) all += (all.empty() ? "" : ", ") + std::string(n);
  throw ModelError("", "effect " + in_quotes(std::string(name)), "does not exist", did_you_mean(std::string(name), names) + all + "; `delassus list effects` describes them");
}

}  // namespace delassus::simulation
