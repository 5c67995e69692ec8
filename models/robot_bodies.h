// The bodies of a robot while its file is read: links are placed in them, their masses summed, and all are added to the
// model together. What is the same for every reader of robot files.
#pragma once

#include <string>
#include <vector>

#include "models/parts.h"
#include "models/robot.h"

namespace delassus {

class RobotBodies {
 public:
  RobotBodies(const Model& model, const RobotOptions& options)
      : options_(options), first_(static_cast<Index>(model.bodies.size())) {}

  /// A body without mass and shapes, `robot/link`. `line` of the link in the file, 0: not known. @returns its index in the model.
  Index add(const std::string& link, Index parent, Joint joint, int line);
  /// Shapes and meshes given in the frame of a link that stands at `at`.
  void place(const std::string& link, const Frame& at, const std::vector<Shape>& shapes, const std::vector<Robot::Mesh>& meshes, Robot& out);
  void add_part(Index body, const Part& part) { parts_[local(body)].push_back(part); }
  [[nodiscard]] Body& body(Index body) { return bodies_[local(body)]; }
  [[nodiscard]] bool empty() const { return bodies_.empty(); }
  [[nodiscard]] std::size_t size() const { return bodies_.size(); }

  /// Sums the parts of every body. Cost O(parts).
  void sum();
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<std::vector<Part>>& parts() const { return parts_; }
  /// Judges every body and appends it to the model. @throws ModelError naming file, body (with line), value and what is accepted.
  void add_to(Model& model, Robot& out);

 private:
  [[nodiscard]] std::size_t local(Index body) const { return static_cast<std::size_t>(body - first_); }

  const RobotOptions& options_;
  Index first_;
  std::vector<Body> bodies_;
  std::vector<std::vector<Part>> parts_;
  std::vector<int> lines_;
};

}  // namespace delassus
