#include "models/formats/sdf.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/inertia_check.h"
#include "models/formats/sdf_builder.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;
using Type = SdfDocument::Type;

}  // namespace

SdfBuilder::SdfBuilder(Model& model, const RobotOptions& options)
    : model_(model), options_(options), findings_(options.strict), file_(read_sdf(options, findings_)), bodies_(model, options) {}

Robot SdfBuilder::run() {
  out_.name = options_.robot;
  find_links();
  choose_tree();
  check_options();
  walk();
  bodies_.sum();
  bodies_.add_to(model_, out_);
  for (const std::size_t j : screws_) add_screw(file_.joints[j]);
  for (std::size_t j = 0; j < file_.joints.size(); ++j) {
    if (file_.joints[j].type == Type::gearbox) add_gearbox(file_.joints[j]);
    else if (!in_tree_[j]) close_loop(file_.joints[j]);
  }
  tally_.report(options_.file, findings_);
  out_.notes = std::move(findings_.notes);
  out_.warnings = std::move(findings_.warnings);
  return std::move(out_);
}

void SdfBuilder::find_links() {
  for (std::size_t k = 0; k < file_.links.size(); ++k)
    if (!index_.emplace(file_.links[k].name, k).second) fail(file_.links[k].element, "the name is taken", "unique link names; rename one of the two");
  for (const JointRow& j : file_.joints) {
    for (const std::string* end : {&j.parent, &j.child})
      if ((*end != "world" || end == &j.child) && !index_.count(*end)) {
        std::vector<std::string_view> names;
        for (const SdfDocument::Link& l : file_.links) names.push_back(l.name);
        fail(j.element, "link " + in_quotes(*end) + " does not exist", did_you_mean(*end, names) + "a link of this file" + std::string(end == &j.child ? "" : ", or world") + "; correct the name");
      }
    const std::size_t axes = j.type == Type::fixed || j.type == Type::ball ? 0 : j.type == Type::universal || j.type == Type::revolute2 || j.type == Type::gearbox ? 2 : 1;
    if (j.axes.size() < axes) fail(j.element, "has " + std::to_string(j.axes.size()) + " axes", std::to_string(axes) + "; add <axis>" + (axes > 1 ? " and <axis2>" : ""));
  }
}

/// A link hangs on the first joint that has it as child, unless that closes a circle.
void SdfBuilder::choose_tree() {
  hangs_on_.assign(file_.links.size(), none);
  in_tree_.assign(file_.joints.size(), false);
  children_.resize(file_.links.size());
  for (std::size_t j = 0; j < file_.joints.size(); ++j) {
    const JointRow& row = file_.joints[j];
    if (row.type == Type::gearbox) continue;
    const std::size_t child = index_.at(row.child);
    if (hangs_on_[child] != none || file_.links[child].fixed) continue;
    if (row.parent != "world") {
      std::size_t root = index_.at(row.parent);
      while (hangs_on_[root] != none && file_.joints[hangs_on_[root]].parent != "world") root = index_.at(file_.joints[hangs_on_[root]].parent);
      if (root == child) continue;
    }
    hangs_on_[child] = j;
    in_tree_[j] = true;
    if (row.parent != "world") children_[index_.at(row.parent)].push_back(j);
  }
}

void SdfBuilder::check_options() const {
  if (!options_.joint_types.empty())
    throw RequestError(options_.file, "joint_types", options_.joint_types.begin()->first, "SDF states the types of its joints", "no joint_types; change <joint type> in the file");
  std::vector<std::string> moving;
  std::map<std::string, std::string> others;
  for (std::size_t j = 0; j < file_.joints.size(); ++j) {
    if (file_.joints[j].type == Type::fixed) others.emplace(file_.joints[j].name, "is fixed");
    else if (!in_tree_[j]) others.emplace(file_.joints[j].name, "closes a loop");
    else moving.push_back(file_.joints[j].name);
  }
  check_named_joints(options_, moving, others);
}

/// Puts a link into a body or the ground.
void SdfBuilder::place(const SdfDocument::Link& link, const Frame& frame) {
  bodies_.place(link.name, frame, link.shapes, link.meshes, out_);
  if (frame.body == ground) return;
  const std::string element = link.element + " <inertial>";
  if (link.inertia_asked_of_shapes)
    fail(element, "auto=\"true\" asks for mass and inertia of the collision shapes, which this version of libsdformat does not compute", "<mass> [kg] and <inertia> [kg m^2] as numbers; write them into the file");
  if (link.has_inertial && !link.mass_given) findings_.warn("no mass", options_.file, element, "has no <mass>: SDF then takes 1 kg", "<mass> [kg]");
  if (!link.has_inertial)
    findings_.warn("no inertial", options_.file, element, "is missing: SDF then takes 1 kg and 1 kg m^2 about every axis", "<inertial>, or a link fixed to the world");
  judge_inertia(findings_, options_.file, element, link.mass, link.inertia);
  const Pose<double> X = frame.placement * link.centre;
  bodies_.add_part(frame.body, {link.mass, X.translation, X.rotation * link.inertia * X.rotation.transpose()});
}

/// Depth first from each root, links and joints in the order of the file.
void SdfBuilder::walk() {
  bool base_free = options_.base_given;  // the scene's base goes to the first root
  for (std::size_t k = 0; k < file_.links.size(); ++k) {
    const std::size_t j = hangs_on_[k];
    const bool stands = file_.links[k].fixed || (j != none && file_.joints[j].parent == "world" && file_.joints[j].type == Type::fixed);
    if (j == none || stands) add_root(file_.links[k], stands, std::exchange(base_free, false));
    else if (file_.joints[j].parent == "world") add_joint(j, {ground, options_.pose}, {});
    else continue;
    descend(k);
  }
  if (base_free) findings_.note(options_.file + ": every root hangs on a joint to the world; `base` of the scene has no effect");
}

void SdfBuilder::descend(std::size_t link) {
  std::vector<std::size_t> stack(children_[link].rbegin(), children_[link].rend());
  while (!stack.empty()) {
    const std::size_t j = stack.back();
    stack.pop_back();
    const std::size_t parent = index_.at(file_.joints[j].parent), child = index_.at(file_.joints[j].child);
    add_joint(j, out_.links.at(file_.joints[j].parent), file_.links[parent].pose);
    stack.insert(stack.end(), children_[child].rbegin(), children_[child].rend());
  }
}

void SdfBuilder::add_root(const SdfDocument::Link& link, bool stands, bool base_given) {
  const RobotOptions::Base own = stands ? RobotOptions::Base::fixed : RobotOptions::Base::free;
  const RobotOptions::Base base = base_given ? options_.base : own;
  if (base_given && stands && base != RobotOptions::Base::fixed)
    findings_.note(options_.file + ": link " + in_quotes(link.name) + " stands in the world; the scene sets it free");
  const Pose<double> at = options_.pose * link.pose;
  if (base == RobotOptions::Base::fixed) return place(link, {ground, at});
  Joint joint;
  const bool planar = base == RobotOptions::Base::planar;
  joint.name = options_.robot + "/" + (out_.root_joint.empty() && bodies_.empty() ? "base" : link.name + " base");
  joint.type = planar ? JointType::planar : JointType::floating;
  if (planar) joint.placement = at;
  if (bodies_.empty()) out_.root_joint = joint.name;
  const Index body = bodies_.add(link.name, ground, joint, link.line);
  place(link, {body, {}});
  if (planar) return;
  const V3& p = at.translation;
  const Eigen::Quaterniond r(at.rotation);
  out_.start.emplace_back(body, std::vector<double>{p[0], p[1], p[2], r.w(), r.x(), r.y(), r.z()});
}

/// The joint frame in the parent's body is `parent.placement` less the link's pose, times the joint's.
void SdfBuilder::add_joint(std::size_t j, const Frame& parent, const Pose<double>& parent_pose) {
  const JointRow& row = file_.joints[j];
  const SdfDocument::Link& link = file_.links[index_.at(row.child)];
  const Pose<double> at = parent.placement * parent_pose.inverse() * row.pose, link_in_joint = row.pose.inverse() * link.pose;
  if (row.type == Type::fixed) return place(link, {parent.body, at * link_in_joint});
  Joint joint = joint_of(row);
  joint.placement = at;
  const Index body = bodies_.add(row.child, parent.body, std::move(joint), link.line);
  out_.joints[row.name] = body;
  if (row.type == Type::screw) screws_.push_back(j);
  place(link, {body, link_in_joint});
}

Robot add_sdf(Model& model, const RobotOptions& options) { return SdfBuilder(model, options).run(); }

}  // namespace delassus
