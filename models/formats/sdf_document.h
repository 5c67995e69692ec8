// What an SDF file says, as libsdformat reads it: links and joints at their places in the world, no library type.
#pragma once

#include <string>
#include <vector>

#include "models/robot.h"

namespace delassus {

struct SdfDocument {
  struct Link {
    std::string name;               ///< `link`, in nested models `model::link`; of worlds with several models too
    std::string element;            ///< `link "arm" (line 7)`
    int line = 0;                   ///< 0: not known
    Pose<double> pose;              ///< in the world
    bool fixed = false;             ///< of a static model
    bool has_inertial = false, mass_given = false;
    bool inertia_asked_of_shapes = false;  ///< <inertial auto="true">, which SDF has from 1.11 on
    double mass = 0;
    Pose<double> centre;            ///< of the inertial frame in the link
    Matrix3<double> inertia = Matrix3<double>::Zero();  ///< axes of `centre`
    std::vector<Shape> shapes;      ///< in the link's frame
    std::vector<Robot::Mesh> meshes;  ///< the same; `body` unused
  };
  struct Axis {
    Vector3<double> direction{0, 0, 1};  ///< as resolved, joint frame
    double damping = 0, friction = 0, lower = 0, upper = 0, effort = 0, velocity = 0;
    bool range_given = false, effort_given = false, velocity_given = false;
  };
  enum class Type : std::uint8_t { ball, continuous, fixed, gearbox, prismatic, revolute, revolute2, screw, universal };
  struct JointRow {
    std::string name, parent, child;  ///< parent: "world" for the world
    std::string element;              ///< `joint "j" (line 9)`
    Type type = Type::revolute;
    Pose<double> pose;                ///< in the world
    std::vector<Axis> axes;
    double thread_pitch = 0, ratio = 1;  ///< of SDF, where none is given
    std::string reference;            ///< gearbox: the link both angles are measured from
  };
  std::vector<Link> links;            ///< in the order of the file
  std::vector<JointRow> joints;
};

/// @throws ModelError naming the file and what libsdformat says against it, or that this build is without it; a number that
/// is none is named with its line. Cost O(size of the file and of what it includes).
[[nodiscard]] SdfDocument read_sdf(const RobotOptions& options, Findings& findings);

}  // namespace delassus
