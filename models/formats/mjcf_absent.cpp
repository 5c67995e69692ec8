// Stands in for the MJCF reader where MuJoCo is not installed.
#include "models/formats/mjcf.h"

namespace delassus {
namespace {

[[noreturn]] void refuse(const std::string& file) {
  throw ModelError(file, "mujoco", "an MJCF file cannot be read: built without MuJoCo",
                   "URDF; or install libmujoco-dev (version 2) and build again");
}

}  // namespace

Robot add_mjcf(Model&, const RobotOptions& options) { refuse(options.file); }
MjcfSource mjcf_source(const std::string& file) { refuse(file); }

}  // namespace delassus
