// What every reader of robot files (URDF, MJCF, SDF) is asked for, gives back, and reports.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/errors/status.h"
#include "algorithms/mechanism/model.h"
#include "models/contacts.h"

namespace delassus {

/// What is doubtful in an input, though an answer exists: counted by kind, listed once, an error in strict mode.
struct Warning {
  std::string kind;  ///< a few words, the same for all of its kind: "triangle inequality"
  std::string text;  ///< `file: element (line): what is doubtful (what the user can do)`
};

/// Collects what a reader reports beside the model.
class Findings {
 public:
  explicit Findings(bool strict = false) : strict_(strict) {}
  /// What was left out or changed without any effect on M, J or the scene.
  void note(std::string text) { notes.push_back(std::move(text)); }
  /// What is doubtful. @throws ModelError in strict mode.
  void warn(std::string kind, const std::string& file, const std::string& element, const std::string& problem,
            const std::string& advice);

  std::vector<std::string> notes;
  std::vector<Warning> warnings;

 private:
  bool strict_;
};

struct RobotOptions {
  struct Type {
    JointType type = JointType::spherical;
    Vector3<double> axis2{0, 1, 0};  ///< universal only, in the joint frame
  };
  enum class Base : std::uint8_t { fixed, free, planar };

  std::string file;    ///< path of the robot's file
  std::string robot;   ///< bodies are named `robot/link`, joints `robot/joint`
  Base base = Base::free;
  bool base_given = false;  ///< the scene says which base; otherwise the file may
  Pose<double> pose;   ///< of the root link in the world
  std::map<std::string, Type> joint_types;               ///< by joint name
  std::map<std::string, double> armature;                ///< by joint name; replaces the file's
  double armature_of_all = -1;                           ///< of joints that neither `armature` nor the file gives one; negative: none
  std::string keyframe;                                  ///< MJCF only: name or number of the pose to start in; empty: the drawn one
  std::vector<std::string> mesh_path;                    ///< folders that hold packages (package://name/...) or meshes
  bool strict = false;                                   ///< warnings are errors
};

/// What was added to the model.
struct Robot {
  struct Mimic {
    Index body, master;  ///< bodies moved by the joints
    double multiplier, offset;
  };
  /// A collision mesh, not read yet: models/shapes/mesh.h does that where contacts are looked for.
  struct Mesh {
    Index body;
    Pose<double> placement;               ///< of the mesh's frame in the body
    Vector3<double> scale{1, 1, 1};
    std::string uri, part;                ///< as in the file; part: the one object of the mesh file that is meant, "": all
    std::string element;                  ///< `link "arm" <mesh> (line 7)`
    double friction = -1;                 ///< Coulomb coefficient; negative: not given
    std::string link;                     ///< `robot/link`, whatever it is merged into
  };
  std::string name, root_joint;           ///< root_joint: name of the base joint, "" for a fixed base
  std::map<std::string, Frame> links;     ///< every link by its name in the file; merged ones at their place in the body
  std::map<std::string, Index> joints;    ///< moving joints by their name in the file → body they move
  std::vector<Index> bodies;              ///< in order of the model
  std::vector<int> lines;                 ///< of the file, where the link of each of `bodies` stands; 0: not known
  std::vector<std::pair<Index, std::vector<double>>> start;  ///< body → its entries of q, where the file gives a pose
  std::string file;                       ///< it was read from
  std::vector<std::string> mesh_path;
  std::vector<Mesh> meshes;
  std::vector<Standing> standing;         ///< shapes of links that are fixed to the world
  std::vector<Mimic> mimics;              ///< their coupling constraints are already in the model
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
};

/// A request of RobotOptions that the file cannot meet.
struct RequestError : ModelError {
  RequestError(const std::string& file, std::string of_key, std::string of_name, const std::string& problem, const std::string& accepted)
      : ModelError(file, of_key + " of the scene", problem, accepted), key(std::move(of_key)), name(std::move(of_name)) {}
  std::string key, name;  ///< of the scene's entry, and of its joint; "" when there is none
};

/// Every joint that the options name is among `moving`. `others`: joints of the file that do not move in the tree, and why.
/// @throws RequestError naming the joint, and the one that was probably meant.
void check_named_joints(const RobotOptions& options, const std::vector<std::string>& moving, const std::map<std::string, std::string>& others);

/// Appends a robot to a model: its bodies, then the constraints that the file gives. The reader is chosen by the file's
/// root element. @throws ModelError naming file, element (with line), value and what is accepted. Cost O(size of the file).
Robot add_robot(Model& model, const RobotOptions& options);

/// Rotation of fixed-axis roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] Matrix3<double> rotation_rpy(const Vector3<double>& rpy);

}  // namespace delassus
