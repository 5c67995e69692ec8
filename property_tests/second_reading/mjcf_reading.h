// MuJoCo's own M and equality rows of an MJCF file as a second reading; null in a build without MuJoCo.
#pragma once

#include "property_tests/second_reading/second_reading.h"

namespace delassus {

/// Its J has the rows of the model's own constraints; a constraint without an equality, or an active equality without a
/// constraint that no note or warning names, is an error of `matrices`. No welds are added.
[[nodiscard]] std::unique_ptr<SecondReading> mjcf_reading(const RobotOptions& options);

/// MuJoCo's message when it refuses the file itself; "" when it reads it, when it is no MJCF, or in a build without MuJoCo.
[[nodiscard]] std::string mujoco_refuses(const std::string& file);

}  // namespace delassus
