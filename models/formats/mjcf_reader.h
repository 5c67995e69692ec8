// The steps of reading MJCF; internal to models/.   bodies → shapes → equalities → notes
#pragma once

#include "models/formats/mjcf_compile.h"
#include "models/robot_bodies.h"
#include "models/formats/xml_lines.h"

namespace delassus {

class MjcfReader {
 public:
  MjcfReader(Model& model, const RobotOptions& options);
  Robot run();

 private:
  // mjcf.cpp
  void choose_pose();
  void check_options() const;
  void check_base();
  void add_link(int b);
  void add_chain(int b, const Pose<double>& link);
  void add_base(int b, const Pose<double>& link, JointType type);
  [[nodiscard]] Joint joint_of(int j) const;
  void set_rates(int j, Joint& joint) const;
  void start(Index body, std::vector<double> q);
  void add_inertia(int b);
  void add_notes();

  // mjcf_shapes.cpp
  void add_shapes();
  void add_shape(int g);
  [[nodiscard]] bool collides(int g) const;
  [[nodiscard]] bool fill_mesh(int g, Shape& shape) const;

  // mjcf_equalities.cpp
  void add_equalities();
  void add_pair(int e);
  void add_sites(const SiteEquality& s);
  void add_joint_equality(int e);
  void add_tendon_equality(int e);
  void leave_out(const std::string& equality, const std::string& why);
  void add_loop(Constraint c, const std::string& equality);
  [[nodiscard]] std::string equality_name(int e) const;
  bool add_tendon(int t, double factor, std::vector<Constraint::Term>& terms, double& length) const;

  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }
  [[nodiscard]] std::string name(mjtObj kind, int id) const;
  [[nodiscard]] std::string link_name(int b) const;
  [[nodiscard]] std::string joint_name(int j) const;
  [[nodiscard]] Frame link_frame(int b, const Pose<double>& in_link) const;

  Model& model_;
  const RobotOptions& options_;
  CompiledMjcf file_;
  const mjModel& m_;
  Findings findings_;
  std::vector<double> qpos_;        ///< of the start pose
  std::vector<Frame> link_;         ///< per MuJoCo body
  std::vector<Index> body_of_;      ///< per MuJoCo joint; ground when the base of the options replaces it
  RobotBodies bodies_;
  XmlLines lines_;
  Robot out_;
};

/// X of a position and a quaternion w x y z of MuJoCo.
[[nodiscard]] Pose<double> mujoco_pose(const double* position, const double* quaternion);

}  // namespace delassus
