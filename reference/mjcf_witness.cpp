#include "reference/mjcf_witness.h"

#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <stdexcept>

namespace delassus::reference {
namespace {

using Matrix = MatrixX<double>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct DeleteModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct DeleteData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, DeleteModel>;

ModelPtr compile(const std::string& file, const std::string& text) {
  std::array<char, 1000> error{};
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  if (!text.empty()) {
    if (mj_makeEmptyFileVFS(files.get(), file.c_str(), static_cast<int>(text.size())) != 0) throw std::runtime_error("MuJoCo cannot hold the text");
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), file.c_str())], text.data(), text.size());
  }
  ModelPtr model(mj_loadXML(file.c_str(), text.empty() ? nullptr : files.get(), error.data(), static_cast<int>(error.size())));
  mj_deleteVFS(files.get());
  if (!model) throw ModelError(file, "MuJoCo", error.data(), "a file that MuJoCo compiles");
  return model;
}

Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> matrix(const double* x) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x);
}

}  // namespace

struct MjcfWitness::State {
  ModelPtr m;
  std::unique_ptr<mjData, DeleteData> d;
  Pose<double> pose;
  Matrix T;  ///< qvel = T ν

  void put_in(const std::map<std::string, Matrix3<double>>& full_inertia);
  void set_joint(int j, const double* q, Index first_dof);
};

/// Principal axes anew, by Eigen; what the compiler was told to change stays.
void MjcfWitness::State::put_in(const std::map<std::string, Matrix3<double>>& full_inertia) {
  for (const auto& [name, exact] : full_inertia) {
    const int b = mj_name2id(m.get(), mjOBJ_BODY, name.c_str());
    if (b < 0) continue;
    double* moments = m->body_inertia + 3 * b;
    double* turn = m->body_iquat + 4 * b;
    const Matrix3<double> R = Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix();
    const Matrix3<double> compiled = R * Eigen::Map<const Vector3<double>>(moments).asDiagonal() * R.transpose();
    if ((compiled - exact).norm() > 1e-4 * exact.norm()) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix3<double>> principal(exact);
    Matrix3<double> axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) *= -1;
    const Eigen::Quaterniond q(axes);
    for (int k = 0; k < 3; ++k) moments[k] = principal.eigenvalues()[k];
    turn[0] = q.w(), turn[1] = q.x(), turn[2] = q.y(), turn[3] = q.z();
    m->body_sameframe[b] = 0;
    m->body_simple[b] = 0;
    for (int k = 0; k < m->nv; ++k) m->dof_simplenum[k] = 0;
  }
}

void MjcfWitness::State::set_joint(int j, const double* q, Index first) {
  double* at = d->qpos + m->jnt_qposadr[j];
  const int dof = m->jnt_dofadr[j];
  switch (m->jnt_type[j]) {
    case mjJNT_FREE: {
      const Eigen::Quaterniond turn(q[3], q[4], q[5], q[6]);
      const Matrix3<double> R = pose.rotation.transpose() * turn.normalized().toRotationMatrix();
      const Vector3<double> p = pose.rotation.transpose() * (Vector3<double>(q[0], q[1], q[2]) - pose.translation);
      const Eigen::Quaterniond r = Eigen::Quaterniond(pose.rotation.transpose()) * turn.normalized();
      at[0] = p[0], at[1] = p[1], at[2] = p[2], at[3] = r.w(), at[4] = r.x(), at[5] = r.y(), at[6] = r.z();
      T.block<3, 3>(dof, first + 3) = R;
      T.block<3, 3>(dof + 3, first).setIdentity();
      return;
    }
    case mjJNT_BALL:
      for (int k = 0; k < 4; ++k) at[k] = q[k];
      T.block<3, 3>(dof, first).setIdentity();
      return;
    default:
      at[0] = q[0];
      T(dof, first) = 1;
  }
}

MjcfWitness::MjcfWitness(const std::string& file, const std::string& text, const Pose<double>& pose,
                         const std::map<std::string, Matrix3<double>>& full_inertia)
    : state_(std::make_unique<State>()) {
  mju_user_warning = [](const char*) {};  // otherwise MuJoCo writes a log file; `set` looks at the counts
  State& s = *state_;
  s.m = compile(file, text);
  s.pose = pose;
  s.m->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS;
  s.m->opt.disableflags &= ~mjDSBL_EQUALITY;
  s.m->opt.jacobian = mjJAC_DENSE;
  s.put_in(full_inertia);
  s.d.reset(mj_makeData(s.m.get()));
}
MjcfWitness::~MjcfWitness() = default;

Index MjcfWitness::joints() const { return state_->m->njnt; }
Index MjcfWitness::equalities() const { return state_->m->neq; }
double MjcfWitness::ref(Index joint) const { return state_->m->qpos0[state_->m->jnt_qposadr[joint]]; }

std::string MjcfWitness::name(Index equality) const {
  const char* text = mj_id2name(state_->m.get(), mjOBJ_EQUALITY, static_cast<int>(equality));
  return text == nullptr ? "" : text;
}

void MjcfWitness::set(const Model& model, const std::vector<Index>& bodies, const VectorX<double>& q) {
  State& s = *state_;
  require(static_cast<int>(bodies.size()) == s.m->njnt, "one body per joint");
  mj_resetData(s.m.get(), s.d.get());
  s.T = Matrix::Zero(s.m->nv, model.dofs());
  for (std::size_t j = 0; j < bodies.size(); ++j)
    s.set_joint(static_cast<int>(j), q.data() + model.first_q[static_cast<std::size_t>(bodies[j])], model.first_dof[static_cast<std::size_t>(bodies[j])]);
  mj_fwdPosition(s.m.get(), s.d.get());
  for (int k = 0; k < mjNWARNING; ++k)
    if (s.d->warning[k].number != 0) throw std::runtime_error(std::string("MuJoCo: ") + mju_warningText(k, s.d->warning[k].lastinfo));
}

double MjcfWitness::about(Index joint) const {
  const State& s = *state_;
  return Eigen::Map<const Vector3<double>>(s.d->subtree_com + 3 * s.m->body_rootid[s.m->jnt_bodyid[joint]]).stableNorm();
}

MatrixX<double> MjcfWitness::M() const {
  const State& s = *state_;
  RowMajor full(s.m->nv, s.m->nv);
  mj_fullM(s.m.get(), full.data(), s.d->qM);
  return s.T.transpose() * full * s.T;
}

MatrixX<double> MjcfWitness::rows(Index equality) const {
  const State& s = *state_;
  const int e = static_cast<int>(equality), type = s.m->eq_type[e];
  std::vector<int> mine;
  for (int r = 0; r < s.d->nefc; ++r)
    if (s.d->efc_type[r] == mjCNSTR_EQUALITY && s.d->efc_id[r] == e) mine.push_back(r);
  if (mine.empty()) return {};
  const Eigen::Map<const RowMajor> all(s.d->efc_J, s.d->nefc, s.m->nv);
  Matrix out = all.middleRows(mine.front(), static_cast<Index>(mine.size())) * s.T;
  if (type != mjEQ_CONNECT && type != mjEQ_WELD) return out;
  const int a = s.m->eq_obj1id[e], b = s.m->eq_obj2id[e];
  Matrix3<double> R = matrix(s.d->xmat + 9 * a);
  if (type == mjEQ_CONNECT) return R.transpose() * out;
  const double* turn = s.m->eq_data + e * mjNEQDATA + 6;
  R *= Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).normalized().toRotationMatrix();
  RowMajor of_a(3, s.m->nv), of_b(3, s.m->nv);
  mj_jacBody(s.m.get(), s.d.get(), nullptr, of_a.data(), a);
  mj_jacBody(s.m.get(), s.d.get(), nullptr, of_b.data(), b);
  Matrix weld(6, out.cols());
  weld << R.transpose() * (of_a - of_b) * s.T, R.transpose() * out.topRows(3);
  return weld;
}

MatrixX<double> MjcfWitness::site_rows(const std::string& a, const std::string& b, bool weld) const {
  const State& s = *state_;
  RowMajor moving[2], turning[2];
  int ids[2] = {mj_name2id(s.m.get(), mjOBJ_SITE, a.c_str()), mj_name2id(s.m.get(), mjOBJ_SITE, b.c_str())};
  for (int k = 0; k < 2; ++k) {
    if (ids[k] < 0) return {};
    moving[k].resize(3, s.m->nv), turning[k].resize(3, s.m->nv);
    mj_jacSite(s.m.get(), s.d.get(), moving[k].data(), turning[k].data(), ids[k]);
  }
  const Matrix3<double> R = matrix(s.d->site_xmat + 9 * ids[0]).transpose();
  Matrix out(6, s.T.cols());
  out << R * (turning[0] - turning[1]) * s.T, R * (moving[0] - moving[1]) * s.T;
  return weld ? out : Matrix(out.bottomRows(3));
}

std::vector<Index> MjcfWitness::curved() const {
  const mjModel& m = *state_->m;
  std::vector<Index> out;
  for (int e = 0; e < m.neq; ++e) {
    const double* c = m.eq_data + e * mjNEQDATA;
    const int second = m.eq_obj2id[e];
    if ((m.eq_type[e] != mjEQ_JOINT && m.eq_type[e] != mjEQ_TENDON) || second < 0 || (c[2] == 0 && c[3] == 0 && c[4] == 0)) continue;
    if (m.eq_type[e] == mjEQ_JOINT) out.push_back(second);
    else
      for (int k = m.tendon_adr[second]; k < m.tendon_adr[second] + m.tendon_num[second]; ++k)
        if (m.wrap_type[k] == mjWRAP_JOINT) out.push_back(m.wrap_objid[k]);
  }
  return out;
}

}  // namespace delassus::reference
