// urdfdom's reading of the checked XML, held against our own.
#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>

#include "algorithms/errors/message.h"
#include "models/formats/library_console.h"
#include "models/formats/urdf_check.h"

namespace delassus {
namespace {

/// Collects what urdfdom says instead of printing it. console_bridge is global: one parse at a time.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() : lock_(library_console()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
  }
  ~Listener() override {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR ? errors : warnings).push_back(text.substr(0, 200));
  }
  std::vector<std::string> errors, warnings;

 private:
  std::lock_guard<std::mutex> lock_;
  console_bridge::LogLevel level_;
};

/// All of it: urdfdom stops at the first element that it cannot read.
std::string joined(const std::vector<std::string>& said) {
  std::string out;
  for (const std::string& text : said) out += (out.empty() ? "" : "; ") + text;
  return out;
}

urdf::ModelInterfaceSharedPtr parse(const CheckedUrdf& checked, Findings& findings) {
  Listener listener;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(checked.text);
  } catch (const std::exception& e) {
    listener.errors.push_back(e.what());
  }
  if (!model || !listener.errors.empty())
    throw ModelError(checked.file, "robot", "urdfdom: " + (listener.errors.empty() ? "gives no model" : joined(listener.errors)), "a URDF 1.0 robot; correct what urdfdom names");
  for (const std::string& text : listener.warnings) findings.warn("urdfdom", checked.file, "robot", "urdfdom: " + text, "a URDF 1.0 robot");
  for (auto& [name, link] : model->links_) {  // the tree's own pointers would be released by a recursion as deep as the robot
    link->child_links.clear();
    link->child_joints.clear();
  }
  return model;
}

/// Holds numbers of one element against each other.
class Same {
 public:
  Same(const std::string& file, std::string place) : file_(file), place_(std::move(place)) {}

  [[noreturn]] void fail(const std::string& what, const std::string& theirs, const std::string& ours) const {
    throw ModelError(file_, place_, what + " is read as " + theirs + " by urdfdom, the file says " + ours,
                     "two readings that agree; please report this file");
  }
  void equal(const char* what, double theirs, double ours) const {
    if (theirs != ours) fail(what, number_text(theirs), number_text(ours));
  }
  void vector(const std::string& what, const urdf::Vector3& t, const Vector3<double>& ours) const {
    const Vector3<double> theirs(t.x, t.y, t.z);
    if (theirs != ours) fail(what, numbers_text(theirs), numbers_text(ours));
  }
  /// Rotations are products of cosines by us and a quaternion by urdfdom: alike to 30 ε · 3.
  void pose(const std::string& what, const urdf::Pose& t, const Pose<double>& ours) const {
    vector(what + " xyz", t.position, ours.translation);
    const Matrix3<double> R = Eigen::Quaterniond(t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z).normalized().toRotationMatrix();
    const double error = (R - ours.rotation).cwiseAbs().maxCoeff();
    if (!(error < 30 * 0x1p-53 * 3)) fail(what + " rpy", "a rotation " + number_text(error) + " away", "(see rpy)");
  }

 private:
  const std::string& file_;
  std::string place_;
};

void compare_link(const std::string& file, const std::string& name, const CheckedUrdf::Link& ours, const urdf::Link& theirs) {
  const Same same(file, ours.has_inertial ? ours.inertial_place : "link " + in_quotes(name) + " (line " + std::to_string(ours.line) + ")");
  const CheckedUrdf::Inertial none, &mine = ours.has_inertial ? ours.inertial : none;
  if (ours.has_inertial != static_cast<bool>(theirs.inertial)) same.fail("<inertial>", theirs.inertial ? "there" : "missing", theirs.inertial ? "none" : "one");
  if (!theirs.inertial) return;
  const urdf::Inertial& in = *theirs.inertial;
  same.equal("mass", in.mass, mine.mass);
  same.pose("origin", in.origin, mine.origin);
  const Matrix3<double>& I = mine.inertia;
  same.equal("ixx", in.ixx, I(0, 0)), same.equal("ixy", in.ixy, I(0, 1)), same.equal("ixz", in.ixz, I(0, 2));
  same.equal("iyy", in.iyy, I(1, 1)), same.equal("iyz", in.iyz, I(1, 2)), same.equal("izz", in.izz, I(2, 2));
}

void compare_joint(const std::string& file, const CheckedUrdf::JointRow& ours, const urdf::Joint& theirs) {
  const Same same(file, ours.place);
  if (theirs.parent_link_name != ours.parent) same.fail("parent", in_quotes(theirs.parent_link_name), in_quotes(ours.parent));
  if (theirs.child_link_name != ours.child) same.fail("child", in_quotes(theirs.child_link_name), in_quotes(ours.child));
  same.pose("origin", theirs.parent_to_joint_origin_transform, ours.origin);
  if (ours.fixed()) return;
  if (ours.type != "floating") same.vector("axis", theirs.axis, ours.axis);
  if (ours.range_given) {
    if (!theirs.limits) same.fail("limit", "missing", "given");
    if (std::isfinite(ours.lower)) same.equal("lower", theirs.limits->lower, ours.lower);
    if (std::isfinite(ours.upper)) same.equal("upper", theirs.limits->upper, ours.upper);
  }
  if (ours.effort_given) same.equal("effort", theirs.limits ? theirs.limits->effort : 0, ours.effort);
  if (ours.velocity_given) same.equal("velocity", theirs.limits ? theirs.limits->velocity : 0, ours.velocity);
  same.equal("damping", theirs.dynamics ? theirs.dynamics->damping : 0, ours.damping);
  same.equal("friction", theirs.dynamics ? theirs.dynamics->friction : 0, ours.friction);
  if (theirs.mimic ? theirs.mimic->joint_name != ours.master : !ours.master.empty())
    same.fail("mimic", theirs.mimic ? in_quotes(theirs.mimic->joint_name) : "missing", in_quotes(ours.master));
  if (theirs.mimic) same.equal("multiplier", theirs.mimic->multiplier, ours.multiplier), same.equal("offset", theirs.mimic->offset, ours.offset);
}

}  // namespace

std::shared_ptr<urdf::ModelInterface> read_by_urdfdom(const CheckedUrdf& checked, Findings& findings) {
  const auto model = parse(checked, findings);
  for (const auto& [name, link] : checked.links) {
    const auto it = model->links_.find(name);
    if (it == model->links_.end() || !it->second) throw ModelError(checked.file, "link " + in_quotes(name) + " (line " + std::to_string(link.line) + ")", "is dropped by urdfdom", "a URDF 1.0 robot; please report this file");
    compare_link(checked.file, name, link, *it->second);
  }
  for (const CheckedUrdf::JointRow& row : checked.joints) {
    const auto it = model->joints_.find(row.name);
    if (it == model->joints_.end() || !it->second) throw ModelError(checked.file, row.place, "is dropped by urdfdom", "a URDF 1.0 robot; please report this file");
    compare_joint(checked.file, row, *it->second);
  }
  return model;
}

}  // namespace delassus
