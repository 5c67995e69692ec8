#include <array>
#include <set>

#include <Eigen/Geometry>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/scene_loader.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;
constexpr std::array kinds{Kind::point, Kind::weld, Kind::hinge, Kind::universal, Kind::cylindrical, Kind::prismatic,
                           Kind::planar, Kind::distance, Kind::contact, Kind::joint_friction, Kind::joint_lock, Kind::joint_limit,
                           Kind::coupling, Kind::general};

Kind kind_of(const Yaml& y) {
  std::string accepted;
  for (const Kind k : kinds) accepted += (accepted.empty() ? "" : ", ") + std::string(name(k));
  const std::string text = y.text(accepted);
  for (const Kind k : kinds)
    if (text == name(k)) return k;
  std::vector<std::string_view> names;
  for (const Kind k : kinds) names.push_back(name(k));
  y.fail(in_quotes(text) + " is no kind of constraint", did_you_mean(text, names) + accepted);
}

/// The rotation with the given z and/or x directions; x is made orthogonal to z.
Matrix3<double> axes_rotation(const Yaml& y) {
  y.keys({"x", "z"});
  if (!y.has("z") && !y.has("x")) y.fail("gives no axis", "{z: [...]}, {x: [...]} or both; leave it out for the axes of the link");
  if (!y.has("x")) return frame_about(y.at("z").direction());
  const Vector3<double> x0 = y.at("x").direction();
  const Vector3<double> z = y.has("z") ? y.at("z").direction() : Vector3<double>(frame_about(x0).col(0));
  const Vector3<double> x = x0 - x0.dot(z) * z;
  if (x.norm() <= 30 * std::numeric_limits<double>::epsilon()) y.fail("x is parallel to z", "two different directions; leave one of them out");
  Matrix3<double> R;
  R << x.normalized(), z.cross(x.normalized()), z;
  return R;
}

/// Orientation from `rpy` or `axes`; no value when neither is given.
std::optional<Matrix3<double>> orientation(const Yaml& y, const char* rpy, const char* axes) {
  if (y.has(rpy) && y.has(axes)) y.fail(std::string(rpy) + " and " + axes + " are both given", "one of them; both say the orientation");
  if (y.has(rpy)) return rotation_rpy(y.at(rpy).vector3(" [rad]"));
  if (y.has(axes)) return axes_rotation(y.at(axes));
  return std::nullopt;
}

/// Rows about a link's frame as rows about its body's frame: K_ω Rᵀ − K_v Rᵀ p̂ and K_v Rᵀ.
MatrixX<double> in_body(const MatrixX<double>& K, const Pose<double>& link) {
  const Matrix3<double> Rt = link.rotation.transpose();
  MatrixX<double> out(K.rows(), 6);
  out.leftCols<3>() = K.leftCols<3>() * Rt - K.rightCols<3>() * Rt * cross_matrix(link.translation);
  out.rightCols<3>() = K.rightCols<3>() * Rt;
  return out;
}

}  // namespace

SceneLoader::End SceneLoader::end_of(const Yaml& y) const {
  const std::string text = y.text("robot/link, a box, world");
  if (text == "world" || text == "ground") return {{}, text};
  const auto it = scene_.frames.find(text);
  if (it == scene_.frames.end()) {
    std::vector<std::string_view> names;
    for (const auto& [frame, place] : scene_.frames) names.push_back(frame);
    y.fail(in_quotes(text) + " does not exist", did_you_mean(text, names) + "robot/link, a box, world; `delassus describe SCENE --json` names the bodies");
  }
  return {it->second, text};
}

const Robot& SceneLoader::robot_of(const Yaml& y) const {
  const std::string text = y.text("a robot of the scene");
  for (const Robot& r : robots_)
    if (r.name == text) return r;
  y.fail("robot " + in_quotes(text) + " does not exist", robots_.empty() ? "no robot, the scene has none; add it to robots" : accepted_names(text, robots_) + "; the name of an entry of robots");
}

Index SceneLoader::joint_of(const Yaml& y) const {
  const std::string text = y.text("robot/joint");
  for (const Robot& r : robots_) {
    if (text.size() <= r.name.size() || text.compare(0, r.name.size() + 1, r.name + "/") != 0) continue;
    const auto it = r.joints.find(text.substr(r.name.size() + 1));
    if (it != r.joints.end()) return it->second;
  }
  std::vector<std::string> names;
  for (const Robot& r : robots_)
    for (const auto& [joint, body] : r.joints) names.push_back(r.name + "/" + joint);
  y.fail("joint " + in_quotes(text) + " does not exist or is fixed", did_you_mean(text, names) + "robot/joint of a moving joint; `delassus describe` lists them");
}

void SceneLoader::add(const Yaml& y, Constraint c) {
  if (y.has("name")) c.name = y.at("name").text("a name");
  constraint_at_.emplace(scene_.model.constraints.size(), y);
  scene_.model.constraints.push_back(std::move(c));
  own_damping_.push_back(y.has("damping") ? std::optional<Yaml>(y.at("damping")) : std::nullopt);
}

void SceneLoader::read_two_ends(const Yaml& y, Constraint c) {
  if (c.kind == Kind::distance) y.keys({"kind", "name", "of", "at", "to", "to_at", "length", "loop", "tolerance", "damping"});
  else y.keys({"kind", "name", "of", "at", "rpy", "axes", "to", "to_at", "to_rpy", "to_axes", "loop", "tolerance", "damping"});
  const End a = end_of(y.at("of")), b = end_of(y.at("to"));
  if (a.frame.body == b.frame.body) y.fail(in_quotes(a.name) + " and " + in_quotes(b.name) + " are one body", "two different bodies, or one and world; links joined by fixed joints are one body");
  c.name = std::string(name(c.kind)) + " " + a.name + " - " + b.name;
  Pose<double> at, to;
  if (y.has("at")) at.translation = y.at("at").vector3(" [m]");
  if (const auto R = orientation(y, "rpy", "axes")) at.rotation = *R;
  if (y.has("to_at")) to.translation = y.at("to_at").vector3(" [m]");
  else if (c.kind == Kind::distance) y.fail("key to_at is missing", "to_at: [x, y, z] [m]; a distance needs both points");
  const auto to_rotation = orientation(y, "to_rpy", "to_axes");
  if (to_rotation) to.rotation = *to_rotation;
  c.a = {a.frame.body, a.frame.placement * at};
  c.b = {b.frame.body, b.frame.placement * to};
  c.loop = y.has("loop") ? y.at("loop").boolean() : a.frame.body != ground && b.frame.body != ground;
  if (y.has("tolerance")) {
    c.tolerance = y.at("tolerance").non_negative(" [m or rad]");
    if (!c.loop) y.at("tolerance").fail("the constraint is no loop", "tolerance only with loop: true; leave it out, or close the loop");
  }
  if (y.has("length")) c.length = y.at("length").positive(" [m]");
  const bool length = c.kind == Kind::distance && !y.has("length");
  open_.push_back({scene_.model.constraints.size(), !y.has("to_at"), !to_rotation && c.kind != Kind::point && c.kind != Kind::distance, length, y});
  add(y, std::move(c));
}

/// Frames left open are put where the first frame is; first those of loops, before assembly, then the others.
void SceneLoader::fill_open(bool loops) {
  for (const Open& o : open_) {
    Constraint& c = scene_.model.constraints[o.constraint];
    if (c.loop != loops) continue;
    const Pose<double> a = relative_pose(poses_, c.b.body, c.a.body) * c.a.placement;
    if (o.translation) c.b.placement.translation = a.translation;
    if (o.rotation) c.b.placement.rotation = a.rotation;
    if (o.length) c.length = (a.translation - c.b.placement.translation).norm();
    if (c.kind == Kind::distance && !(c.length > 0)) o.at.fail("the two points coincide", "points apart, or length: > 0 [m]; kind: point holds two points together");
  }
}

void SceneLoader::read_joints(const Yaml& y, Kind kind) {
  const bool friction = kind == Kind::joint_friction;
  if (friction) y.keys({"kind", "name", "robot", "joint", "effort", "damping"});
  else y.keys({"kind", "name", "robot", "joint", "damping"});
  if (y.has("robot") == y.has("joint")) y.fail("needs one of robot and joint", "robot: NAME for all its joints; joint: robot/joint for one");
  std::vector<Index> bodies;
  if (y.has("joint")) bodies.push_back(joint_of(y.at("joint")));
  else
    for (const auto& [joint, body] : robot_of(y.at("robot")).joints) bodies.push_back(body);
  std::sort(bodies.begin(), bodies.end());
  if (bodies.empty()) y.at("robot").fail("the robot has no moving joint", "a robot with joints; leave the constraint out");
  for (const Index i : bodies) {
    const Joint& joint = scene_.model.bodies[static_cast<std::size_t>(i)].joint;
    Constraint c;
    c.kind = kind;
    c.a.body = i;
    c.name = std::string(delassus::name(kind)) + " " + joint.name;
    if (friction) c.friction = y.has("effort") ? y.at("effort").non_negative(" [N m or N]") : joint.friction.empty() ? 0 : joint.friction[0];
    add(y, std::move(c));
  }
}

/// One row for each finite limit asked for: of one degree of freedom and side, or of all.
void SceneLoader::read_limits(const Yaml& y) {
  y.keys({"kind", "name", "robot", "joint", "dof", "side", "damping"});
  if (y.has("robot") == y.has("joint")) y.fail("needs one of robot and joint", "robot: NAME for all its limits; joint: robot/joint for one joint");
  if (y.has("robot") && y.has("dof")) y.at("dof").fail("is given for a whole robot", "dof only with joint; name the joint, or leave dof out");
  int side = 0;  // both
  if (y.has("side")) {
    const std::string text = y.at("side").text("lower, upper");
    if (text != "lower" && text != "upper") y.at("side").fail(in_quotes(text) + " is no side", did_you_mean(text, std::array{"lower", "upper"}) + "lower, upper; leave it out for both");
    side = text == "lower" ? 1 : -1;
  }
  std::vector<Index> bodies;
  if (y.has("joint")) bodies.push_back(joint_of(y.at("joint")));
  else
    for (const auto& [joint, body] : robot_of(y.at("robot")).joints) bodies.push_back(body);
  std::sort(bodies.begin(), bodies.end());
  const std::size_t before = scene_.model.constraints.size();
  for (const Index i : bodies) {
    const Joint& joint = scene_.model.bodies[static_cast<std::size_t>(i)].joint;
    const Index n = dof_count(joint.type), dof = y.has("dof") ? y.at("dof").index() : -1;
    if (dof >= n) y.at("dof").fail(std::to_string(dof) + ": the joint has " + std::to_string(n) + " degrees of freedom", "0 to " + std::to_string(n - 1) + "; count from 0");
    for (Index k = 0; k < n; ++k)
      for (const int s : {1, -1}) {
        const std::vector<double>& limit = s > 0 ? joint.lower : joint.upper;
        if (limit.empty() || !std::isfinite(limit[static_cast<std::size_t>(k)]) || (side != 0 && s != side) || (dof >= 0 && k != dof)) continue;
        Constraint c;
        c.kind = Kind::joint_limit;
        c.a.body = i;
        c.dof = k;
        c.side = s;
        c.name = "joint_limit " + joint.name;
        if (n > 1) c.name.append(" ").append(std::to_string(k));
        c.name += s > 0 ? " lower" : " upper";
        add(y, std::move(c));
      }
  }
  if (scene_.model.constraints.size() == before)
    y.at(y.has("joint") ? "joint" : "robot").fail("has no such limit", "a joint with a finite limit on that side, or a robot with one; `delassus describe` shows the limits");
}

void SceneLoader::read_coupling(const Yaml& y, Constraint c) {
  y.keys({"kind", "name", "terms", "damping"});
  std::set<std::pair<Index, Index>> seen;
  for (const Yaml& t : y.at("terms").list("a list of {joint, dof, coefficient}")) {
    t.keys({"joint", "dof", "coefficient"});
    Constraint::Term term;
    term.body = joint_of(t.at("joint"));
    term.dof = t.has("dof") ? t.at("dof").index() : 0;
    const Index n = dof_count(scene_.model.bodies[static_cast<std::size_t>(term.body)].joint.type);
    if (term.dof >= n) t.at("dof").fail(std::to_string(term.dof) + ": the joint has " + std::to_string(n) + " degrees of freedom", "0 to " + std::to_string(n - 1) + "; count from 0");
    if (!seen.emplace(term.body, term.dof).second) t.fail("this degree of freedom appears twice", "each one once; add the coefficients up");
    term.coefficient = t.at("coefficient").number("");
    c.terms.push_back(std::move(term));
  }
  if (c.terms.empty()) y.at("terms").fail("is empty", "at least one {joint, dof, coefficient}; leave the constraint out for none");
  c.name = "coupling " + std::to_string(scene_.model.constraints.size());
  add(y, std::move(c));
}

void SceneLoader::read_general(const Yaml& y, Constraint c) {
  y.keys({"kind", "name", "terms", "damping"});
  Index rows = -1;
  for (const Yaml& t : y.at("terms").list("a list of {of, K}")) {
    t.keys({"of", "K"});
    const End end = end_of(t.at("of"));
    if (end.frame.body == ground) t.at("of").fail(in_quotes(end.name) + " is fixed to the world", "a link that moves; leave this term out");
    const MatrixX<double> K = in_body(t.at("K").matrix(rows, 6, ""), end.frame.placement);
    rows = K.rows();
    for (const Constraint::Term& other : c.terms)
      if (other.body == end.frame.body) t.at("of").fail(in_quotes(end.name) + " belongs to a body that already has a block", "each body once; add the blocks up");
    c.terms.push_back({end.frame.body, 0, 1, K});
  }
  if (c.terms.empty()) y.at("terms").fail("is empty", "at least one {of, K}; leave the constraint out for none");
  c.name = "general " + std::to_string(scene_.model.constraints.size());
  add(y, std::move(c));
}

void SceneLoader::read_constraint(const Yaml& y) {
  if (!y.is_map()) y.fail("is no mapping", "{kind: ..., ...}; begin the entry with a dash and braces");
  Constraint c;
  c.kind = kind_of(y.at("kind"));
  switch (c.kind) {
    case Kind::contact: y.fail("a contact is no entry of constraints", "an entry of contacts; move it there, without kind");
    case Kind::joint_friction:
    case Kind::joint_lock: return read_joints(y, c.kind);
    case Kind::joint_limit: return read_limits(y);
    case Kind::coupling: return read_coupling(y, std::move(c));
    case Kind::general: return read_general(y, std::move(c));
    default: return read_two_ends(y, std::move(c));
  }
}

}  // namespace delassus
