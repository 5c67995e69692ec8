#include "cli/describe_robot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "bench/text.h"

namespace delassus::cli {

namespace {

const Body& body_of(const Scene& scene, Index i) { return scene.model.bodies[static_cast<std::size_t>(i)]; }

json limit_json(const std::vector<double>& limits) {
  return limits.size() == 1 && std::isfinite(limits[0]) ? json(limits[0]) : json(nullptr);
}

json joint_json(const Scene& scene, const Robot& robot, const std::string& joint_name, Index body) {
  const Joint& joint = body_of(scene, body).joint;
  json j = {{"name", joint_name}, {"type", name(joint.type)}, {"dof", dof_count(joint.type)},
            {"lower", limit_json(joint.lower)}, {"upper", limit_json(joint.upper)}};
  if (!joint.armature.empty()) j["armature"] = joint.armature;
  for (const Robot::Mimic& m : robot.mimics) {
    if (m.body != body) continue;
    std::string master;
    for (const auto& [other, i] : robot.joints)
      if (i == m.master) master = other;
    j["follows"] = {{"joint", master}, {"multiplier", m.multiplier}, {"offset", m.offset}};
  }
  return j;
}

json robot_json(const Scene& scene, const Robot& robot) {
  std::map<Index, std::string> by_body;
  for (const auto& [joint, body] : robot.joints) by_body.emplace(body, joint);
  json joints = json::array(), massless = json::array();
  double mass = 0;
  Index dofs = 0;
  for (const Index i : robot.bodies) {
    const Body& b = body_of(scene, i);
    mass += b.mass;
    dofs += dof_count(b.joint.type);
    if (b.mass == 0) massless.push_back(b.name);
    if (const auto it = by_body.find(i); it != by_body.end()) joints.push_back(joint_json(scene, robot, it->second, i));
  }
  const JointType base = robot.bodies.empty() ? JointType::floating : body_of(scene, robot.bodies.front()).joint.type;
  return {{"name", robot.name}, {"base", robot.root_joint.empty() ? "fixed" : base == JointType::planar ? "planar" : "free"},
          {"dof", dofs}, {"links", robot.links.size()}, {"bodies", robot.bodies.size()}, {"mass", mass}, {"joints", joints},
          {"massless", massless}};
}

/// `-1 … 2.5`, or `no limits`.
std::string range(const json& joint) {
  if (joint["lower"].is_null() && joint["upper"].is_null()) return "no limits";
  return (joint["lower"].is_null() ? "-inf" : joint["lower"].dump()) + " … " + (joint["upper"].is_null() ? "inf" : joint["upper"].dump());
}

void print_joint(const json& j) {
  std::string more;
  if (j.contains("armature"))
    for (const json& a : j["armature"])
      if (a != 0.0) {
        more += ", armature " + a.dump();
        break;
      }
  if (j.contains("follows"))
    more += ", follows " + j["follows"]["multiplier"].dump() + " · " + j["follows"]["joint"].get<std::string>() + " + " + j["follows"]["offset"].dump();
  std::printf("  %-32s %-12s %s%s\n", j["name"].get<std::string>().c_str(), j["type"].get<std::string>().c_str(), range(j).c_str(), more.c_str());
}

}  // namespace

json robots_json(const Scene& scene) {
  json out = json::array();
  for (const Robot& robot : scene.robots) out.push_back(robot_json(scene, robot));
  return out;
}

void print_robots(const json& robots, bool joints_too) {
  for (const json& r : robots) {
    std::printf("%-18s %s: %s base, %s dofs, %zu joints; %s links in %s moving bodies of %s kg together\n", "robot",
                r["name"].get<std::string>().c_str(), r["base"].get<std::string>().c_str(), r["dof"].dump().c_str(),
                r["joints"].size(), r["links"].dump().c_str(), r["bodies"].dump().c_str(), bench::format("%.6g", r["mass"].get<double>()).c_str());
    if (!r["massless"].empty()) {
      std::string names;
      for (std::size_t i = 0; i < std::min<std::size_t>(r["massless"].size(), 8); ++i) names += (i ? ", " : "") + r["massless"][i].get<std::string>();
      std::printf("  massless: %s%s\n", names.c_str(), r["massless"].size() > 8 ? ", … (--json lists them)" : "");
    }
    if (!joints_too) continue;
    if (!r["joints"].empty()) std::printf("  %-32s %-12s %s\n", "joint", "type", "limits [rad or m]");
    for (const json& j : r["joints"]) print_joint(j);
  }
}

}  // namespace delassus::cli
