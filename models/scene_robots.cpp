#include <array>
#include <filesystem>

#include <Eigen/Geometry>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/kit/index.h"
#include "models/scene_loader.h"

namespace delassus {
namespace {

JointType joint_type(const Yaml& y) {
  constexpr std::array types{JointType::revolute, JointType::prismatic, JointType::spherical, JointType::universal,
                             JointType::cylindrical, JointType::planar, JointType::floating};
  std::vector<std::string_view> names;
  std::string accepted;
  for (const JointType t : types) names.push_back(name(t)), accepted.append(accepted.empty() ? "" : ", ").append(name(t));
  const std::string text = y.text(accepted);
  for (const JointType t : types)
    if (text == name(t)) return t;
  y.fail(in_quotes(text) + " is no joint type", did_you_mean(text, names) + accepted + "; spherical for a ball joint");
}

RobotOptions::Base base_of(const Yaml& y) {
  const std::string accepted = "fixed, free, planar", text = y.text(accepted);
  if (text == "fixed") return RobotOptions::Base::fixed;
  if (text == "free") return RobotOptions::Base::free;
  if (text == "planar") return RobotOptions::Base::planar;
  y.fail(in_quotes(text) + " is no base", did_you_mean(text, std::array{"fixed", "free", "planar"}) + accepted + "; leave it out for free");
}

/// Solid box of uniform density.
Body box_body(double mass, const Vector3<double>& size) {
  Body b;
  b.mass = mass;
  const Vector3<double> s = size.cwiseAbs2() * (mass / 12);
  b.inertia.diagonal() << s[1] + s[2], s[0] + s[2], s[0] + s[1];
  b.joint.type = JointType::floating;
  b.shapes.push_back({Shape::Kind::box, size / 2, {}, -1, {}});
  return b;
}

}  // namespace

std::string SceneLoader::new_name(const Yaml& y) {
  const std::string accepted = "a name without '/', not world or ground", text = y.text(accepted);
  if (text.find('/') != std::string::npos || text == "world" || text == "ground") y.fail(in_quotes(text) + " cannot be a name", accepted + "; choose another");
  bool taken = scene_.frames.count(text) > 0;
  for (const Robot& r : robots_) taken = taken || r.name == text;
  if (taken) y.fail("the name " + in_quotes(text) + " is taken", "unique names of robots and boxes; choose another");
  return text;
}

RobotOptions SceneLoader::robot_options(const Yaml& y, const std::string& name) const {
  RobotOptions o;
  o.robot = name;
  if (y.has("file") && y.has("urdf")) y.fail("has file and urdf", "one of them; they mean the same");
  const Yaml path = y.at(y.has("file") ? "file" : "urdf");
  std::filesystem::path file = path.text("path of a robot's file");
  if (file.is_relative()) file = std::filesystem::path(path_).parent_path() / file;
  o.file = file.lexically_normal().string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) path.fail("the file " + in_quotes(o.file) + " cannot be read", "path of a robot's file; relative ones start at the folder of the scene");
  o.strict = strict_;
  o.base_given = y.has("base");
  if (o.base_given) o.base = base_of(y.at("base"));
  if (y.has("pose")) o.pose = y.at("pose").pose();
  if (y.has("mesh_path"))
    for (const Yaml& folder : y.at("mesh_path").list("a list of folders")) {
      const std::filesystem::path p = folder.text("a folder");
      o.mesh_path.push_back(p.is_relative() ? (std::filesystem::path(path_).parent_path() / p).string() : p.string());
    }
  if (y.has("keyframe")) o.keyframe = y.at("keyframe").text("name or number of a keyframe of an MJCF file");
  if (y.has("joint_types"))
    for (const auto& [joint, value] : y.at("joint_types").entries()) {
      RobotOptions::Type type;
      if (value.is_map()) value.keys({"type", "axis2"});
      type.type = joint_type(value.is_map() ? value.at("type") : value);
      if (value.is_map() && value.has("axis2")) type.axis2 = value.at("axis2").direction();
      o.joint_types.emplace(joint, type);
    }
  if (y.has("armature") && y.at("armature").is_scalar())
    o.armature_of_all = y.at("armature").non_negative(" [kg m^2 or kg]");
  else if (y.has("armature"))
    for (const auto& [joint, value] : y.at("armature").entries()) o.armature.emplace(joint, value.non_negative(" [kg m^2 or kg]"));
  return o;
}

/// Neutral configuration for the bodies added since.
void SceneLoader::grow_q() {
  const Index old = scene_.q.size();
  scene_.q.conservativeResize(scene_.model.q_size());
  for (Index k = old; k < scene_.q.size(); ++k) scene_.q[k] = 0;
  for (std::size_t i = object_.size(); i < scene_.model.bodies.size(); ++i) {
    const JointType t = scene_.model.bodies[i].joint.type;
    if (t == JointType::spherical) scene_.q[scene_.model.first_q[i]] = 1;
    if (t == JointType::floating) scene_.q[scene_.model.first_q[i] + 3] = 1;
    object_.push_back(objects_);
  }
  ++objects_;
}

void SceneLoader::set_pose(Index body, const Pose<double>& pose) {
  const Index k = scene_.model.first_q[z(body)];
  const Eigen::Quaterniond r(pose.rotation);
  scene_.q.segment<7>(k) << pose.translation, r.w(), r.x(), r.y(), r.z();
}

void SceneLoader::set_joints(const Robot& robot, const Yaml& joints) {
  for (const auto& [joint, value] : joints.entries()) {
    const auto it = robot.joints.find(joint);
    if (it == robot.joints.end()) {
      std::vector<std::string_view> names;
      for (const auto& [own, body] : robot.joints) names.push_back(own);
      value.fail("robot " + in_quotes(robot.name) + " has no moving joint of this name", did_you_mean(joint, names) + "a joint of its file that is not fixed; `delassus describe` lists them");
    }
    for (const Robot::Mimic& m : robot.mimics)
      if (m.body == it->second) value.fail("the joint follows another one", "no value for a mimic joint; give it to the joint that is followed");
    const Index k = scene_.model.first_q[z(it->second)], n = q_size(scene_.model.bodies[z(it->second)].joint.type);
    const std::string accepted = std::to_string(n) + " numbers [rad or m]; quaternions are w x y z";
    std::vector<double> v = value.is_list() ? value.numbers(" [rad or m]") : std::vector<double>{value.number(" [rad or m]")};
    if (static_cast<Index>(v.size()) != n) value.fail("has " + std::to_string(v.size()) + " entries", accepted);
    for (Index i = 0; i < n; ++i) scene_.q[k + i] = v[z(i)];
    if (n != 4 && n != 7) continue;
    auto quaternion = scene_.q.segment<4>(k + n - 4);
    if (quaternion.stableNorm() == 0) value.fail("the quaternion is zero", accepted);
    quaternion.stableNormalize();
  }
}

/// q_mimic = multiplier q_master + offset, along chains of mimics.
void SceneLoader::set_mimics(const Robot& robot) {
  std::map<Index, const Robot::Mimic*> by_body;
  for (const Robot::Mimic& m : robot.mimics) by_body.emplace(m.body, &m);
  for (const Robot::Mimic& m : robot.mimics) {
    double factor = m.multiplier, offset = m.offset;
    Index master = m.master;
    std::size_t steps = 0;
    for (auto it = by_body.find(master); it != by_body.end(); it = by_body.find(master)) {
      if (++steps > robot.mimics.size())
        throw ModelError(robot.file, "joint " + in_quotes(scene_.model.bodies[z(m.body)].joint.name) + " <mimic>", "mimic joints follow each other in a circle", "a chain of mimics that ends; take one <mimic> out");
      offset += factor * it->second->offset, factor *= it->second->multiplier, master = it->second->master;
    }
    scene_.q[scene_.model.first_q[z(m.body)]] = factor * scene_.q[scene_.model.first_q[z(master)]] + offset;
  }
}

/// Values given outside a joint's limits are doubtful; neutral ones are only told.
void SceneLoader::check_ranges(const Robot& robot, const Yaml& y) {
  std::map<std::string, Yaml> given;
  if (y.has("joints"))
    for (const auto& [joint, value] : y.at("joints").entries()) given.emplace(joint, value);
  std::string outside;
  int count = 0;
  for (const auto& [name, body] : robot.joints) {
    const Joint& joint = scene_.model.bodies[z(body)].joint;
    if (dof_count(joint.type) != 1 || joint.lower.empty() || joint.upper.empty()) continue;
    const double q = scene_.q[scene_.model.first_q[z(body)]], slack = 4 * 0x1p-53 * std::abs(q);  // a mimic's value is rounded twice
    if (q >= joint.lower[0] - slack && q <= joint.upper[0] + slack) continue;
    const bool turns = joint.type == JointType::revolute;
    if (const auto it = given.find(name); it != given.end()) {
      warn("angle outside its limits", it->second,
           "joint " + name + " = " + number_text(q) + (turns ? " rad" : " m") + " lies outside its limits " + number_text(joint.lower[0]) + " to " + number_text(joint.upper[0]),
           turns ? "a value in degrees is the usual cause" : "a value in millimetres is the usual cause");
    } else if (++count <= 5) {
      outside += (outside.empty() ? "" : ", ") + name + " = " + number_text(q) + " (" + number_text(joint.lower[0]) + " to " + number_text(joint.upper[0]) + ")";
    }
  }
  if (count > 0)
    scene_.notes.push_back("robot " + in_quotes(robot.name) + ": " + std::to_string(count) + (count == 1 ? " joint" : " joints") +
                           " without a given value outside the limits: " + outside + (count > 5 ? ", ..." : ""));
}

/// What is wrong with a robot's file, or with what is asked of it, and where the scene asks.
Robot SceneLoader::read_file(const Yaml& y, const RobotOptions& options) {
  const auto asked = [&](const ModelError& e, const Yaml& at) { return ModelError(std::string(e.what()) + ", read for " + at.file_and_line() + ": " + at.key()); };
  try {
    return add_robot(scene_.model, options);
  } catch (const RequestError& e) {
    if (options.file == path_) throw;  // without a scene
    Yaml at = y.has(e.key.c_str()) ? y.at(e.key.c_str()) : y;
    if (!e.name.empty() && at.is_map())
      for (const auto& [name, value] : at.entries())
        if (name == e.name) at = value;
    throw asked(e, at);
  } catch (const ModelError& e) {
    if (options.file == path_) throw;
    throw asked(e, y);
  }
}

void SceneLoader::read_robot(const Yaml& y) {
  y.keys({"name", "urdf", "file", "base", "pose", "joints", "velocities", "velocity", "joint_types", "armature", "mesh_path", "keyframe"});
  const RobotOptions options = robot_options(y, new_name(y.at("name")));
  const std::size_t before = scene_.model.constraints.size();
  Robot robot = read_file(y, options);
  own_damping_.resize(own_damping_.size() + scene_.model.constraints.size() - before);
  const Index root = robot.root_joint.empty() ? ground : robot.bodies.front();
  grow_q();
  stand(robot.standing, 0, objects_ - 1);
  if (root != ground && scene_.model.bodies[z(root)].joint.type == JointType::floating) set_pose(root, options.pose);
  for (const auto& [body, values] : robot.start)
    for (std::size_t k = 0; k < values.size(); ++k) scene_.q[scene_.model.first_q[z(body)] + static_cast<Index>(k)] = values[k];
  if (y.has("joints")) set_joints(robot, y.at("joints"));
  set_mimics(robot);
  if (y.has("velocities")) read_velocities(robot, y.at("velocities"));
  if (y.has("velocity")) {
    if (root == ground || scene_.model.bodies[z(root)].joint.type != JointType::floating) y.at("velocity").fail("the base does not float", "velocity for base: free only; velocities: {joint: value} for joints");
    read_velocity(root, y.at("velocity"));
  }
  check_ranges(robot, y);
  for (const auto& [link, frame] : robot.links) scene_.frames.emplace(robot.name + "/" + link, frame);
  scene_.notes.insert(scene_.notes.end(), robot.notes.begin(), robot.notes.end());
  scene_.warnings.insert(scene_.warnings.end(), robot.warnings.begin(), robot.warnings.end());
  robots_.push_back(std::move(robot));
}

void SceneLoader::read_box(const Yaml& y) {
  y.keys({"name", "mass", "size", "pose", "velocity", "friction", "fixed"});
  const std::string name = new_name(y.at("name"));
  const bool fixed = y.has("fixed") && y.at("fixed").boolean();
  const double mass = fixed ? 1 : y.at("mass").positive(" [kg]");
  const Vector3<double> size = y.at("size").vector3(" > 0 [m]");
  if (!(size.minCoeff() > 0)) y.at("size").fail("an edge of (" + numbers_text(size) + ") is not positive", "3 full edge lengths > 0 [m]; a thin plate still has a thickness");
  Body body = box_body(mass, size);
  if (!body.inertia.allFinite()) y.at("size").fail("gives moments of inertia beyond the range of double with the mass", "mass and size with m l^2 below 1e308 kg m^2; check their units");
  body.name = name;
  body.joint.name = name + "/base";
  if (y.has("friction")) body.shapes[0].friction = y.at("friction").non_negative("");
  const Pose<double> pose = y.has("pose") ? y.at("pose").pose() : Pose<double>{};
  if (fixed) {
    if (y.has("velocity")) y.at("velocity").fail("the box is fixed", "a velocity where it moves; leave fixed or velocity out");
    Shape shape = body.shapes[0];
    shape.placement = pose;
    grow_q();  // an object of no body
    stand({{name, shape}}, 0, objects_ - 1);
    scene_.frames.emplace(name, Frame{ground, pose});
    return;
  }
  const Index i = scene_.model.add(std::move(body));
  grow_q();
  set_pose(i, pose);
  if (y.has("velocity")) read_velocity(i, y.at("velocity"));
  scene_.frames.emplace(name, Frame{i, {}});
}

}  // namespace delassus
