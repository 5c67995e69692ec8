#include "models/robot.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/mechanism/regularity.h"
#include "models/formats/mjcf.h"
#include "models/formats/sdf.h"
#include "models/formats/urdf.h"
#include "models/formats/urdf_xml.h"

namespace delassus {
namespace {

/// A format of robot files: a row per reader.
struct Reader {
  std::string_view root;  ///< name of the root element
  std::string_view what;
  Robot (*read)(Model& model, const RobotOptions& options);
};

constexpr Reader readers[] = {{"robot", "URDF", add_urdf}, {"mujoco", "MJCF", add_mjcf}, {"sdf", "SDF", add_sdf}};

const Reader& reader_of(const std::string& file) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& element = load_xml(document, file);
  const std::string root = element.Name();
  const int line = element.GetLineNum();
  std::string known;
  for (const Reader& r : readers) {
    if (root == r.root) return r;
    known += (known.empty() ? "<" : ", <") + std::string(r.root) + "> (" + std::string(r.what) + ")";
  }
  throw ModelError(file, "<" + root + "> (line " + std::to_string(line) + ")", "this root element is no robot", known + "; a scene of robots is a .yaml file");
}

/// Whether the robot's part of M is regular; trees do not couple in M. Bodies are named with their lines.
void check_regular_robot(const Model& model, std::size_t first, const std::string& file, const Robot& robot) {
  Model tree;
  for (std::size_t i = first; i < model.bodies.size(); ++i) {
    Body body = model.bodies[i];
    if (body.parent != ground) body.parent -= static_cast<Index>(first);
    body.shapes.clear();
    body.name += in_line(robot.lines[i - first]);
    tree.add(std::move(body));
  }
  check_regular(tree, file);
}

}  // namespace

void Findings::warn(std::string kind, const std::string& file, const std::string& element, const std::string& problem,
                    const std::string& advice) {
  if (strict_) throw ModelError(file, element, problem + " (an error in strict mode)", advice + "; mend the file, or leave strict mode off");
  warnings.push_back({std::move(kind), file + ": " + element + ": " + problem + " (" + advice + ")"});
}

void check_named_joints(const RobotOptions& options, const std::vector<std::string>& moving, const std::map<std::string, std::string>& others) {
  const auto check = [&](const std::string& key, const std::string& joint) {
    if (std::find(moving.begin(), moving.end(), joint) != moving.end()) return;
    if (const auto it = others.find(joint); it != others.end())
      throw RequestError(options.file, key, joint, "joint " + in_quotes(joint) + " " + it->second, "a moving joint; leave this one out");
    throw RequestError(options.file, key, joint, "joint " + in_quotes(joint) + " does not exist",
                       did_you_mean(joint, moving) + "a moving joint of the file; `delassus describe FILE` lists them");
  };
  for (const auto& [joint, type] : options.joint_types) check("joint_types", joint);
  for (const auto& [joint, value] : options.armature) check("armature", joint);
}

Robot add_robot(Model& model, const RobotOptions& options) {
  const std::size_t first = model.bodies.size();
  const Reader& reader = reader_of(options.file);
  if (!options.keyframe.empty() && reader.what != "MJCF")
    throw RequestError(options.file, "keyframe", "", in_quotes(options.keyframe) + ": a " + std::string(reader.what) + " file has no keyframes",
                       "an MJCF file; give the pose by joints: {name: value}");
  Robot robot = reader.read(model, options);
  check_regular_robot(model, first, options.file, robot);
  robot.file = options.file;
  robot.mesh_path = options.mesh_path;
  return robot;
}

Matrix3<double> rotation_rpy(const Vector3<double>& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Vector3<double>::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3<double>::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3<double>::UnitX())).toRotationMatrix();
}

}  // namespace delassus
