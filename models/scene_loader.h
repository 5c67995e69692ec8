// The steps of reading a scene; internal to models/.
//   robots and boxes → constraints → loops closed → what is left open follows the pose → contacts → damping
#pragma once

#include <map>
#include <optional>

#include "models/contacts.h"
#include "models/scene.h"
#include "models/robot.h"
#include "models/formats/yaml.h"

namespace delassus {

class SceneLoader {
 public:
  SceneLoader(const std::string& path, Yaml root, const SceneOptions& options);
  Scene run();

 private:
  /// A constraint whose second frame (or length) is where the first one is at the pose.
  struct Open {
    std::size_t constraint;
    bool translation, rotation, length;
    Yaml at;
  };
  struct End {
    Frame frame;
    std::string name;
  };

  // scene_robots.cpp
  void read_robot(const Yaml& y);
  [[nodiscard]] Robot read_file(const Yaml& y, const RobotOptions& options);
  void read_box(const Yaml& y);
  [[nodiscard]] std::string new_name(const Yaml& y);
  [[nodiscard]] RobotOptions robot_options(const Yaml& y, const std::string& name) const;
  void set_joints(const Robot& robot, const Yaml& joints);
  void set_mimics(const Robot& robot);
  void check_finite() const;
  void check_ranges(const Robot& robot, const Yaml& y);
  void set_pose(Index body, const Pose<double>& pose);
  void grow_q();

  // scene_constraints.cpp
  void read_constraint(const Yaml& y);
  void read_two_ends(const Yaml& y, Constraint c);
  void read_joints(const Yaml& y, Constraint::Kind kind);
  void read_limits(const Yaml& y);
  void read_coupling(const Yaml& y, Constraint c);
  void read_general(const Yaml& y, Constraint c);
  void add(const Yaml& y, Constraint c);
  [[nodiscard]] End end_of(const Yaml& y) const;
  [[nodiscard]] Index joint_of(const Yaml& y) const;
  [[nodiscard]] const Robot& robot_of(const Yaml& y) const;
  void fill_open(bool loops);

  // scene_assembly.cpp
  void close_loops_of_scene();
  [[nodiscard]] bool assembly_options(AssemblyOptions& options) const;
  void hold(const Yaml& y, std::vector<bool>& held) const;
  [[noreturn]] void fail_at(Index constraint, const std::string& problem, const std::string& accepted) const;
  void tell_assembly();
  void note_moves();

  // scene_motion.cpp
  void read_velocities(const Robot& robot, const Yaml& velocities);
  void read_velocity(Index body, const Yaml& y);
  void read_springs(const Yaml& y);
  void read_motors(const Yaml& y);
  void read_wrenches(const Yaml& y);
  void read_sleeping(const Yaml& y);
  [[nodiscard]] Index dof_of(const Yaml& y, Index body) const;
  VectorX<double>& velocities();
  void stands_at(const char* key);

  // scene_contacts.cpp
  void read_contacts(const Yaml& y);
  void read_contact(const Yaml& y, double friction);
  void detect(const Yaml* y);
  void stand(const std::vector<Standing>& shapes, std::size_t first, Index object);
  void stand_apart(ContactSearch& search);
  void collide_within(ContactSearch& search);
  void read_between(const Yaml& y);
  [[nodiscard]] std::vector<Index> touched(const Yaml& y) const;
  [[nodiscard]] static double restitution(const Yaml& y);
  void read_damping(const Yaml& root);
  void damp(const Yaml& y, Index row, Index rows);

  /// A doubt about a value of the scene. @throws ModelError in strict mode.
  void warn(const std::string& kind, const Yaml& at, const std::string& problem, const std::string& advice);

  std::string path_;
  Yaml root_;
  bool strict_;
  Scene scene_;
  std::vector<Robot> robots_;
  std::vector<Index> object_;                     // per body: index of its robot or box
  Index objects_ = 0;
  std::vector<Open> open_;
  std::vector<std::optional<Yaml>> own_damping_;  // per constraint
  std::map<std::size_t, Yaml> constraint_at_;     // those of the scene: where they stand
  Poses<double> poses_;                           // at scene_.q
};

}  // namespace delassus
