#include "models/scene.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/scene_loader.h"

namespace delassus {

namespace {

/// Every entry once, in the order of the first.
template <class T, class Key> void once(std::vector<T>& list, const Key& key) {
  std::set<std::string> seen;
  std::erase_if(list, [&](const T& x) { return !seen.insert(key(x)).second; });
}

}  // namespace

SceneLoader::SceneLoader(const std::string& path, Yaml root, const SceneOptions& options)
    : path_(path), root_(std::move(root)), strict_(options.strict) {}

void SceneLoader::warn(const std::string& kind, const Yaml& at, const std::string& problem, const std::string& advice) {
  Findings found(strict_);
  found.warn(kind, at.file_and_line(), at.key(), problem, advice);
  scene_.warnings.push_back(found.warnings.front());
}

Scene SceneLoader::run() {
  root_.keys({"note", "pose", "strict", "gravity", "robots", "boxes", "ground", "constraints", "hold", "assembly", "springs", "motors", "wrenches", "contacts", "sleeping", "damping"});
  scene_.file = path_;
  scene_.name = std::filesystem::path(path_).stem().string();
  if (root_.has("note")) scene_.note = root_.at("note").text("a text");
  if (root_.has("strict")) strict_ = root_.at("strict").boolean() || strict_;
  if (root_.has("pose")) {
    const std::string text = root_.at("pose").text("provisional, recorded");
    if (text != "provisional" && text != "recorded") root_.at("pose").fail(in_quotes(text) + " is not understood", did_you_mean(text, std::array{"provisional", "recorded"}) + "provisional, recorded; leave the key out for recorded");
    scene_.provisional_pose = text == "provisional";
  }
  if (root_.has("gravity")) {
    scene_.has_gravity = true;
    scene_.gravity = root_.at("gravity").vector3(" [m/s^2]");
  }
  if (root_.has("ground")) {
    const Yaml y = root_.at("ground");
    y.keys({"z", "friction"});
    scene_.has_ground = true;
    if (y.has("z")) scene_.ground_height = y.at("z").number(" [m]");
    if (y.has("friction")) scene_.ground_friction = y.at("friction").non_negative("");
  }
  if (root_.has("robots"))
    for (const Yaml& y : root_.at("robots").list("a list of {name, urdf, ...}")) read_robot(y);
  if (root_.has("boxes"))
    for (const Yaml& y : root_.at("boxes").list("a list of {name, mass, size, ...}")) read_box(y);
  if (scene_.model.dofs() == 0) root_.fail("nothing in the scene can move", "robots or boxes; a robot with a joint, or base: free");
  if (root_.has("constraints"))
    for (const Yaml& y : root_.at("constraints").list("a list of {kind, ...}")) read_constraint(y);
  poses(scene_.model, scene_.q, poses_);
  fill_open(true);
  close_loops_of_scene();
  fill_open(false);
  if (root_.has("springs")) read_springs(root_.at("springs"));
  if (root_.has("sleeping")) read_sleeping(root_.at("sleeping"));
  if (root_.has("motors")) read_motors(root_.at("motors"));
  if (root_.has("wrenches")) read_wrenches(root_.at("wrenches"));
  if (root_.has("contacts")) read_contacts(root_.at("contacts"));
  for (const char* key : {"gravity", "springs", "motors", "wrenches", "contacts", "constraints", "sleeping"}) stands_at(key);
  if (scene_.motion.nu.size() > 0) velocities();  // of bodies behind the last one with a velocity
  read_damping(root_);
  validate(scene_.model, path_);
  check_finite();
  once(scene_.notes, [](const std::string& x) { return x; });
  once(scene_.warnings, [](const Warning& x) { return x.text; });
  scene_.robots = std::move(robots_);
  return std::move(scene_);
}

/// Lengths and masses that are numbers, but whose products are none.
void SceneLoader::check_finite() const {
  const Problem<double> p = kinematics(scene_.model, scene_.q);
  double farthest = 1, inertia = 0;
  for (const auto& S : p.S) farthest = std::max(farthest, S.cwiseAbs().maxCoeff());
  const auto fail = [&](const std::string& element) {
    throw ModelError(path_, element, "its numbers are so large that M or J overflows", "masses [kg] and lengths [m] whose products stay below 1.8e308; check their units");
  };
  for (std::size_t i = 0; i < p.H.size(); ++i) {
    inertia += p.H[i].cwiseAbs().maxCoeff();
    if (!std::isfinite(36 * inertia * farthest * farthest) || !p.H[i].allFinite()) fail(scene_.model.bodies[i].name);
  }
  for (const auto& e : p.structure->link_constraints)
    for (const auto& end : e.links)
      for (Index r = 0; r < e.rows; ++r)
        if (!std::isfinite(6 * p.K[static_cast<std::size_t>(end.first + r)].cwiseAbs().sum() * farthest)) fail("row " + std::to_string(e.row + r));
}

Scene load_scene(const std::string& path, const SceneOptions& options) { return SceneLoader(path, Yaml::open(path), options).run(); }

Scene load_robot(const std::string& path, const SceneOptions& options) {
  const std::filesystem::path file(path);
  std::string name = file.stem().string();
  if (name.empty() || name == "world" || name == "ground") name = "robot";
  YAML::Node robot, root;
  robot["name"] = name;
  robot["file"] = file.filename().string();
  if (options.base) robot["base"] = std::string(*options.base == RobotOptions::Base::fixed ? "fixed" : *options.base == RobotOptions::Base::free ? "free" : "planar");
  if (options.armature) robot["armature"] = number_text(*options.armature);
  root["robots"].push_back(robot);
  Scene scene = SceneLoader(path, Yaml::of(path, root), options).run();
  scene.is_robot_file = true;
  return scene;
}

}  // namespace delassus
