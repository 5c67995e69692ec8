// Robots from SDF files, read by libsdformat (version 12); built only where that is found.
//
// Models    All models of a file, nested and included ones too, are one robot: links `link`, in nested models
//           `model::link`, in worlds with several models `model::link` throughout. Poses are resolved by the library.
// Tree      A link hangs on the first joint of the file that has it as child; every other one closes a loop: revolute →
//           hinge, ball → point, fixed → weld, prismatic, universal; the loop is closed at the file's own poses.
// Joints    universal and revolute2 → universal, ball → spherical, screw → cylindrical with a coupling, gearbox → coupling.
//           Body frames lie in the joints; Robot::links has the links' own frames. q = 0 is the file's pose.
// Base      A link on a fixed joint to the world, or of a static model, stands; other roots float. `base` of the options
//           changes that for the first root. The file as a whole is placed by `pose`.
// Said      What libsdformat prints becomes a warning, what it refuses an error, in its words. Springs, visuals,
//           sensors, plugins and dynamics of loop joints are not read.
#pragma once

#include "models/robot.h"

namespace delassus {

/// Appends the robot of an SDF file to a model. @throws ModelError naming file and element, or with libsdformat's message,
/// or saying that this build is without it. Cost O(size of the file and of what it includes).
Robot add_sdf(Model& model, const RobotOptions& options);

}  // namespace delassus
