// Robots from MJCF files, compiled by MuJoCo's own library (version 2); built only where that is found.
//
// Bodies    A MuJoCo joint becomes one joint and one body of ours, in MuJoCo's order: a link with several joints is a chain
//           whose inner bodies, `robot/link.joint`, have no mass. A link without joints is merged into its parent.
// Frames    MuJoCo turns a link about an anchor anywhere in it; our body frames lie in the anchor. Robot::links has the
//           links' own frames.
// q         is MuJoCo's qpos, joint by joint: `ref` is part of the placements, so q = 0 is qpos = 0. The file's own pose
//           (qpos0, or a keyframe) is Robot::start.
// Base      A root with a freejoint floats, one without joints stands on the world; `base` of the options changes that
//           where the file has one such root. Every root of a file becomes a tree of the robot.
// Equality  connect → point, weld → weld, both to be closed by assembly; joint → coupling (a mimic) or joint_lock; fixed
//           tendons → coupling. A polynomial is taken by its tangent at the start pose, with a warning. Rows are hard:
//           MuJoCo's softness (solref, solimp) is left to `damping` of the scene.
// Inertia   as MuJoCo compiled it; `fullinertia` is read again from the file, since MuJoCo's principal axes carry a
//           relative error of up to 1e-6.
// Said      What MuJoCo warns of becomes a warning, what it refuses an error, in its words. Springs, actuators, spatial
//           tendons, contact pairs and excludes are left out, with a note.
#pragma once

#include "models/robot.h"

namespace delassus {

/// Appends the robots of an MJCF file to a model. @throws ModelError naming file and element, or with MuJoCo's message, or
/// saying that this build is without MuJoCo. Cost: MuJoCo's compilation, then O(bodies + geoms).
Robot add_mjcf(Model& model, const RobotOptions& options);

/// What `add_mjcf` reads, for those who compare it with MuJoCo's own numbers.
struct MjcfSource {
  struct Sites {
    std::string constraint, a, b;  ///< name of the constraint less its robot; the two sites
    bool weld;
  };
  std::string text;                                     ///< compiled in the file's place; "" where the file itself is
  std::map<std::string, Matrix3<double>> full_inertia;  ///< by body name, axes of the body
  std::vector<Sites> sites;                             ///< equalities between sites: not in `text`
};
/// @throws ModelError as add_mjcf.
[[nodiscard]] MjcfSource mjcf_source(const std::string& file);

}  // namespace delassus
