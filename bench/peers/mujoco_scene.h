// A scene that moves, as a model of MuJoCo 2: that of reference/mujoco_witness.h, and what only matters where it moves.
//
// Bodies   and joints, inertias, armature: number by number. Springs and dampers of joints are its own; so are motors without a limit of
//          their effort, which are nothing else; motors with one are actuators with force = torque + k (target − q) − d q̇ cut there.
// Shapes   sphere, capsule, cylinder, box, hulls as meshes; which pairs touch is ours: bodies of one object do not.
//          The ground's coefficient, or the scene's, is that of the contact.
// Loops    point: `connect`. hinge: two of them on its axis, 0.2 m apart, six rows of which five are independent. prismatic between a free
//          body and the world: MuJoCo has no row for it; the five other directions get an armature of 10¹⁰ kg, which costs it nothing.
// Refused  by name: what it has not (restitution), or what no example has (torsional and rolling friction, sleep, other rows).
// Source   the XML reference and mjmodel.h of MuJoCo 2.2.2.
#pragma once

#include "models/scene.h"
#include "reference/mujoco_witness.h"

namespace delassus::bench {

inline constexpr double held_armature = 1e10;  ///< [kg, kg m²]

/// A `connect` of two points.
struct Connected {
  Frame a, b;
  double R_inverse;  ///< of the scene's rows [1/kg]
};

class MujocoScene {
 public:
  /// @throws ModelError as above, or with MuJoCo's message.
  MujocoScene(const Scene& scene, double step);

  std::vector<Index> held;           ///< degrees of freedom with held_armature
  std::vector<Connected> connected;  ///< in the order of its rows
  reference::MujocoWitness witness;
  mjModel_* m;
  mjData_* d;
  std::vector<Index> body_of;        ///< of MuJoCo's body: ours, `ground` for the world
  std::vector<std::pair<Index, Index>> joint_of;  ///< of MuJoCo's degree of freedom: our body and degree of freedom of its joint
  VectorX<double> armature;          ///< n, of the scene, with what holds

  /// To q and ν of ours, time zero, nothing kept of what ran before.
  void set(const VectorX<double>& q, const VectorX<double>& nu);

 private:
  void take_joints(const Scene& scene);
  void take_anchors();
};

}  // namespace delassus::bench
