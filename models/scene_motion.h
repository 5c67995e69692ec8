// What a scene says beyond M, J and R⁻¹, for who lets it move: velocities, springs, motors, wrenches, where contacts are looked for.
// docs/scenes.md has the keys. Units SI, angles in radians.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "models/contacts.h"

namespace delassus {

struct SceneMotion {
  /// τ = −stiffness (q − rest) − damping ν of one degree of freedom that has a coordinate of its own.
  struct Spring {
    Index body = 0, dof = 0;
    double stiffness = 0, rest = 0, damping = 0;  ///< [N m/rad or N/m, rad or m, N m s/rad or N s/m]
    std::string where;                            ///< file:line
  };
  /// τ = torque + stiffness (target − q) − damping ν, cut at ± effort.
  struct Motor {
    Index body = 0, dof = 0;
    double torque = 0, stiffness = 0, damping = 0, target = 0;
    double effort = std::numeric_limits<double>::infinity();  ///< [N m or N]
    std::string where;
  };
  /// A force and a moment of constant direction in the world, at a point fixed on a body.
  struct Wrench {
    Frame at;
    Vector3<double> force{0, 0, 0}, moment{0, 0, 0};  ///< [N, N m]
    std::string where;
  };

  /// What has been slower than this for a while is not moved until something touches it.
  struct Sleeping {
    double linear = -1, angular = -1, after = 0;  ///< [m/s, rad/s, s]; negative: not asked for
  };

  /// Coefficients of the contacts of two, or of one with all others.
  struct Between {
    static constexpr Index any = -2;
    Index a = any, b = any;  ///< a body, ground (the plane), any, or −3 − k: what stands, of ContactSearch::standing
    double friction = -1, torsional = -1, rolling = -1, restitution = -1;  ///< negative: that of an entry before this one, or of the scene
    std::string where;
  };

  VectorX<double> nu;               ///< velocities at the start; empty: at rest
  std::vector<Spring> springs;
  std::vector<Motor> motors;
  std::vector<Wrench> wrenches;
  bool detects = false;             ///< contacts are found from shapes, at every configuration
  ContactSearch search;             ///< margin, ground, which bodies belong together
  double friction = -1;             ///< of all contacts that are found; negative: that of shapes and ground
  double restitution = 0;           ///< of all contacts
  double torsional_friction = 0, rolling_friction = 0;  ///< of all contacts: largest moment about the normal, and across it, per normal force [m]
  std::vector<Between> between;     ///< a later one replaces what it gives
  double contact_damping = 0;       ///< R⁻¹ of the rows of contacts that are found [1/kg]
  Sleeping sleeping;
  std::map<std::string, std::string> where;  ///< key of the scene → file:line

  /// The first coordinate in q of a degree of freedom, −1 where it has none (quaternions).
  [[nodiscard]] static Index coordinate(const Model& model, Index body, Index dof) {
    const JointType type = model.bodies[static_cast<std::size_t>(body)].joint.type;
    if (type == JointType::spherical || type == JointType::floating) return -1;
    return model.first_q[static_cast<std::size_t>(body)] + dof;
  }
};

}  // namespace delassus
