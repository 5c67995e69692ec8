// MuJoCo 2: products by its sparse factor of M, its matrix A + R, and its Newton solver, on the model of reference/mujoco_witness.h.
//
// Rows     points and contacts are `connect` equalities: world axes, body 1 less body 2, the ground never first. Ours are ±Rᵀ of theirs,
//          R the axes of our rows; R⁻¹ must not differ within one constraint, so that it does not notice.
// Damping  it makes its own from solref and solimp, within limits; here efc_R and efc_D are set to R⁻¹ and R after it made its rows.
// Product  J (M⁻¹(Jᵀx)) + R⁻¹x by mj_mulJacTVec, mj_solveM, mj_mulJacVec; or A + R as mj_projectConstraint forms it for PGS.
// Solve    the Newton solver minimises ½‖ν‖²_M + ½‖J ν − a‖²_R, whose forces R (a − J ν) are Λ_R a. A quadratic takes it one step; it
//          keeps no factor from one call to the next. Started from zero, not from its last answer. Tolerance: `tolerance` below.
#include <mujoco/mujoco.h>

#include <algorithm>

#include "algorithms/mechanism/kinematics.h"
#include "bench/peers/peer.h"
#include "reference/mujoco_witness.h"

namespace delassus::bench {
namespace {

using Kind = Constraint::Kind;
using Vector = VectorX<double>;

/// The scene with points only, in the frames that it has.
Model with_points(const Model& model) {
  Model out = model;
  for (Constraint& c : out.constraints) {
    if (c.kind != Kind::point && c.kind != Kind::contact)
      throw ModelError("", c.name, std::string(name(c.kind)), "points and contacts: of MuJoCo's rows this comparison makes no others linear");
    c.kind = Kind::point;
  }
  return out;
}

class Mujoco : public Peer {
 public:
  Mujoco(const Scene& scene, const Damping<double>& damping, const Vector& x, mjtSolver solver) : witness_(with_points(scene.model)), m_(&witness_.compiled()), d_(&witness_.data()) {
    constexpr double tolerance = 1e-15;  // of the gradient and of the decrease, relative: as near to zero as rounding lets it come
    m_->opt.jacobian = mjJAC_AUTO;
    m_->opt.solver = solver;
    m_->opt.tolerance = tolerance;
    m_->opt.disableflags |= mjDSBL_WARMSTART;
    set(scene.q);
    if (d_->nefc != x.size()) throw ModelError("", "MuJoCo", std::to_string(d_->nefc) + " rows", std::to_string(x.size()));
    if (!damping.blocks.empty()) throw ModelError("", "damping", "in blocks", "a number per row");
    R_inverse_ = Eigen::Map<const Vector>(damping.diagonal.data(), x.size());
    other_ = 1.5 * R_inverse_;
    axes_of(scene);
    x_.resize(x.size()), y_ = x_;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const auto r = R_inverse_.segment<3>(3 * static_cast<Index>(k));
      if ((r.array() != r[0]).any()) throw ModelError("", scene.model.constraints[k].name + " damping", "differs between its rows", "one number: MuJoCo's rows are in world axes");
      x_.segment<3>(3 * static_cast<Index>(k)) = axes_[k] * x.segment<3>(3 * static_cast<Index>(k));
    }
    kinematics();
  }

  [[nodiscard]] Vector answer() const override {
    Vector out(y_.size());
    for (std::size_t k = 0; k < axes_.size(); ++k) out.segment<3>(3 * static_cast<Index>(k)) = axes_[k].transpose() * y_.segment<3>(3 * static_cast<Index>(k));
    return out;
  }
  [[nodiscard]] MatrixX<double> M() override { return witness_.M(); }

 protected:
  void kinematics() {
    mj_kinematics(m_, d_);
    mj_comPos(m_, d_);
    mj_makeConstraint(m_, d_);
    set_damping(R_inverse_);
  }
  void factor() {
    mj_crb(m_, d_);
    mj_factorM(m_, d_);
  }
  void set_damping(const Vector& R_inverse) {
    for (Index r = 0; r < R_inverse.size(); ++r) d_->efc_R[r] = R_inverse[r], d_->efc_D[r] = 1 / R_inverse[r];
  }
  const Vector& next_damping() { return (odd_ = !odd_) ? other_ : R_inverse_; }

  reference::MujocoWitness witness_;
  mjModel* m_;
  mjData* d_;
  Vector R_inverse_, other_, x_, y_;

 private:
  void set(const VectorX<double>& q) try {
    witness_.set(q);
  } catch (const std::runtime_error& warning) {
    throw ModelError("", "scene", warning.what(), "a scene that it has room for");
  }
  void axes_of(const Scene& scene) {
    Poses<double> at;
    poses(scene.model, scene.q, at);
    for (const Constraint& c : scene.model.constraints) {
      const Matrix3<double> body = c.a.body == ground ? Matrix3<double>(Matrix3<double>::Identity()) : at.rotation[static_cast<std::size_t>(c.a.body)];
      Matrix3<double> axes = body * c.a.placement.rotation;
      if (c.kind == Kind::contact) axes = (Matrix3<double>() << axes.col(2), axes.col(0), axes.col(1)).finished();
      axes_.push_back((c.a.body == ground ? -1. : 1.) * axes);
    }
  }

  std::vector<Matrix3<double>> axes_;  ///< theirs = that times ours, by constraint
  bool odd_ = false;
};

/// Products by M⁻¹, solves by Newton.
class Newton : public Mujoco {
 public:
  Newton(const Scene& scene, const Damping<double>& damping, const Vector& x) : Mujoco(scene, damping, x, mjSOL_NEWTON), force_(m_->nv), motion_(m_->nv) {}
  void take(Step step) override {
    switch (step) {
      case Step::kinematics: kinematics(); break;
      case Step::first_product: set_damping(R_inverse_), factor(); [[fallthrough]];
      case Step::product: product(); break;
      case Step::new_damping: set_damping(next_damping()), solve(); break;
      case Step::first_solve: set_damping(R_inverse_), factor(); [[fallthrough]];
      case Step::solve: solve(); break;
    }
  }

 private:
  void product() {
    mj_mulJacTVec(m_, d_, force_.data(), x_.data());
    mj_solveM(m_, d_, motion_.data(), force_.data(), 1);
    mj_mulJacVec(m_, d_, y_.data(), motion_.data());
    y_ += R_inverse_.cwiseProduct(x_);
  }
  void solve() {
    std::copy_n(x_.data(), x_.size(), d_->efc_aref);
    std::fill_n(d_->qacc_smooth, m_->nv, 0.);
    std::fill_n(d_->qfrc_smooth, m_->nv, 0.);
    mj_fwdConstraint(m_, d_);
    std::copy_n(d_->efc_force, y_.size(), y_.data());
  }

  Vector force_, motion_;
};

/// Products by the matrix that its dual solvers take.
class Projected : public Mujoco {
 public:
  Projected(const Scene& scene, const Damping<double>& damping, const Vector& x) : Mujoco(scene, damping, x, mjSOL_PGS) {}
  void take(Step step) override {
    if (step == Step::kinematics) kinematics();
    if (step == Step::first_product) factor(), mj_projectConstraint(m_, d_);
    if (step == Step::first_product || step == Step::product) product();
  }

 private:
  void product() {
    const int rows = d_->nefc;
    if (!mj_isSparse(m_)) return mju_mulMatVec(y_.data(), d_->efc_AR, x_.data(), rows, rows);
    for (int r = 0; r < rows; ++r) {
      const int first = d_->efc_AR_rowadr[r];
      double sum = 0;
      for (int k = 0; k < d_->efc_AR_rownnz[r]; ++k) sum += d_->efc_AR[first + k] * x_[d_->efc_AR_colind[first + k]];
      y_[r] = sum;
    }
  }
};

template <class Way> std::unique_ptr<Peer> make(const Scene& scene, const Damping<double>& damping, const Vector& x) { return std::make_unique<Way>(scene, damping, x); }

}  // namespace

std::vector<PeerRow> mujoco_peers() {
  const std::string program = std::string("MuJoCo ") + mj_versionString();
  return {{"mujoco_newton", program, "products by its factor of M; solves by its Newton solver", "aba_sweep", "lcaba", false, make<Newton>},
          {"mujoco_projected", program, "mj_projectConstraint: the matrix of its dual solvers", "ltl_osim", "", false, make<Projected>}};
}

}  // namespace delassus::bench
