// What of a scene only matters where it moves: velocities at the start, springs, motors, wrenches.
#include <array>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/kit/index.h"
#include "models/scene_loader.h"

namespace delassus {
namespace {

}  // namespace

/// ν of all bodies so far, zero where nothing was said.
VectorX<double>& SceneLoader::velocities() {
  VectorX<double>& nu = scene_.motion.nu;
  const Index old = nu.size();
  nu.conservativeResize(scene_.model.dofs());
  for (Index k = old; k < nu.size(); ++k) nu[k] = 0;
  return nu;
}

void SceneLoader::stands_at(const char* key) {
  if (root_.has(key)) scene_.motion.where.emplace(key, root_.at(key).file_and_line());
}

/// {joint: number, or a list with one per degree of freedom}.
void SceneLoader::read_velocities(const Robot& robot, const Yaml& y) {
  for (const auto& [joint, value] : y.entries()) {
    const auto it = robot.joints.find(joint);
    if (it == robot.joints.end()) {
      std::vector<std::string_view> names;
      for (const auto& [own, body] : robot.joints) names.push_back(own);
      value.fail("robot " + in_quotes(robot.name) + " has no moving joint of this name", did_you_mean(joint, names) + "a joint of its file that is not fixed; `delassus describe` lists them");
    }
    const Index k = scene_.model.first_dof[z(it->second)], n = dof_count(scene_.model.bodies[z(it->second)].joint.type);
    const std::vector<double> v = value.is_list() ? value.numbers(" [rad/s or m/s]") : std::vector<double>{value.number(" [rad/s or m/s]")};
    if (static_cast<Index>(v.size()) != n) value.fail("has " + std::to_string(v.size()) + " entries", std::to_string(n) + " numbers [rad/s or m/s], one per degree of freedom; angular ones first");
    for (Index i = 0; i < n; ++i) velocities()[k + i] = v[z(i)];
  }
}

/// {angular, linear} of the frame's origin in world axes; ν has them in the axes of the body.
void SceneLoader::read_velocity(Index body, const Yaml& y) {
  y.keys({"angular", "linear"});
  const auto q = scene_.q.segment<4>(scene_.model.first_q[z(body)] + 3);
  const Matrix3<double> R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  auto nu = velocities().segment<6>(scene_.model.first_dof[z(body)]);
  if (y.has("angular")) nu.head<3>() = R.transpose() * y.at("angular").vector3(" [rad/s]");
  if (y.has("linear")) nu.tail<3>() = R.transpose() * y.at("linear").vector3(" [m/s]");
}

/// The degree of freedom of a joint that `dof` picks; it must have a coordinate.
Index SceneLoader::dof_of(const Yaml& y, Index body) const {
  const JointType type = scene_.model.bodies[z(body)].joint.type;
  const Index n = dof_count(type), dof = y.has("dof") ? y.at("dof").index() : 0;
  if (dof >= n) y.at("dof").fail(std::to_string(dof) + ": the joint has " + std::to_string(n) + " degrees of freedom", "0 to " + std::to_string(n - 1) + "; count from 0");
  if (n > 1 && !y.has("dof")) y.fail("the joint has " + std::to_string(n) + " degrees of freedom", "dof: 0 to " + std::to_string(n - 1) + "; one entry for each");
  return dof;
}

void SceneLoader::read_springs(const Yaml& list) {
  for (const Yaml& y : list.list("a list of {joint, stiffness, rest, ...}")) {
    y.keys({"joint", "dof", "stiffness", "rest", "damping"});
    SceneMotion::Spring s;
    s.body = joint_of(y.at("joint"));
    s.dof = dof_of(y, s.body);
    s.stiffness = y.at("stiffness").non_negative(" [N m/rad or N/m]");
    if (y.has("rest")) s.rest = y.at("rest").number(" [rad or m]");
    if (y.has("damping")) s.damping = y.at("damping").non_negative(" [N m s/rad or N s/m]");
    if (s.stiffness > 0 && SceneMotion::coordinate(scene_.model, s.body, s.dof) < 0) y.fail("a spherical or floating joint has no coordinate to measure from", "springs of joints with angles or displacements; damping alone acts on every joint");
    s.where = y.file_and_line();
    scene_.motion.springs.push_back(s);
  }
}

void SceneLoader::read_motors(const Yaml& list) {
  for (const Yaml& y : list.list("a list of {joint, torque, ...}")) {
    y.keys({"joint", "dof", "torque", "stiffness", "damping", "target", "effort"});
    SceneMotion::Motor m;
    m.body = joint_of(y.at("joint"));
    m.dof = dof_of(y, m.body);
    if (y.has("torque")) m.torque = y.at("torque").number(" [N m or N]");
    if (y.has("stiffness")) m.stiffness = y.at("stiffness").non_negative(" [N m/rad or N/m]");
    if (y.has("damping")) m.damping = y.at("damping").non_negative(" [N m s/rad or N s/m]");
    if (y.has("target")) m.target = y.at("target").number(" [rad or m]");
    const std::vector<double>& effort = scene_.model.bodies[z(m.body)].joint.effort;
    if (y.has("effort")) m.effort = y.at("effort").non_negative(" [N m or N]");
    else if (!effort.empty()) m.effort = effort[z(m.dof)];
    if (m.stiffness > 0 && SceneMotion::coordinate(scene_.model, m.body, m.dof) < 0) y.fail("a spherical or floating joint has no coordinate to measure from", "stiffness on joints with angles or displacements; torque and damping act on every joint");
    m.where = y.file_and_line();
    scene_.motion.motors.push_back(m);
  }
}

void SceneLoader::read_wrenches(const Yaml& list) {
  for (const Yaml& y : list.list("a list of {of, force, moment, at}")) {
    y.keys({"of", "at", "force", "moment"});
    const End end = end_of(y.at("of"));
    if (end.frame.body == ground) y.at("of").fail("the world does not move", "robot/link or a box; leave the entry out");
    SceneMotion::Wrench w;
    Pose<double> at;
    if (y.has("at")) at.translation = y.at("at").vector3(" [m]");
    w.at = {end.frame.body, end.frame.placement * at};
    if (y.has("force")) w.force = y.at("force").vector3(" [N]");
    if (y.has("moment")) w.moment = y.at("moment").vector3(" [N m]");
    w.where = y.file_and_line();
    scene_.motion.wrenches.push_back(w);
  }
}

void SceneLoader::read_sleeping(const Yaml& y) {
  y.keys({"linear", "angular", "after"});
  SceneMotion::Sleeping& s = scene_.motion.sleeping;
  s.linear = y.at("linear").non_negative(" [m/s]");
  s.angular = y.at("angular").non_negative(" [rad/s]");
  s.after = y.at("after").non_negative(" [s]");
}

}  // namespace delassus
