// Robots from URDF files.
//
// Joints: revolute, continuous, prismatic, planar and floating as in URDF; fixed joints merge the child link into its
// parent. Joint types URDF lacks (spherical, universal, cylindrical) come from the scene. A mimic joint stays a joint
// and becomes a coupling row ν_mimic − multiplier · ν_master. Beyond URDF 1.0 the loader reads
//   <dynamics armature="..."/>              rotor inertia of a joint [kg m² or kg]
//   <capsule radius="..." length="..."/>    collision geometry; length without the caps [m]
// and takes a <limit> without effort or velocity as unlimited there. Meshes and visuals are left out, with a note.
// The XML is checked before urdfdom sees it; what urdfdom would print is captured and becomes part of the error.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "algorithms/model.h"

namespace delassus {

struct UrdfOptions {
  struct Type {
    JointType type = JointType::spherical;
    Vector3<double> axis2{0, 1, 0};  ///< universal only, in the joint frame
  };
  enum class Base : std::uint8_t { fixed, free, planar };

  std::string file;    ///< path of the URDF
  std::string robot;   ///< bodies are named `robot/link`, joints `robot/joint`
  Base base = Base::free;
  Pose<double> pose;   ///< of the root link in the world
  std::map<std::string, Type> joint_types;               ///< by joint name
  std::map<std::string, double> armature;                ///< by joint name; replaces the URDF's
};

/// What was added to the model.
struct UrdfRobot {
  struct Mimic {
    Index body, master;  ///< bodies moved by the joints
    double multiplier, offset;
  };
  std::string name, root_joint;           ///< root_joint: name of the base joint, "" for a fixed base
  std::map<std::string, Frame> links;     ///< every link by its URDF name; merged ones at their place in the body
  std::map<std::string, Index> joints;    ///< moving joints by URDF name → body they move
  std::vector<Index> bodies;              ///< in order of the model
  std::vector<Mimic> mimics;              ///< their coupling constraints are already in the model
  std::vector<std::string> notes;
};

/// Appends a robot to a model. Bodies follow the order of the joints in the file, depth first.
/// @throws ModelError naming file, element (with line), value and what is accepted. Cost O(links).
UrdfRobot add_urdf(Model& model, const UrdfOptions& options);

/// Rotation of fixed-axis roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] Matrix3<double> rotation_rpy(const Vector3<double>& rpy);

}  // namespace delassus
