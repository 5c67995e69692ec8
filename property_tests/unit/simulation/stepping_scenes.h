// Small scenes for the tests of stepping, made without files.
#pragma once

#include <cmath>
#include <fstream>

#include "property_tests/unit/way_in/temporary.h"
#include "simulation/observe.h"
#include "simulation/step.h"

namespace delassus::stepping {

using namespace simulation;
using V3 = Vector3<double>;

inline Body body(const std::string& name, Index parent, JointType type, double mass, const V3& moments, const V3& com = {0, 0, 0}, const V3& axis = {0, 0, 1},
                 const V3& at = {0, 0, 0}) {
  Body b;
  b.name = name;
  b.parent = parent;
  b.joint.name = "of " + name;
  b.joint.type = type;
  b.joint.axis = axis;
  b.joint.placement.translation = at;
  b.mass = mass;
  b.com = com;
  b.inertia.diagonal() = moments;
  return b;
}

/// A scene file with this text.
inline Scene read(const std::string& text) {
  const auto file = test::temporary("scene.yaml");
  std::ofstream(file) << text;
  return load_scene(file.string());
}

/// At its neutral configuration, at rest, rows hard.
inline Scene scene_of(Model model, const V3& gravity = {0, 0, 0}) {
  Scene s;
  s.name = "test";
  s.model = std::move(model);
  s.q = neutral(s.model);
  s.gravity = gravity;
  s.has_gravity = (gravity.array() != 0).any();
  s.motion.nu = VectorX<double>::Zero(s.model.dofs());
  Index rows = 0;
  for (const Constraint& c : s.model.constraints) rows += row_count(s.model, c);
  s.damping = Damping<double>::uniform(rows, 0);
  return s;
}

inline Settings step_of(double h) {
  Settings s;
  s.step = h;
  return s;
}

/// No simulation is made of it, and the words say why.
inline void refused(const Scene& scene, const Settings& settings, const std::string& words) {
  try {
    Simulation<double> s(scene, settings);
    ADD_FAILURE() << "accepted";
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

/// The state after `steps`; a step that fails is an empty state.
template <class T = double> State<T> run(const Scene& scene, const Settings& settings, int steps) {
  Simulation<T> s(scene, settings);
  for (int k = 0; k < steps; ++k)
    if (!s.step().ok()) return {};
  return s.state();
}

inline Scene free_body(const V3& moments) {
  Model m;
  m.add(body("body", ground, JointType::floating, 2, moments));
  Scene s = scene_of(std::move(m), {0, 0, -9.81});
  s.q.head<3>() << 0.3, -0.2, 5;
  s.motion.nu << 1, -2, 3, 0.5, 0.25, 4;
  return s;
}

/// A bob of 1 kg on a rod of 0.5 m, and inertia of its own; from angle 0 = hanging.
inline Scene pendulum(double angle) {
  Model m;
  m.add(body("bob", ground, JointType::revolute, 1, {0.01, 0.02, 0.03}, {0, 0, -0.5}, {0, 1, 0}));
  Scene s = scene_of(std::move(m), {0, 0, -9.81});
  s.q[0] = angle;
  return s;
}

inline Scene double_pendulum() {
  Model m;
  m.add(body("upper", ground, JointType::revolute, 1, {0.01, 0.02, 0.03}, {0, 0, -0.25}, {0, 1, 0}));
  m.add(body("lower", 0, JointType::revolute, 0.7, {0.02, 0.01, 0.01}, {0, 0.1, -0.2}, {0, 0.6, 0.8}, {0, 0, -0.5}));
  Scene s = scene_of(std::move(m), {0, 0, -9.81});
  s.q << 0.7, -0.4;
  s.motion.nu << 0.3, 1;
  return s;
}

/// Crank of r, rod of l, slider along x, in the plane z = 0; closed by a point between rod and slider: three rows, one of them zero.
inline Scene slider_crank(double r, double l, double angle, double rate) {
  Model m;
  m.add(body("crank", ground, JointType::revolute, 1, {0.01, 0.01, 0.02}, {r / 2, 0, 0}));
  m.add(body("rod", 0, JointType::revolute, 1, {0.01, 0.03, 0.03}, {l / 2, 0, 0}, {0, 0, 1}, {r, 0, 0}));
  m.add(body("slider", ground, JointType::prismatic, 2, {0.01, 0.01, 0.01}, {0, 0, 0}, {1, 0, 0}));
  Constraint c;
  c.name = "pin";
  c.kind = Constraint::Kind::point;
  c.loop = true;
  c.a.body = 1;
  c.a.placement.translation = {l, 0, 0};
  c.b.body = 2;
  m.constraints.push_back(c);
  Scene s = scene_of(std::move(m));
  const double beta = std::asin(r * std::sin(angle) / l), x_rate = -r * rate * std::sin(angle) - r * rate * std::cos(angle) * std::tan(beta);
  s.q << angle, -beta - angle, r * std::cos(angle) + l * std::cos(beta);
  s.motion.nu << rate, -rate - r * rate * std::cos(angle) / (l * std::cos(beta)), x_rate;
  return s;
}

/// A free trunk with an arm, everything that acts without rows called for, and a coupling of its two last joints.
inline Scene everything_smooth() {
  Model m;
  m.add(body("trunk", ground, JointType::floating, 3, {0.1, 0.2, 0.25}, {0.05, -0.02, 0.1}));
  m.add(body("arm", 0, JointType::revolute, 1, {0.01, 0.02, 0.03}, {0, 0, -0.25}, {0, 1, 0}, {0.2, 0, 0}));
  m.add(body("hand", 1, JointType::revolute, 0.5, {0.01, 0.01, 0.02}, {0, 0.05, -0.1}, {0.6, 0.8, 0}, {0, 0, -0.5}));
  m.bodies[1].joint.damping = {0.3};
  m.bodies[2].joint.armature = {0.02};
  Constraint gear;
  gear.name = "gear";
  gear.kind = Constraint::Kind::coupling;
  gear.terms.resize(2);
  gear.terms[0].body = 1;
  gear.terms[1].body = 2, gear.terms[1].coefficient = -0.5;
  m.constraints.push_back(gear);
  Constraint lock;
  lock.name = "lock";
  lock.kind = Constraint::Kind::joint_lock;
  m.add(body("tail", 0, JointType::revolute, 0.2, {0.01, 0.01, 0.01}, {0, 0, -0.1}, {1, 0, 0}, {-0.2, 0, 0}));
  lock.a.body = 3;
  m.constraints.push_back(lock);
  Scene s = scene_of(std::move(m), {0, 0, -9.81});
  s.q.tail<3>() << 0.2, 0.4, -0.3;
  s.motion.nu << 0.1, 0.2, -0.3, 1, 0, 0.5, 0.25, 0.5, 0;
  s.motion.springs.push_back({1, 0, 5, 0.1, 0.2, "scene:1"});
  s.motion.motors.push_back({2, 0, 0.3, 4, 0.1, 0.5, 2, "scene:2"});
  s.motion.wrenches.push_back({{1, {}}, {1, 2, 3}, {0.1, 0, 0.2}, "scene:3"});
  return s;
}

/// A pendulum that falls on its lower limit and has dry friction.
inline Scene stopped_pendulum() {
  Scene s = pendulum(0.02);
  s.model.bodies[0].joint.lower = {-0.01};
  s.model.bodies[0].joint.upper = {2};
  s.model.bodies[0].joint.friction = {0.05};
  s.motion.nu[0] = -2;
  return s;
}

/// On the plane z = 0 with contacts detected.
inline Scene on_the_ground(Model model, const V3& gravity, double friction) {
  Scene s = scene_of(std::move(model), gravity);
  s.has_ground = true;
  s.ground_friction = friction;
  s.motion.detects = true;
  s.motion.search.ground = true;
  for (std::size_t i = 0; i < s.model.bodies.size(); ++i) s.motion.search.object.push_back(static_cast<Index>(i));
  return s;
}

inline Body box(const std::string& name, double mass, const V3& half) {
  const V3 e = 4 * half.cwiseAbs2();
  Body b = body(name, ground, JointType::floating, mass, V3(e[1] + e[2], e[0] + e[2], e[0] + e[1]) * (mass / 12));
  b.shapes.push_back({Shape::Kind::box, half, {}, -1, {}});
  return b;
}

inline Body ball(const std::string& name, double mass, double radius) {
  Body b = body(name, ground, JointType::floating, mass, V3::Constant(0.4 * mass * radius * radius));
  b.shapes.push_back({Shape::Kind::sphere, V3(radius, 0, 0), {}, -1, {}});
  return b;
}

/// A cube that touches the ground with one face and moves into it, along it and about its normal.
inline Scene thrown_box() {
  Model m;
  m.add(box("cube", 2, {0.1, 0.1, 0.1}));
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0.5);
  s.q[2] = 0.1;
  s.motion.nu << 0, 0, 1, 1, 0.5, -1;
  s.motion.restitution = 0.3;
  return s;
}

/// A ball that touches the ground, slides, rolls and spins.
inline Scene thrown_ball() {
  Model m;
  m.add(ball("ball", 2, 0.1));
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0.5);
  s.q[2] = 0.1;
  s.motion.nu << 1, 5, 20, 1, 0.5, 0;
  s.motion.torsional_friction = 0.02;
  s.motion.rolling_friction = 0.005;
  return s;
}

/// The same, so slow that friction stops it at once.
inline Scene creeping_ball() {
  Scene s = thrown_ball();
  s.motion.nu << 0, 1e-3, 1e-3, 1e-4, 0, 0;
  return s;
}

/// A ball that comes to the ground in its third step, and bounces.
inline Scene bouncing_ball() {
  Model m;
  m.add(ball("ball", 2, 0.1));
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0);
  s.q[2] = 0.1025;
  s.motion.nu[5] = -1;
  s.motion.restitution = 0.5;
  return s;
}

/// A cube on the ground that falls asleep in the fifth step.
inline Scene resting_box() {
  Model m;
  m.add(box("cube", 2, {0.1, 0.1, 0.1}));
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0.5);
  s.q[2] = 0.1;
  s.motion.nu[3] = 1e-3;
  s.motion.sleeping = {0.01, 0.01, 5e-3};
  return s;
}

template <class T> using StepPlan = simulation::Plan<T>;

}  // namespace delassus::stepping
