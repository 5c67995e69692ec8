// What the proofs of absence share: for every effect a scene that calls for it, and that scene without its key.
#pragma once

#include <functional>
#include <map>

#include "algorithms/kit/counted.h"
#include "property_tests/unit/simulation/stepping_scenes.h"
#include "simulation/effects/gravity.h"
#include "simulation/effects/springs.h"

namespace delassus::stepping {

/// Of so many steps; −1 where one fails.
inline std::int64_t operations(const Scene& scene, const Settings& settings, int steps) {
  Simulation<Counted> s(scene, settings);
  operation_count = {};
  for (int k = 0; k < steps; ++k)
    if (!s.step().ok()) return -1;
  return operation_count.total();
}

/// The scene as if the key of an effect had never been written.
inline void never_written(const std::string& effect, Scene& s) {
  using Kind = Constraint::Kind;
  const auto drop = [&](auto&& which) {
    std::erase_if(s.model.constraints, which);
    Index rows = 0;
    for (const Constraint& c : s.model.constraints) rows += row_count(s.model, c);
    s.damping = Damping<double>::uniform(rows, 0);
  };
  if (effect == "gravity") s.has_gravity = false, s.gravity.setZero();
  if (effect == "wrenches") s.motion.wrenches.clear();
  if (effect == "springs") s.motion.springs.clear();
  if (effect == "motors") s.motion.motors.clear();
  if (effect == "joint damping") for (Body& b : s.model.bodies) b.joint.damping.clear();
  if (effect == "armature") for (Body& b : s.model.bodies) b.joint.armature.clear();
  if (effect == "couplings") drop([](const Constraint& c) { return c.kind == Kind::coupling; });
  if (effect == "joint locks") drop([](const Constraint& c) { return c.kind == Kind::joint_lock; });
  if (effect == "joint limits") for (Body& b : s.model.bodies) b.joint.lower.clear(), b.joint.upper.clear();
  if (effect == "joint friction") for (Body& b : s.model.bodies) b.joint.friction.clear();
  if (effect == "collision detection" || effect == "contacts") s.motion.detects = false;
  if (effect == "contact friction") s.ground_friction = -1;
  if (effect == "torsional friction") s.motion.torsional_friction = 0;
  if (effect == "rolling friction") s.motion.rolling_friction = 0;
  if (effect == "restitution") s.motion.restitution = 0;
  if (effect == "sleeping") s.motion.sleeping = {};
  if (effect == "loops") drop([](const Constraint& c) { return c.loop; });
}

/// Per effect a scene that calls for it.
inline const std::map<std::string, std::function<Scene()>>& callers() {
  static const std::map<std::string, std::function<Scene()>> all{
      {"gravity", everything_smooth},  {"velocity products", everything_smooth}, {"wrenches", everything_smooth},
      {"springs", everything_smooth},  {"joint damping", everything_smooth},     {"motors", everything_smooth},
      {"armature", everything_smooth}, {"couplings", everything_smooth},         {"joint locks", everything_smooth},
      {"joint limits", stopped_pendulum}, {"joint friction", stopped_pendulum},
      {"collision detection", thrown_box}, {"contacts", thrown_box}, {"contact friction", thrown_box}, {"restitution", bouncing_ball},
      {"torsional friction", creeping_ball}, {"rolling friction", creeping_ball}, {"sleeping", resting_box},
      {"loops", [] { return slider_crank(0.3, 0.8, 0.4, 5); }}};
  return all;
}

/// The table without a row: the smaller program.
inline std::vector<EffectRow> table_without(const std::string& effect) {
  std::vector<EffectRow> smaller = effects();
  std::erase_if(smaller, [&](const EffectRow& row) { return row.name == effect; });
  return smaller;
}

/// A table in which gravity brings the springs along, whoever leaves them out.
inline std::vector<EffectRow> table_with_a_leak() {
  using namespace simulation;
  std::vector<EffectRow> leaky = effects();
  for (EffectRow& row : leaky)
    if (row.name == "gravity")
      std::get<Adder<double>>(row.adders) = [](StepPlan<double>& p, const Scene& s) {
        p.add<Gravity<double>>(s.gravity, static_cast<Index>(p.model.bodies.size()));
        p.add<Springs<double>>(p.model, s.motion.springs);
      };
  return leaky;
}

}  // namespace delassus::stepping
