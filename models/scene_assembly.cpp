// Loops of a scene closed: what is held, what is accepted, and what is told of the outcome.
#include <algorithm>
#include <charconv>
#include <set>

#include "algorithms/errors/message.h"
#include "models/scene_loader.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;

/// Three digits of a size.
std::string rough(double x) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::general, 3).ptr};
}

std::string told(const Move& m) {
  std::string out = m.turned > 0 ? rough(m.turned) + " rad" : "";
  if (m.shifted > 0) out += (out.empty() ? "" : " and ") + rough(m.shifted) + " m";
  return out;
}

}  // namespace

void SceneLoader::hold(const Yaml& y, std::vector<bool>& held) const {
  const auto hold_body = [&](Index i) {
    for (Index k = scene_.model.first_dof[i]; k < scene_.model.first_dof[i + 1]; ++k) held[static_cast<std::size_t>(k)] = true;
  };
  const std::string accepted = "robot/joint, a robot (its base and all its joints), a box";
  for (const Yaml& item : y.list("a list of " + accepted)) {
    const std::string text = item.text(accepted);
    const auto robot = std::find_if(robots_.begin(), robots_.end(), [&](const Robot& r) { return r.name == text; });
    if (robot != robots_.end()) {
      for (const Index i : robot->bodies) hold_body(i);
    } else if (text.find('/') == std::string::npos) {
      hold_body(end_of(item).frame.body);
    } else {
      hold_body(joint_of(item));
    }
  }
}

/// Keys hold and assembly. @returns whether loops are to be closed.
bool SceneLoader::assembly_options(AssemblyOptions& options) const {
  if (root_.has("hold")) {
    options.held.assign(static_cast<std::size_t>(scene_.model.dofs()), false);
    hold(root_.at("hold"), options.held);
  }
  if (!root_.has("assembly")) return true;
  const Yaml y = root_.at("assembly");
  if (y.is_scalar()) return y.boolean();
  y.keys({"tolerance"});
  options.tolerance = y.at("tolerance").non_negative(" [m or rad]");
  return true;
}

/// The element of a message about a constraint, where the scene does not have it: in a robot's file.
[[noreturn]] void SceneLoader::fail_at(Index constraint, const std::string& problem, const std::string& accepted) const {
  const auto it = constraint_at_.find(static_cast<std::size_t>(constraint));
  if (it != constraint_at_.end()) it->second.fail(problem, accepted);
  const Constraint& c = scene_.model.constraints[static_cast<std::size_t>(constraint)];
  throw ModelError(path_, std::string(delassus::name(c.kind)) + " constraint " + c.name, problem, accepted);
}

void SceneLoader::close_loops_of_scene() {
  AssemblyOptions options;
  const bool wanted = assembly_options(options);
  for (const Constraint& c : scene_.model.constraints) scene_.has_loops = scene_.has_loops || c.loop;
  scene_.assembly.q = scene_.q;
  if (!scene_.has_loops) return;
  if (!wanted) options.held.assign(static_cast<std::size_t>(scene_.model.dofs()), true);
  scene_.assembly = close_loops(scene_.model, scene_.q, options);
  if (const OpenLoops open = open_loops(scene_.model, scene_.assembly); wanted && open.worst != nullptr) {
    const std::string own = constraint_at_.count(static_cast<std::size_t>(open.worst->constraint)) ? "loop: false here, or " : "";
    fail_at(open.worst->constraint, open.problem,
            open.accepted + "; give joint values nearer to a closed pose, hold fewer joints, or a tolerance; " + own +
                "assembly: false keeps the pose as it is");
  }
  scene_.q = scene_.assembly.q;
  poses(scene_.model, scene_.q, poses_);
  tell_assembly();
}

void SceneLoader::tell_assembly() {
  const Model& model = scene_.model;
  const auto name_of = [&](Index i) { return model.bodies[static_cast<std::size_t>(i)].joint.name; };
  const auto warn_at = [&](Index constraint, const std::string& problem, const std::string& advice) {
    if (const auto it = constraint_at_.find(static_cast<std::size_t>(constraint)); it != constraint_at_.end())
      return warn("loop left open", it->second, problem, advice);
    Findings found(strict_);
    found.warn("loop left open", path_, "loop of a robot's file", problem, advice);
    scene_.warnings.push_back(found.warnings.front());
  };
  for (const Gap& g : scene_.assembly.gaps) {
    if (g.after <= g.rounding) continue;
    const char* unit = g.angle ? " rad" : " m";
    warn_at(g.constraint, model.constraints[static_cast<std::size_t>(g.constraint)].name + " is open by " + number_text(g.after) + unit + ", more than rounding (" + rough(g.rounding) + unit + ")",
            "accepted up to " + rough(g.accepted) + unit + "; dimensions with more digits close it, tolerance says what is accepted");
  }
  for (const Beyond& b : scene_.assembly.beyond)
    warn("limit broken by assembly", root_, "joint " + name_of(b.body) + " is assembled at " + number_text(b.value) + ", beyond its limit " + number_text(b.limit) + "; no closed pose within the limits was found",
         "give joint values nearer to a closed pose, or hold the joints that are right");
  for (const Constraint& c : model.constraints) {
    if (c.kind != Kind::coupling) continue;
    const auto turns = [&](const Constraint::Term& t) {
      const JointType type = model.bodies[static_cast<std::size_t>(t.body)].joint.type;
      return q_size(type) != dof_count(type);
    };
    if (std::any_of(c.terms.begin(), c.terms.end(), turns))
      scene_.notes.push_back(c.name + ": terms on spherical or floating joints have no position; assembly does not keep them");
  }
  note_moves();
}

/// Values of the scene that assembly changed: joints that have one, boxes and free bases.
void SceneLoader::note_moves() {
  const Model& model = scene_.model;
  std::set<Index> given;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].joint.type == JointType::floating) given.insert(static_cast<Index>(i));
  std::size_t k = 0;
  if (root_.has("robots"))
    for (const Yaml& y : root_.at("robots").list("")) {
      const Robot& robot = robots_[k++];
      if (y.has("joints"))
        for (const auto& [joint, value] : y.at("joints").entries()) given.insert(robot.joints.at(joint));
    }
  std::string moved;
  int count = 0;
  for (const Move& m : scene_.assembly.moves) {
    if (!given.count(m.body) || ++count > 6) continue;
    moved += (moved.empty() ? "" : ", ") + model.bodies[static_cast<std::size_t>(m.body)].joint.name + " by " + told(m);
  }
  if (count == 0) return;
  if (count > 6) moved += " and " + std::to_string(count - 6) + " more";
  scene_.notes.push_back("closing the loops changed given values: " + moved + " (hold: [robot/joint, ...] keeps them)");
}

}  // namespace delassus
