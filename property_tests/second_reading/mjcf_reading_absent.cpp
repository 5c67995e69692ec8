// A build without MuJoCo.
#include "property_tests/second_reading/mjcf_reading.h"

namespace delassus {

std::unique_ptr<SecondReading> mjcf_reading(const RobotOptions&) { return nullptr; }
std::string mujoco_refuses(const std::string&) { return {}; }

}  // namespace delassus
