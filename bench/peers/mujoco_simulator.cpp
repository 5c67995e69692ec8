// MuJoCo 2 on our scenes, at two settings, both with elliptic cones, Newton's method and Euler with implicit joint damping.
//
// Of a step   M̂ (ν⁺ − ν) = h f + Jᵀ h F,  M̂ = M + h D:  h F from its efc_force, points and frames from its contacts, h f from its qfrc_smooth.
// Its rows    body 2 less body 1 of a contact; ours the body that moves less the other.
#include <mujoco/mujoco.h>

#include <algorithm>

#include "algorithms/kit/index.h"
#include "bench/peers/mujoco_scene.h"
#include "bench/peers/simulator.h"

namespace delassus::bench {
namespace {

using Kind = Constraint::Kind;
using Vector = VectorX<double>;

class Mujoco final : public Simulator {
 public:
  Mujoco(const Scene& scene, double step) : scene_(scene), s_(scene, step), m_(s_.m), d_(s_.d), started_(scene.motion.nu) {
    if (started_.size() == 0) started_ = Vector::Zero(scene.model.dofs());
    for (const Index k : s_.held) started_[k] = 0;
    qpos_.resize(m_->nq), qvel_.resize(m_->nv);
    s_.set(scene_.q, started_);
    first_qpos_ = Eigen::Map<const Vector>(d_->qpos, m_->nq), first_qvel_ = Eigen::Map<const Vector>(d_->qvel, m_->nv);
  }
  [[nodiscard]] mjModel& model() { return *m_; }

  /// What a step starts from; mj_resetData would clear all of its memory, which is timed.
  void reset() override {
    std::copy_n(first_qpos_.data(), m_->nq, d_->qpos);
    std::copy_n(first_qvel_.data(), m_->nv, d_->qvel);
    std::fill_n(d_->qacc_warmstart, m_->nv, 0.);
    d_->time = 0;
    for (mjWarningStat& w : d_->warning) w.number = 0;
  }
  bool step() override {
    std::copy_n(d_->qpos, m_->nq, qpos_.data());
    std::copy_n(d_->qvel, m_->nv, qvel_.data());
    if (scene_.motion.wrenches.empty()) {
      mj_step(m_, d_);
    } else {
      mj_step1(m_, d_);
      push();
      mj_step2(m_, d_);
    }
    return std::all_of(d_->warning, d_->warning + mjNWARNING, [](const mjWarningStat& w) { return w.number == 0; });
  }
  [[nodiscard]] std::string why_not() const override {
    for (int k = 0; k < mjNWARNING; ++k)
      if (d_->warning[k].number != 0) return mju_warningText(k, d_->warning[k].lastinfo);
    return "";
  }
  [[nodiscard]] Index contacts() const override { return std::count_if(d_->contact, d_->contact + d_->ncon, [](const mjContact& c) { return c.efc_address >= 0; }); }
  [[nodiscard]] Index row_count() const override { return d_->nefc; }
  [[nodiscard]] int iterations() const override { return d_->solver_iter; }
  [[nodiscard]] Vector held() const override {
    Vector out = Vector::Zero(m_->nv);
    for (const Index k : s_.held) out[k] = held_armature;
    return out;
  }

  [[nodiscard]] MatrixX<double> M(const Vector& q) override {
    s_.set(q, started_);
    return s_.witness.M();
  }
  [[nodiscard]] Vector free_acceleration(const Vector& q, const Vector& nu) override {
    s_.set(q, nu);
    mj_step1(m_, d_);
    push();
    mj_fwdActuation(m_, d_);
    mj_fwdAcceleration(m_, d_);
    return s_.witness.T(q).transpose() * Eigen::Map<const Vector>(d_->qacc_smooth, m_->nv);
  }

  [[nodiscard]] Stepped last() const override {
    Stepped out;
    out.q = q_before();
    const MatrixX<double> back = s_.witness.T(out.q).transpose();  // T is orthogonal; frames are those of the start
    out.before = back * qvel_;
    out.after = back * Eigen::Map<const Vector>(d_->qvel, m_->nv);
    out.pushed = m_->opt.timestep * (back * Eigen::Map<const Vector>(d_->qfrc_smooth, m_->nv));
    out.added = s_.armature + m_->opt.timestep * (back * Eigen::Map<const Vector>(m_->dof_damping, m_->nv));
    out.held = s_.held;
    poses(scene_.model, out.q, at_);
    for (int r = 0; r < d_->nefc;) out.rows.push_back(rows_at(r));
    return out;
  }

 private:
  /// Forces of the scene, at the frames of this step.
  void push() {
    for (int b = 0; b < m_->nbody; ++b) std::fill_n(d_->xfrc_applied + 6 * b, 6, 0.);
    for (const auto& w : scene_.motion.wrenches) {
      const int b = mj_name2id(m_, mjOBJ_BODY, reference::mujoco_name(w.at.body).c_str());
      double point[3], arm[3], moment[3];
      mju_rotVecMat(point, w.at.placement.translation.data(), d_->xmat + 9 * b);
      mju_addTo3(point, d_->xpos + 3 * b);
      mju_sub3(arm, point, d_->xipos + 3 * b);
      mju_cross(moment, arm, w.force.data());
      for (int k = 0; k < 3; ++k) d_->xfrc_applied[6 * b + k] += w.force[k], d_->xfrc_applied[6 * b + 3 + k] += moment[k] + w.moment[k];
    }
  }

  [[nodiscard]] Vector q_before() const {
    const Vector now = Eigen::Map<const Vector>(d_->qpos, m_->nq);
    std::copy_n(qpos_.data(), m_->nq, d_->qpos);
    Vector out = s_.witness.q();
    std::copy_n(now.data(), m_->nq, d_->qpos);
    return out;
  }
  /// The rows from r on that belong together; r goes behind them.
  [[nodiscard]] HeldRows rows_at(int& r) const {
    HeldRows out;
    const double h = m_->opt.timestep;
    const auto single = [&] { return Vector::Constant(1, h * d_->efc_force[r]); };
    switch (d_->efc_type[r]) {
      case mjCNSTR_EQUALITY: {
        const Connected& c = s_.connected[z(r / 3)];
        const bool turned = c.a.body == ground;
        out.constraint.kind = Kind::point;
        out.constraint.a = turned ? c.b : c.a, out.constraint.b = turned ? c.a : c.b;
        out.constraint.a.placement.rotation = world_pose(at_, out.constraint.a.body).rotation.transpose();  // rows in world axes
        out.impulse = h * Eigen::Map<const Vector>(d_->efc_force + r, 3);
        out.R_inverse = Vector::Constant(3, c.R_inverse);
        r += 3;
        return out;
      }
      case mjCNSTR_FRICTION_DOF:
      case mjCNSTR_LIMIT_JOINT: {
        const bool limit = d_->efc_type[r] == mjCNSTR_LIMIT_JOINT;
        const int dof = limit ? m_->jnt_dofadr[d_->efc_id[r]] : d_->efc_id[r];
        out.constraint.kind = limit ? Kind::joint_limit : Kind::joint_friction;
        out.constraint.a.body = s_.joint_of[z(dof)].first;
        out.constraint.dof = s_.joint_of[z(dof)].second;
        if (limit) {
          const double q = qpos_[m_->jnt_qposadr[d_->efc_id[r]]];
          const double* range = m_->jnt_range + 2 * d_->efc_id[r];
          out.constraint.side = q - range[0] < range[1] - q ? 1 : -1;
          out.gap = d_->efc_pos[r];
        } else {
          out.constraint.friction = m_->dof_frictionloss[dof];
        }
        out.impulse = single();
        ++r;
        return out;
      }
      default: return contact_at(r);
    }
  }
  [[nodiscard]] HeldRows contact_at(int& r) const {
    const mjContact& c = d_->contact[d_->efc_id[r]];
    HeldRows out;
    Index body = s_.body_of[z(m_->geom_bodyid[c.geom2])], other = s_.body_of[z(m_->geom_bodyid[c.geom1])];
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rows(c.frame);
    Matrix3<double> axes;  // tangents, normal
    axes << rows.row(1).transpose(), rows.row(2).transpose(), rows.row(0).transpose();
    Vector3<double> impulse = Vector3<double>::Zero();
    for (int k = 0; k < c.dim; ++k) impulse[k] = m_->opt.timestep * d_->efc_force[r + k];
    if (body == ground) {
      std::swap(body, other);
      axes.col(0) *= -1, axes.col(2) *= -1, impulse[2] *= -1;
    }
    const Vector3<double> point(c.pos[0], c.pos[1], c.pos[2]);
    out.constraint = contact_in_world(at_, body, other, point, axes, c.dim > 1 ? c.friction[0] : 0);
    out.impulse = impulse;
    out.R_inverse = Vector::Constant(3, scene_.motion.contact_damping);
    out.gap = c.dist;
    r += c.dim;
    return out;
  }

  Scene scene_;
  MujocoScene s_;
  mjModel* m_;
  mjData* d_;
  Vector started_, first_qpos_, first_qvel_, qpos_, qvel_;
  mutable Poses<double> at_;
};

std::unique_ptr<Simulator> make_default(const Scene& scene, double step) { return std::make_unique<Mujoco>(scene, step); }

// Tolerance 0 has it search for what rounding does not let it find, up to ten times longer, and leaves the same residual.
std::unique_ptr<Simulator> make_tightest(const Scene& scene, double step) {
  auto out = std::make_unique<Mujoco>(scene, step);
  mjModel& m = out->model();
  m.opt.tolerance = 1e-15;
  m.opt.iterations = 1000;
  m.opt.impratio = 100;
  const auto stiff = [&](int n, mjtNum* ref, mjtNum* imp) {
    for (int k = 0; k < n; ++k) {
      ref[mjNREF * k] = 2 * step, ref[mjNREF * k + 1] = 1;
      imp[mjNIMP * k] = imp[mjNIMP * k + 1] = mjMAXIMP;
    }
  };
  stiff(m.ngeom, m.geom_solref, m.geom_solimp);
  stiff(m.njnt, m.jnt_solref, m.jnt_solimp);
  stiff(m.nv, m.dof_solref, m.dof_solimp);
  stiff(m.neq, m.eq_solref, m.eq_solimp);
  return out;
}

}  // namespace

std::vector<SimulatorRow> mujoco_simulators() {
  const std::string program = std::string("MuJoCo ") + mj_versionString();
  return {{"mujoco", program, "as it comes: Newton to 1e-8, at most 100 iterations, soft contacts (solref 0.02 1); elliptic cones", make_default},
          {"mujoco_tightest", program, "as stiff as it takes: tolerance 1e-15, at most 1000 iterations, solimp 0.9999, solref 2h 1, impratio 100", make_tightest}};
}

}  // namespace delassus::bench
