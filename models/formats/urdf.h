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

#include "models/robot.h"

namespace delassus {

/// Appends a robot to a model. Bodies follow the order of the joints in the file, depth first.
/// @throws ModelError naming file, element (with line), value and what is accepted. Cost O(links).
Robot add_urdf(Model& model, const RobotOptions& options);

}  // namespace delassus
