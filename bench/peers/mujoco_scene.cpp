#include "bench/peers/mujoco_scene.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "algorithms/kit/index.h"

namespace delassus::bench {
namespace {

using Kind = Constraint::Kind;
using reference::mujoco_name;

std::string numbers(const auto& x) {
  std::ostringstream s;
  s.precision(std::numeric_limits<double>::max_digits10);
  for (Index k = 0; k < x.size(); ++k) s << (k ? " " : "") << x[k];
  return s.str();
}

[[noreturn]] void has_not(const std::string& what) { throw ModelError("", "MuJoCo", "has no " + what, "a scene without it"); }

/// Rows of the scene's constraints that are equations, by their points.
std::vector<Connected> points_of(const Scene& scene, std::vector<Index>& held) {
  std::vector<Connected> out;
  Index row = 0;
  for (const Constraint& c : scene.model.constraints) {
    const auto first = z(row);
    row += row_count(scene.model, c);
    const double R_inverse = first < scene.damping.diagonal.size() ? scene.damping.diagonal[first] : 0;
    if (c.kind == Kind::point) out.push_back({c.a, c.b, R_inverse});
    else if (c.kind == Kind::hinge) {
      for (const double along : {-0.1, 0.1}) {
        Connected p{c.a, c.b, R_inverse};
        for (Frame* f : {&p.a, &p.b}) f->placement.translation += along * f->placement.rotation.col(2);
        out.push_back(p);
      }
    } else if (c.kind == Kind::prismatic) {
      const Frame& f = c.a.body == ground ? c.b : c.a;
      const Frame& world = c.a.body == ground ? c.a : c.b;
      const Body* b = f.body == ground ? nullptr : &scene.model.bodies[z(f.body)];
      Index free = -1;
      for (Index k = 0; k < 3; ++k)
        if (std::fabs(std::fabs(world.placement.rotation(k, 2)) - 1) < 1e-12) free = k;
      if (world.body != ground || b == nullptr || b->parent != ground || b->joint.type != JointType::floating || free < 0) has_not("prismatic rows, but of a free body along an axis of the world");
      for (Index k = 0; k < 6; ++k)
        if (k != 3 + free) held.push_back(scene.model.first_dof[z(f.body)] + k);
    } else if (c.kind == Kind::contact) {
      if (!scene.motion.detects) has_not("contacts from a list");
    } else {
      has_not(std::string(name(c.kind)) + " rows as ours");
    }
  }
  return out;
}

void check_effects(const Scene& scene) {
  const SceneMotion& s = scene.motion;
  if (s.restitution > 0) has_not("coefficient of restitution");
  if (s.torsional_friction > 0 || s.rolling_friction > 0) has_not("torsional and rolling friction in one cone with sliding, as ours");
  if (!s.between.empty()) has_not("coefficients of two bodies alone, as ours");
  if (s.sleeping.linear >= 0) has_not("sleep");
  if (!scene.damping.blocks.empty()) has_not("damping in blocks");
}

/// Which geoms meet which: a bit of an object of several bodies, whose shapes do not meet; bit 0 of a body by itself; the ground.
struct Filter {
  static constexpr int ground_bit = 1 << 30, alone = 1, all = ground_bit - 1;
  std::map<Index, int> bit;  // by object

  explicit Filter(const Scene& scene) {
    if (!scene.motion.search.apart.empty()) has_not("the pairs of links that self: true leaves out");
    std::map<Index, int> bodies;
    for (const Index object : scene.motion.search.object) ++bodies[object];
    for (const Standing& s : scene.motion.search.standing) ++bodies[s.object];
    int next = 2;
    for (const auto& [object, count] : bodies) {
      bit[object] = count == 1 ? alone : next;
      if (count > 1) next *= 2;
      if (next >= ground_bit) has_not("room for so many robots in its filter");
    }
  }
  [[nodiscard]] std::string text(Index object) const {
    const int own = bit.empty() ? alone : bit.at(object), meets = ground_bit | (own == alone ? all : all & ~own);
    return " contype=\"" + std::to_string(own) + "\" conaffinity=\"" + std::to_string(meets) + "\"";
  }
};

std::string friction_text(double mu) {
  const double usual = std::max(mu, 0.0);
  return " condim=\"" + std::string(usual > 0 ? "3" : "1") + "\" friction=\"" + numbers(Eigen::Vector3d(usual, 0, 0)) + "\"";
}

/// Geoms per body, meshes, the ground.
reference::MujocoMore text_of(const Scene& scene, const std::vector<Connected>& connected) {
  static constexpr const char* types[] = {"sphere", "cylinder", "capsule", "box", "mesh"};
  reference::MujocoMore out;
  const Filter filter(scene);
  std::size_t shapes = 0, meshes = 0;
  double seen = -1;
  const auto geom = [&](const Shape& s, Index object) {
    ++shapes;
    const double mu = scene.motion.friction >= 0 ? scene.motion.friction : s.friction;
    if (scene.motion.friction < 0 && mu >= 0 && seen >= 0 && mu != seen) has_not("smaller of two coefficients for a contact (it takes the larger)");
    seen = std::max(seen, mu);
    const Eigen::Quaterniond turned(s.placement.rotation);
    std::string text = std::string("<geom type=\"") + types[static_cast<std::size_t>(s.kind)] + "\" pos=\"" + numbers(s.placement.translation) + "\" quat=\"" +
                       numbers(Eigen::Vector4d(turned.w(), turned.x(), turned.y(), turned.z())) + "\"" + filter.text(object) + friction_text(mu);
    if (s.kind == Shape::Kind::hull) {
      const std::string name = "mesh" + std::to_string(meshes++);
      out.assets += "<mesh name=\"" + name + "\" vertex=\"";
      for (const Vector3<double>& x : *s.points) out.assets += numbers(x) + " ";
      out.assets += "\"/>\n";
      text += " mesh=\"" + name + "\"";
    } else {
      text += " size=\"" + numbers(s.size) + "\"";
    }
    return text + "/>\n";
  };
  const auto& objects = scene.motion.search.object;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    std::string& text = out.in_body.emplace_back();
    if (!scene.motion.detects) continue;
    for (const Shape& s : scene.model.bodies[i].shapes) text += geom(s, objects.empty() ? 0 : objects[i]);
  }
  if (scene.motion.detects)
    for (const Standing& s : scene.motion.search.standing) out.in_world += geom(s.shape, s.object);
  if (scene.motion.search.ground)
    out.in_world += "<geom type=\"plane\" size=\"0 0 1\" priority=\"1\" pos=\"0 0 " + numbers(Eigen::Matrix<double, 1, 1>(scene.motion.search.ground_height)) + "\" contype=\"" +
                   std::to_string(Filter::ground_bit) + "\" conaffinity=\"0\"" + friction_text(scene.motion.friction >= 0 ? scene.motion.friction : scene.ground_friction) + "/>\n";
  for (const Connected& c : connected) {
    const bool turned = c.a.body == ground;
    out.equalities += "<connect body1=\"" + mujoco_name((turned ? c.b : c.a).body) + "\"";
    if (!turned && c.b.body != ground) out.equalities += " body2=\"" + mujoco_name(c.b.body) + "\"";
    out.equalities += " anchor=\"0 0 0\"/>\n";
  }
  std::string actuators;
  for (const SceneMotion::Motor& motor : scene.motion.motors) {
    if (!std::isfinite(motor.effort) || motor.effort == 0) continue;
    const auto joints = reference::mujoco_joints(scene.model.bodies[z(motor.body)]);
    std::size_t k = 0;
    while (k < joints.size() && joints[k].dof != motor.dof) ++k;
    if (k == joints.size()) has_not("motors about an axis of a ball");
    actuators += "<general joint=\"" + mujoco_name(motor.body, k) + "\" gaintype=\"fixed\" gainprm=\"1\" biastype=\"affine\" biasprm=\"" +
                 numbers(Vector3<double>(motor.torque + motor.stiffness * motor.target, -motor.stiffness, -motor.damping)) + "\" forcelimited=\"true\" forcerange=\"" +
                 numbers(Eigen::Vector2d(-motor.effort, motor.effort)) + "\"/>\n";
  }
  if (!actuators.empty()) out.behind = "<actuator>\n" + actuators + "</actuator>\n";
  const auto dofs = static_cast<std::size_t>(scene.model.dofs());
  out.contacts = 16 * shapes;
  out.rows = 3 * out.contacts + 3 * connected.size() + 3 * dofs;
  return out;
}

Model bodies_of(const Scene& scene) {
  check_effects(scene);
  Model model = scene.model;
  model.constraints.clear();
  return model;
}

}  // namespace

MujocoScene::MujocoScene(const Scene& scene, double step)
    : connected(points_of(scene, held)), witness(bodies_of(scene), text_of(scene, connected)), m(&witness.compiled()), d(&witness.data()) {
  m->opt.timestep = step;
  m->opt.disableflags = 0;
  m->opt.jacobian = mjJAC_AUTO;
  m->opt.cone = mjCONE_ELLIPTIC;
  for (int k = 0; k < 3; ++k) m->opt.gravity[k] = scene.has_gravity ? scene.gravity[k] : 0;
  body_of.assign(z(m->nbody), ground);
  joint_of.resize(z(m->nv));
  armature = VectorX<double>::Zero(scene.model.dofs());
  take_joints(scene);
  mj_setConst(m, d);
  take_anchors();
}

void MujocoScene::take_joints(const Scene& scene) {
  const Model& model = scene.model;
  for (Index i = 0; i < static_cast<Index>(model.bodies.size()); ++i) {
    const int body = mj_name2id(m, mjOBJ_BODY, mujoco_name(i).c_str());
    body_of[z(body)] = i;
    const Joint& joint = model.bodies[z(i)].joint;
    const auto joints = reference::mujoco_joints(model.bodies[z(i)]);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const int j = m->body_jntadr[body] + static_cast<int>(k), dof = m->jnt_dofadr[j];
      const bool single = m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE;
      const int n = single ? 1 : m->jnt_type[j] == mjJNT_BALL ? 3 : 6;
      for (int r = 0; r < n; ++r) {
        const Index own = n == 6 ? (r + 3) % 6 : joints[k].dof + r;
        joint_of[z(dof + r)] = {i, own};
        const auto of = [&](const std::vector<double>& values) { return values.empty() ? 0 : values[z(own)]; };
        m->dof_damping[dof + r] = of(joint.damping);
        m->dof_frictionloss[dof + r] = of(joint.friction);
        armature[model.first_dof[z(i)] + own] = of(joint.armature);
      }
      if (!single) continue;
      const double low = joint.lower.empty() ? -INFINITY : joint.lower[z(joints[k].dof)], high = joint.upper.empty() ? INFINITY : joint.upper[z(joints[k].dof)];
      m->jnt_limited[j] = std::isfinite(low) || std::isfinite(high);
      m->jnt_range[2 * j] = std::isfinite(low) ? low : -1e10;
      m->jnt_range[2 * j + 1] = std::isfinite(high) ? high : 1e10;
      double torque = 0;  // k (rest − q) of all
      const auto spring = [&](double stiffness, double rest, double damping) {
        m->jnt_stiffness[j] += stiffness, torque += stiffness * rest, m->dof_damping[dof] += damping;
      };
      for (const auto& s : scene.motion.springs)
        if (s.body == i && s.dof == joints[k].dof) spring(s.stiffness, s.rest, s.damping);
      for (const auto& s : scene.motion.motors)
        if (s.body == i && s.dof == joints[k].dof && std::isinf(s.effort)) {
          if (s.torque != 0) has_not("constant torque beside a spring");
          spring(s.stiffness, s.target, s.damping);
        }
      if (m->jnt_stiffness[j] != 0) m->qpos_spring[m->jnt_qposadr[j]] = torque / m->jnt_stiffness[j];
    }
  }
  for (const Constraint& c : scene.model.constraints)
    if (c.kind == Kind::joint_friction) has_not("joint_friction rows as ours");
  for (const Index k : held) {
    armature[k] = held_armature;
    for (int r = 0; r < m->nv; ++r) {
      const auto [body, dof] = joint_of[z(r)];
      if (model.first_dof[z(body)] + dof == k) m->dof_armature[r] = held_armature;
    }
  }
}

void MujocoScene::take_anchors() {
  double* to = m->eq_data;
  for (const Connected& c : connected) {
    const bool turned = c.a.body == ground;
    const Vector3<double>& first = (turned ? c.b : c.a).placement.translation;
    const Vector3<double>& second = (turned ? c.a : c.b).placement.translation;
    for (Index k = 0; k < 3; ++k) to[k] = first[k], to[3 + k] = second[k];
    to += mjNEQDATA;
  }
}

void MujocoScene::set(const VectorX<double>& q, const VectorX<double>& nu) {
  witness.set(q);
  const VectorX<double> rates = witness.T(q) * nu;
  std::copy_n(rates.data(), m->nv, d->qvel);
}

}  // namespace delassus::bench
