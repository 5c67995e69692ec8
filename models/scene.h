// Scenes: what exists (robots, boxes, ground, constraints, contacts, damping), read from a YAML file.
//
// The format is documented key by key in docs/scenes.md. Units SI, angles in radians, roll-pitch-yaw about fixed axes
// (R = Rz Ry Rx). Relative paths of robots' files are relative to the scene file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/mechanism/loop_closing.h"
#include "models/robot.h"
#include "models/scene_motion.h"

namespace delassus {

/// A scene at its configuration: everything `kinematics(model, q)` and `Operator::update` ask for.
struct Scene {
  std::string file, name;             ///< file as opened ("" for generated scenes); name: stem, or "swimmer:N"
  Model model;                        ///< bodies `robot/link`, boxes `name`; constraints in the order of the rows
  VectorX<double> q;                  ///< configuration, after assembly when there are loops; size model.q_size()
  bool is_robot_file = false;         ///< opened from a robot's file, without a scene
  bool has_gravity = false;
  Vector3<double> gravity{0, 0, 0};   ///< [m/s²], world axes
  Damping<double> damping;            ///< R⁻¹ over all rows of the model; zero when the scene gives none
  Assembly assembly;                  ///< how the loops were closed; q equals `q` above
  bool has_loops = false;             ///< some constraint is marked `loop`
  bool provisional_pose = false;      ///< the pose stands in for one that is not recorded: `pose: provisional`
  bool has_ground = false;
  double ground_height = 0;           ///< z of the ground plane [m]
  double ground_friction = -1;        ///< Coulomb coefficient; negative: not given
  std::string note;                   ///< the scene's own `note`
  std::vector<std::string> notes;     ///< what the loaders left out or changed, one sentence each, no two alike
  std::vector<Warning> warnings;      ///< what the loaders found doubtful, no two alike
  std::vector<Robot> robots;          ///< as read, in the order of the scene; their notes and warnings are above
  SceneMotion motion;                 ///< what only matters where the scene moves
  std::map<std::string, Frame> frames;  ///< every link `robot/link` and box, links merged by fixed joints included
};

struct SceneOptions {
  bool strict = false;                     ///< warnings are errors, as with `strict: true` in the scene
  std::optional<RobotOptions::Base> base;  ///< robot files only; absent: free, or fixed when the root link is named world
  std::optional<double> armature;          ///< robot files only: of every joint to which the file gives none [kg m² or kg]
};

/// Reads a scene file. @throws ModelError naming file:line, key and what is accepted. Cost O(N + m) without loops.
[[nodiscard]] Scene load_scene(const std::string& path, const SceneOptions& options = {});
/// A robot's file as a scene of its own: the robot, named as the file's stem, at its neutral configuration.
/// @throws ModelError as add_robot and load_scene.
[[nodiscard]] Scene load_robot(const std::string& path, const SceneOptions& options = {});

/// Opens a path to a .yaml file or a robot's file (any that begins with `<`), the stem of a file in models/scenes, or
/// "swimmer:N" (N ≥ 1 links). Stems are looked up in ./models/scenes, then where this library or program was installed,
/// then in the source tree. @throws ModelError listing the known names; when base or armature are given for anything but a robot's file.
[[nodiscard]] Scene open_scene(const std::string& name, const SceneOptions& options = {});

/// The stems of the scene files that come with the library, in the order of models/scenes/index.yaml.
[[nodiscard]] std::vector<std::string> scene_names();

/// The numbers of a scene at its configuration.
[[nodiscard]] inline Problem<double> problem_of(const Scene& scene) { return kinematics(scene.model, scene.q); }

}  // namespace delassus
