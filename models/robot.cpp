#include "models/robot.h"

#include <Eigen/Geometry>

#include "models/urdf.h"

namespace delassus {

void Findings::warn(std::string kind, const std::string& file, const std::string& element, const std::string& problem,
                    const std::string& advice) {
  if (strict_) throw ModelError(file, element, problem + " (an error in strict mode)", advice);
  warnings.push_back({std::move(kind), file + ": " + element + ": " + problem + " (" + advice + ")"});
}

Robot add_robot(Model& model, const RobotOptions& options) { return add_urdf(model, options); }

Matrix3<double> rotation_rpy(const Vector3<double>& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Vector3<double>::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3<double>::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3<double>::UnitX())).toRotationMatrix();
}

}  // namespace delassus
