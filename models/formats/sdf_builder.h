// The steps of building a robot from an SDF document; internal to models/.   links → tree → bodies → couplings and loops
#pragma once

#include <map>
#include <utility>

#include "models/robot_bodies.h"
#include "models/tally.h"
#include "models/formats/sdf_document.h"

namespace delassus {

class SdfBuilder {
 public:
  SdfBuilder(Model& model, const RobotOptions& options);
  Robot run();

 private:
  using JointRow = SdfDocument::JointRow;
  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }

  // sdf.cpp
  void find_links();
  void choose_tree();
  void check_options() const;
  void place(const SdfDocument::Link& link, const Frame& frame);
  void walk();
  void descend(std::size_t link);
  void add_root(const SdfDocument::Link& link, bool stands, bool base_given);
  void add_joint(std::size_t j, const Frame& parent, const Pose<double>& parent_pose);

  // sdf_joints.cpp
  Joint joint_of(const JointRow& row);
  void set_limits(const JointRow& row, std::size_t n, Joint& out);
  void add_screw(const JointRow& row);
  [[nodiscard]] std::pair<Index, double> turn_of(const JointRow& gear, const std::string& link, const Vector3<double>& axis) const;
  void add_gearbox(const JointRow& row);
  [[nodiscard]] Frame frame_on(const std::string& link, const JointRow& row, const Matrix3<double>& axes) const;
  void close_loop(const JointRow& row);

  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  Model& model_;
  const RobotOptions& options_;
  Findings findings_;
  SdfDocument file_;
  RobotBodies bodies_;
  std::map<std::string, std::size_t> index_;        // link → place in file_.links
  std::vector<std::size_t> hangs_on_;               // link → joint
  std::vector<bool> in_tree_;                       // joint
  std::vector<std::vector<std::size_t>> children_;  // link → joints
  std::vector<std::size_t> screws_;
  Tally tally_;
  Robot out_;
};

}  // namespace delassus
