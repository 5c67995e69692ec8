#include "models/formats/mjcf.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/kit/index.h"
#include "models/formats/mjcf_reader.h"

namespace delassus {
namespace {

using Base = RobotOptions::Base;

Vector3<double> vector(const double* x) { return {x[0], x[1], x[2]}; }

Matrix3<double> rotation(const double* q) { return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(); }

Pose<double> shifted(const Vector3<double>& by) { return {Matrix3<double>::Identity(), by}; }

Index type_size(int type) { return type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1; }

}  // namespace

Pose<double> mujoco_pose(const double* position, const double* quaternion) { return {rotation(quaternion), vector(position)}; }

MjcfReader::MjcfReader(Model& model, const RobotOptions& options)
    : model_(model), options_(options), file_(compile_mjcf(options.file)), m_(*file_.model), findings_(options.strict),
      link_(z(m_.nbody)), body_of_(z(m_.njnt), ground), bodies_(model, options), lines_(options.file) {}

Robot MjcfReader::run() {
  out_.name = options_.robot;
  for (const std::string& said : file_.warnings) findings_.warn("MuJoCo's own", options_.file, "MuJoCo", said, "see MuJoCo's documentation");
  if (!file_.refused.empty())
    findings_.note(options_.robot + ": MuJoCo " + mj_versionString() + " refuses the file (" + file_.refused + "); it is read without visuals, sensors and actuators, which M, J and contacts do not need");
  choose_pose();
  check_options();
  check_base();
  link_[0] = {ground, options_.pose};
  for (int b = 1; b < m_.nbody; ++b) add_link(b);
  add_shapes();
  bodies_.sum();
  bodies_.add_to(model_, out_);
  add_equalities();
  add_notes();
  out_.notes = std::move(findings_.notes);
  out_.warnings = std::move(findings_.warnings);
  return std::move(out_);
}

std::string MjcfReader::name(mjtObj kind, int id) const {
  const char* text = mj_id2name(&m_, kind, id);
  return text == nullptr ? "" : text;
}

std::string MjcfReader::link_name(int b) const {
  const std::string given = name(mjOBJ_BODY, b);
  return given.empty() ? "body" + std::to_string(b) : given;
}

std::string MjcfReader::joint_name(int j) const {
  const std::string given = name(mjOBJ_JOINT, j);
  if (!given.empty()) return given;
  const int b = m_.jnt_bodyid[j], k = j - m_.body_jntadr[b];
  return link_name(b) + "_joint" + (m_.body_jntnum[b] > 1 ? std::to_string(k) : "");
}

Frame MjcfReader::link_frame(int b, const Pose<double>& in_link) const {
  const Frame& link = link_[z(b)];
  return {link.body, link.placement * in_link};
}

/// qpos0, or a keyframe of the file.
void MjcfReader::choose_pose() {
  qpos_.assign(m_.qpos0, m_.qpos0 + m_.nq);
  std::string keys;
  for (int k = 0; k < m_.nkey; ++k) keys += (k ? ", " : "") + (name(mjOBJ_KEY, k).empty() ? std::to_string(k) : name(mjOBJ_KEY, k));
  if (options_.keyframe.empty()) {
    if (m_.nkey > 0) findings_.note(options_.robot + ": the pose is the one the file is drawn in; its keyframes (" + keys + ") are left alone (keyframe: NAME takes one)");
    return;
  }
  std::vector<std::string> names;
  for (int k = 0; k < m_.nkey; ++k)
    if (names.push_back(name(mjOBJ_KEY, k)); options_.keyframe == names.back() || options_.keyframe == std::to_string(k)) {
      qpos_.assign(m_.key_qpos + k * m_.nq, m_.key_qpos + (k + 1) * m_.nq);
      return;
    }
  throw RequestError(options_.file, "keyframe", "", in_quotes(options_.keyframe) + " does not exist",
                     keys.empty() ? "no keyframe, since the file has none; give the pose by joints: {name: value}" : did_you_mean(options_.keyframe, names) + keys + "; take one of these");
}

void MjcfReader::check_options() const {
  if (!options_.joint_types.empty())
    throw RequestError(options_.file, "joint_types", options_.joint_types.begin()->first, "MJCF states the types of its joints", "no joint_types; change <joint type> in the file");
  std::vector<std::string> moving;
  for (int j = 0; j < m_.njnt; ++j) moving.push_back(joint_name(j));
  check_named_joints(options_, moving, {});
}

/// `base: free` and `planar` need one root that floats or stands on the world.
void MjcfReader::check_base() {
  if (!options_.base_given || options_.base == Base::fixed) return;
  std::string roots;
  int count = 0;
  for (int b = 1; b < m_.nbody; ++b) {
    if (m_.body_parentid[b] != 0) continue;
    const bool floats = m_.body_jntnum[b] == 1 && m_.jnt_type[m_.body_jntadr[b]] == mjJNT_FREE;
    roots += (roots.empty() ? "" : ", ") + link_name(b) + (floats ? " (free)" : m_.body_jntnum[b] == 0 ? " (fixed)" : " (on joints of its own)");
    count += floats || m_.body_jntnum[b] == 0 ? 1 : 2;
  }
  if (count != 1) throw RequestError(options_.file, "base", "", "the roots of this file are " + (roots.empty() ? "none" : roots), "one root that is free or fixed; leave base out, or base: fixed");
}

void MjcfReader::start(Index body, std::vector<double> q) { out_.start.emplace_back(body, std::move(q)); }

/// `link` in a parent that is the world: the joint of `base` instead of the file's.
void MjcfReader::add_base(int b, const Pose<double>& link, JointType type) {
  Joint joint;
  joint.name = options_.robot + "/base";
  joint.type = type;
  if (type == JointType::planar) joint.placement = link;
  if (out_.root_joint.empty() && bodies_.empty()) out_.root_joint = joint.name;
  const Index i = bodies_.add(link_name(b), ground, joint, lines_.line("body", link_name(b)));
  link_[z(b)] = {i, {}};
  if (type == JointType::planar) return;
  const Eigen::Quaterniond r(link.rotation);
  start(i, {link.translation[0], link.translation[1], link.translation[2], r.w(), r.x(), r.y(), r.z()});
}

void MjcfReader::add_link(int b) {
  const Eigen::Map<const Eigen::Vector4d> turn(m_.body_quat + 4 * b);
  if (!(std::fabs(turn.norm() - 1) < 1e-9))
    fail("body " + in_quotes(link_name(b)) + " quat", "is lost: MuJoCo's compiler makes (" + numbers_text(turn) + ") of it", "a quaternion whose square is finite and not 0");
  const Frame& parent = link_[z(m_.body_parentid[b])];
  Pose<double> link = parent.placement * mujoco_pose(m_.body_pos + 3 * b, m_.body_quat + 4 * b);
  const int joints = m_.body_jntnum[b], j = m_.body_jntadr[b];
  const bool root = m_.body_parentid[b] == 0, floats = joints == 1 && m_.jnt_type[j] == mjJNT_FREE;
  if (floats) {  // placed in the world by its own coordinates
    const double* q = qpos_.data() + m_.jnt_qposadr[j];
    link = options_.pose * mujoco_pose(q, q + 3);
  }
  const Base base = options_.base_given && root && (floats || joints == 0) ? options_.base : floats ? Base::free : Base::fixed;
  if (joints > 0 && !floats) {
    add_chain(b, link);
  } else if (base == Base::fixed) {
    link_[z(b)] = {parent.body, link};
  } else {
    if (joints == 0 && file_.fixed_inertia_lost) throw RequestError(options_.file, "base", "", "the inertia of body " + in_quotes(link_name(b)) + in_line(lines_.line("body", link_name(b))) + ", which would move, comes from meshes whose files are missing", "the files in their places; put them there, or base: fixed");
    add_base(b, link, base == Base::planar ? JointType::planar : JointType::floating);
    if (floats) {
      const Index i = link_[z(b)].body;
      Joint& joint = bodies_.body(i).joint;
      const std::string given = name(mjOBJ_JOINT, j);
      if (!given.empty()) joint.name = options_.robot + "/" + given;
      if (bodies_.size() == 1) out_.root_joint = joint.name;
      if (given.empty() && bodies_.size() > 1) joint.name = options_.robot + "/" + joint_name(j);
      set_rates(j, joint);
      body_of_[z(j)] = i;
      out_.joints.emplace(joint_name(j), i);
    }
  }
  out_.links.emplace(link_name(b), link_[z(b)]);
  add_inertia(b);
}

/// Every joint moves a body whose frame lies in the joint's anchor; `link` is the link before they move it.
void MjcfReader::add_chain(int b, const Pose<double>& link) {
  Index parent = link_[z(m_.body_parentid[b])].body;
  Pose<double> at = link;
  const int first = m_.body_jntadr[b], end = first + m_.body_jntnum[b];
  for (int j = first; j < end; ++j) {
    const Vector3<double> anchor = vector(m_.jnt_pos + 3 * j);
    Joint joint = joint_of(j);
    const Pose<double> turned = joint.placement;  // by −ref
    joint.placement = at * shifted(anchor) * turned;
    parent = bodies_.add(j + 1 == end ? link_name(b) : link_name(b) + "." + joint_name(j), parent, joint, lines_.line("body", link_name(b)));
    body_of_[z(j)] = parent;
    out_.joints.emplace(joint_name(j), parent);
    const double* q = qpos_.data() + m_.jnt_qposadr[j];
    const std::vector<double> values(q, q + type_size(m_.jnt_type[j]));
    if (values.size() == 1 ? values[0] != 0 : values[0] != 1) start(parent, values);
    at = shifted(-anchor);
  }
  link_[z(b)] = {parent, at};
}

Joint MjcfReader::joint_of(int j) const {
  Joint out;
  out.name = options_.robot + "/" + joint_name(j);
  const int type = m_.jnt_type[j];
  out.type = type == mjJNT_BALL ? JointType::spherical : type == mjJNT_SLIDE ? JointType::prismatic : JointType::revolute;
  set_rates(j, out);
  if (type == mjJNT_BALL) return out;
  out.axis = vector(m_.jnt_axis + 3 * j).normalized();
  const double ref = m_.qpos0[m_.jnt_qposadr[j]];
  if (ref != 0 && type == mjJNT_SLIDE) out.placement.translation = -ref * out.axis;
  if (ref != 0 && type == mjJNT_HINGE) out.placement.rotation = Eigen::AngleAxisd(-ref, out.axis).toRotationMatrix();
  if (m_.jnt_limited[j]) out.lower.assign(1, m_.jnt_range[2 * j]), out.upper.assign(1, m_.jnt_range[2 * j + 1]);
  return out;
}

/// Armature, damping and friction, one entry per degree of freedom.
void MjcfReader::set_rates(int j, Joint& joint) const {
  const std::size_t n = z(dof_count(joint.type));
  const int k = m_.jnt_dofadr[j];
  const auto given = options_.armature.find(joint_name(j));
  const bool of_all = m_.dof_armature[k] == 0 && options_.armature_of_all >= 0 && m_.jnt_type[j] != mjJNT_FREE;
  joint.armature.assign(n, given != options_.armature.end() ? given->second : of_all ? options_.armature_of_all : m_.dof_armature[k]);
  joint.damping.assign(n, m_.dof_damping[k]);
  joint.friction.assign(n, m_.dof_frictionloss[k]);
}

void MjcfReader::add_inertia(int b) {
  const Frame& link = link_[z(b)];
  if (link.body == ground || (m_.body_mass[b] == 0 && vector(m_.body_inertia + 3 * b).isZero(0))) return;
  const Pose<double> principal = link.placement * mujoco_pose(m_.body_ipos + 3 * b, m_.body_iquat + 4 * b);
  const Matrix3<double>& R = principal.rotation;
  Matrix3<double> I = R * vector(m_.body_inertia + 3 * b).asDiagonal() * R.transpose();
  const auto full = file_.full_inertia.find(name(mjOBJ_BODY, b));
  if (full != file_.full_inertia.end()) {  // unless the compiler was told to change it
    const Matrix3<double> exact = link.placement.rotation * full->second * link.placement.rotation.transpose();
    if ((exact - I).norm() < 1e-4 * I.norm()) I = exact;
  }
  bodies_.add_part(link.body, {m_.body_mass[b], principal.translation, I});
}

void MjcfReader::add_notes() {
  const auto count = [&](int n, const char* what, const char* why) {
    if (n > 0) findings_.note(options_.robot + ": " + std::to_string(n) + " " + what + " left out (" + why + ")");
  };
  int springs = 0, cones = 0, mocap = 0;
  for (int j = 0; j < m_.njnt; ++j) springs += m_.jnt_stiffness[j] != 0, cones += m_.jnt_limited[j] && m_.jnt_type[j] == mjJNT_BALL;
  for (int b = 0; b < m_.nbody; ++b) mocap += m_.body_mocapid[b] >= 0;
  count(springs, "joint spring(s)", "they enter neither M nor J");
  count(cones, "limit(s) of ball joints", "a cone has no single coordinate");
  count(m_.nu, "actuator(s)", "they enter neither M nor J");
  count(m_.ntendon, "tendon(s)", "equalities of fixed tendons are read, their springs, damping and limits are not");
  count(m_.nexclude + m_.npair, "contact pair(s) and exclude(s)", "links of one robot are tested against each other only with self: true, and then by its rule");
  if (mocap > 0) findings_.note(options_.robot + ": " + std::to_string(mocap) + " mocap body(s) stand where the file puts them");
  for (const std::string& what : file_.left_out)
    findings_.warn("missing asset", options_.file, what, "its file is missing, it is left out", "put the file there; contacts need collision meshes");
}

Robot add_mjcf(Model& model, const RobotOptions& options) { return MjcfReader(model, options).run(); }

MjcfSource mjcf_source(const std::string& file) {
  CompiledMjcf compiled = compile_mjcf(file);
  MjcfSource out{std::move(compiled.text), std::move(compiled.full_inertia), {}};
  for (const SiteEquality& s : compiled.site_equalities) out.sites.push_back({name_of(s), s.site1, s.site2, s.weld});
  return out;
}

}  // namespace delassus
