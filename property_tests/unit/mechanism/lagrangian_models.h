// The mechanisms of the symbolic reference, described once more, as models of the library.
#pragma once

#include <map>
#include <stdexcept>
#include <string>

#include "algorithms/mechanism/model.h"

namespace delassus::unit {

using Values = std::map<std::string, double>;   // of the mechanism's parameters, by symbol

/// Pure translation.
inline Pose<double> at(double x, double y, double z) { return {Matrix3<double>::Identity(), {x, y, z}}; }

/// Frame z along the world's or body's y: x ← z, y ← x, z ← y.
inline Pose<double> normal_along_y() {
  Pose<double> p;
  p.rotation << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return p;
}

inline Matrix3<double> planar_inertia(double z) { return Vector3<double>(0.75 * z, 0.5 * z, z).asDiagonal(); }
inline Matrix3<double> ball_inertia(double i) { return Vector3<double>(i, i, i).asDiagonal(); }

struct Link {
  Index parent;
  JointType type;
  Pose<double> placement;
  double mass;
  Vector3<double> com;
  Matrix3<double> inertia;
  double armature;
};

/// About z, or along x.
inline Index add(Model& model, const Link& link) {
  Body b;
  b.name = "body" + std::to_string(model.bodies.size());
  b.parent = link.parent;
  b.joint.type = link.type;
  b.joint.axis = link.type == JointType::prismatic ? Vector3<double>(1, 0, 0) : Vector3<double>(0, 0, 1);
  b.joint.placement = link.placement;
  if (dof_count(link.type) == 1) b.joint.armature = {link.armature};
  b.mass = link.mass;
  b.com = link.com;
  b.inertia = link.inertia;
  return model.add(b);
}

inline void constrain(Model& model, Constraint::Kind kind, const Frame& a, const Frame& b, double length = 0) {
  Constraint c;
  c.name = "row" + std::to_string(model.constraints.size());
  c.kind = kind;
  c.a = a;
  c.b = b;
  c.length = length;
  c.loop = kind == Constraint::Kind::point && a.body != ground && b.body != ground;
  model.constraints.push_back(c);
}

/// Bodies 1, 2, … of a chain about z, each at the end of the one before.
inline void add_chain(Model& model, const Values& v, int count) {
  for (int k = 1; k <= count; ++k) {
    const std::string i = std::to_string(k);
    const double offset = k == 1 ? 0 : v.at("l" + std::to_string(k - 1));
    add(model, {k - 2, JointType::revolute, at(offset, 0, 0), v.at("m" + i), {v.at("c" + i), 0, 0},
                planar_inertia(v.at("I" + i)), v.at("A" + i)});
  }
}

inline Model pendulum(const Values& v) {
  Model m;
  add(m, {ground, JointType::revolute, {}, v.at("m"), {v.at("c"), 0, 0}, planar_inertia(v.at("I")), v.at("A")});
  constrain(m, Constraint::Kind::point, {0, at(v.at("d"), 0, 0)}, {ground, at(1, 2, 0)});
  constrain(m, Constraint::Kind::joint_lock, {0, {}}, {});
  return m;
}

inline Model cart_pole(const Values& v) {
  Model m;
  add(m, {ground, JointType::prismatic, {}, v.at("mc"), {0, 0, 0}, ball_inertia(v.at("I")), v.at("A1")});
  add(m, {0, JointType::revolute, {}, v.at("mp"), {0, v.at("c"), 0}, planar_inertia(v.at("I")), v.at("A2")});
  constrain(m, Constraint::Kind::contact, {ground, normal_along_y()}, {1, at(0, v.at("d"), 0)});
  constrain(m, Constraint::Kind::joint_friction, {0, {}}, {});
  return m;
}

inline Model double_pendulum(const Values& v) {
  Model m;
  add_chain(m, v, 2);
  constrain(m, Constraint::Kind::point, {1, at(v.at("l2"), 0, 0)}, {ground, {}});
  return m;
}

inline Model planar_arm(const Values& v) {
  Model m;
  add_chain(m, v, 3);
  constrain(m, Constraint::Kind::weld, {2, at(v.at("l3"), 0, 0)}, {ground, {}});
  Constraint gear;
  gear.name = "gear";
  gear.kind = Constraint::Kind::coupling;
  gear.terms = {{0, 0, 1, {}}, {2, 0, v.at("k"), {}}};
  m.constraints.push_back(gear);
  return m;
}

inline Model spherical_pendulum(const Values& v) {
  Model m;
  add(m, {ground, JointType::spherical, {}, v.at("m"), {0, 0, -v.at("c")},
          Vector3<double>(v.at("I1"), v.at("I2"), v.at("I3")).asDiagonal(), 0});
  const Frame tip{0, at(0, 0, -v.at("d"))};
  constrain(m, Constraint::Kind::point, tip, {ground, {}});
  constrain(m, Constraint::Kind::distance, tip, {ground, at(v.at("hx"), v.at("hy"), v.at("hz"))}, 2);
  return m;
}

inline Model four_bar(const Values& v) {
  Model m;
  add_chain(m, v, 2);
  add(m, {ground, JointType::revolute, at(v.at("g"), 0, 0), v.at("m3"), {v.at("c3"), 0, 0}, planar_inertia(v.at("I3")),
          v.at("A3")});
  constrain(m, Constraint::Kind::point, {1, at(v.at("l2"), 0, 0)}, {2, at(v.at("l3"), 0, 0)});
  return m;
}

inline Model slider_crank(const Values& v) {
  Model m;
  add_chain(m, v, 2);
  add(m, {ground, JointType::prismatic, {}, v.at("m3"), {0, 0, 0}, ball_inertia(v.at("I1")), v.at("A3")});
  constrain(m, Constraint::Kind::point, {2, {}}, {1, at(v.at("l2"), 0, 0)});
  return m;
}

inline Model free_body(const Values& v) {
  Model m;
  Matrix3<double> I;
  I << v.at("Ixx"), v.at("Ixy"), v.at("Ixz"), v.at("Ixy"), v.at("Iyy"), v.at("Iyz"), v.at("Ixz"), v.at("Iyz"), v.at("Izz");
  add(m, {ground, JointType::floating, {}, v.at("m"), {v.at("cx"), v.at("cy"), v.at("cz")}, I, 0});
  constrain(m, Constraint::Kind::contact, {0, at(v.at("ax"), v.at("ay"), v.at("az"))}, {ground, {}});
  constrain(m, Constraint::Kind::contact, {ground, {}}, {0, at(v.at("bx"), v.at("by"), v.at("bz"))});
  return m;
}

inline Model named_model(const std::string& mechanism, const Values& v) {
  static const std::map<std::string, Model (*)(const Values&)> all{
      {"pendulum", pendulum},     {"cart_pole", cart_pole},       {"double_pendulum", double_pendulum},
      {"planar_arm", planar_arm}, {"spherical_pendulum", spherical_pendulum}, {"four_bar", four_bar},
      {"slider_crank", slider_crank}, {"free_body", free_body}};
  const auto found = all.find(mechanism);
  if (found == all.end()) throw std::logic_error("no model of mechanism " + mechanism);
  return found->second(v);
}

}  // namespace delassus::unit
