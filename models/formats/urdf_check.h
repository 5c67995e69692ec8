// Our own reading of a URDF: every number once, checked, and the XML that urdfdom is given instead of the file.
//   urdf_check.cpp     the document: links, joints, one tree; what is left out
//   urdf_links.cpp     inertials and collision primitives
//   urdf_joints.cpp    joints
//   urdf_reading.cpp   urdfdom's reading of that XML, held against ours
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "models/robot.h"
#include "models/tally.h"
#include "models/formats/urdf_xml.h"

namespace urdf {
class ModelInterface;
}

namespace delassus {

/// What a URDF says, as far as it can enter the model.
struct CheckedUrdf {
  struct Inertial {
    double mass = 0;
    Pose<double> origin;
    Matrix3<double> inertia = Matrix3<double>::Zero();  ///< in the axes of `origin`
  };
  struct Link {
    int line = 0;
    bool has_inertial = false;
    Inertial inertial;
    std::string inertial_place;  ///< `link "arm" <inertial> (line 7)`
    std::vector<Shape> shapes;   ///< collision primitives in the link frame
    std::vector<Robot::Mesh> meshes;  ///< the same; `body` unused
  };
  struct JointRow {
    std::string name, type, parent, child;
    Pose<double> origin;
    Vector3<double> axis{1, 0, 0};     ///< as written, not normalised
    double armature = 0, damping = 0, friction = 0, lower = 0, upper = 0, effort = 0, velocity = 0;
    bool armature_given = false, effort_given = false, velocity_given = false, range_given = false;
    std::string master;                ///< of a mimic; "" for none
    double multiplier = 1, offset = 0;
    std::string place;                 ///< `joint "j" (line 9)`
    [[nodiscard]] bool fixed() const { return type == "fixed"; }
  };
  std::string file;
  std::string root;                                    ///< the one link without a parent
  std::vector<JointRow> joints;                        ///< in the order of the file
  std::map<std::string, std::vector<Index>> children;  ///< link → joints leaving it, in the order of the file
  std::map<std::string, Link> links;
  std::string text;                                    ///< the same URDF without all that is not read, for urdfdom
};

/// Reads and checks a URDF. @throws ModelError naming file, element (with line), value and what is accepted.
/// Cost O(size of the file).
[[nodiscard]] CheckedUrdf check_urdf(const std::string& file, Findings& findings);

/// Reads `checked.text` by urdfdom and holds every number against ours: mass, inertia, origins, axes, limits, dynamics,
/// mimics; equal, rotations to 30 ε · 3. What urdfdom says becomes a warning when it is one.
/// @throws ModelError naming the link or joint, both values; or with urdfdom's errors. Cost O(links).
[[nodiscard]] std::shared_ptr<urdf::ModelInterface> read_by_urdfdom(const CheckedUrdf& checked, Findings& findings);

// Parts of check_urdf.
void check_link(const std::string& file, tinyxml2::XMLElement& e, CheckedUrdf& out, Findings& findings, Tally& tally, int& meshes);
[[nodiscard]] CheckedUrdf::JointRow joint_row(const std::string& file, tinyxml2::XMLElement& e, Findings& findings, Tally& tally);
/// Reports every element and attribute that is not read, and removes the elements.
void leave_out(const std::string& file, tinyxml2::XMLElement& robot, Findings& findings);

}  // namespace delassus
