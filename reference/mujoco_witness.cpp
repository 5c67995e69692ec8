#include "reference/mujoco_witness.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace delassus::reference {
namespace {

static_assert(std::is_same_v<mjtNum, double>);

using Kind = Constraint::Kind;
using Matrix = MatrixX<double>;
using Matrix3X = Eigen::Matrix<double, 3, Eigen::Dynamic>;
template <int R> using RowMajor = Eigen::Matrix<double, R, R == 3 ? 3 : Eigen::Dynamic, Eigen::RowMajor>;

struct DeleteModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct DeleteData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, DeleteModel>;
using DataPtr = std::unique_ptr<mjData, DeleteData>;

/// The text compiled, from a file in memory.
ModelPtr compile(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* name = "model.xml";
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size())) != 0)
    throw std::runtime_error("MuJoCo cannot hold a model of " + std::to_string(text.size()) + " bytes");
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], text.data(), text.size());
  std::array<char, 1000> error{};
  ModelPtr model(mj_loadXML(name, files.get(), error.data(), static_cast<int>(error.size())));
  mj_deleteVFS(files.get());
  if (!model) throw ModelError("", "MuJoCo", error.data(), "a model that MuJoCo compiles");
  return model;
}

/// A constraint frame in the world.
struct WorldFrame {
  int body;
  Matrix3<double> rotation;
  Vector3<double> origin;
};

/// A row of a pair constraint: the rate of turning about, or of moving along, `u`.
struct PairRow {
  bool angular;
  Vector3<double> u;
};

bool between_frames(Kind kind) {
  return kind != Kind::coupling && kind != Kind::general && kind != Kind::joint_friction && kind != Kind::joint_lock && kind != Kind::joint_limit;
}

/// Rows in the order of model.h.
std::vector<PairRow> pair_rows(Kind kind, const WorldFrame& a, const WorldFrame& b) {
  const auto turn = [&](Index k) { return PairRow{true, a.rotation.col(k)}; };
  const auto move = [&](Index k) { return PairRow{false, a.rotation.col(k)}; };
  switch (kind) {
    case Kind::weld: return {turn(0), turn(1), turn(2), move(0), move(1), move(2)};
    case Kind::hinge: return {turn(0), turn(1), move(0), move(1), move(2)};
    case Kind::universal:
      return {{true, a.rotation.col(2).cross(b.rotation.col(0))}, move(0), move(1), move(2)};
    case Kind::cylindrical: return {turn(0), turn(1), move(0), move(1)};
    case Kind::prismatic: return {turn(0), turn(1), turn(2), move(0), move(1)};
    case Kind::planar: return {turn(0), turn(1), move(2)};
    case Kind::distance: return {{false, (a.origin - b.origin).normalized()}};
    case Kind::contact: return {move(2), move(0), move(1)};
    default: throw std::logic_error("pair_rows: not a constraint between two frames");
  }
}

}  // namespace

struct MujocoWitness::State {
  Model model;
  ModelPtr compiled;
  DataPtr data;
  std::vector<int> body;  ///< MuJoCo's number of each body
  Matrix T;               ///< qvel = T ν
  Matrix J;               ///< m × nv, in qvel

  State(const Model& described, const MujocoMore& more);
  void set_armature(Index i);
  void set_anchors();
  void set_joint(Index i, const double* q);
  void read_joint(Index i, double* q) const;
  void rates(Index i, const double* q, Matrix& out) const;
  void set_rows();

  int joint(Index i, std::size_t k) const { return compiled->body_jntadr[body[i]] + static_cast<int>(k); }
  Index nv() const { return compiled->nv; }
  WorldFrame world(const Frame& frame) const;
  /// Jacobians of the velocity of the point of `b` now at `point`, and of its angular velocity.
  std::pair<Matrix3X, Matrix3X> jacobians(int b, const Vector3<double>& point) const;
  Matrix connect_rows(const Constraint& c, int first) const;
  Matrix frame_rows(const Constraint& c) const;
  Matrix term_rows(const Constraint& c) const;
};

MujocoWitness::State::State(const Model& described, const MujocoMore& more) : model(described) {
  mju_user_warning = [](const char*) {};  // otherwise MuJoCo writes a log file; `set` looks at the counts
  compiled = compile(mujoco_xml(model, more));
  for (Index i = 0; i < static_cast<Index>(model.bodies.size()); ++i) {
    body.push_back(mj_name2id(compiled.get(), mjOBJ_BODY, mujoco_name(i).c_str()));
    set_armature(i);
  }
  set_anchors();
  data.reset(mj_makeData(compiled.get()));
  if (!data || nv() != model.dofs()) throw std::runtime_error("MuJoCo's model has not the degrees of freedom of ours");
}

void MujocoWitness::State::set_armature(Index i) {
  const auto& armature = model.bodies[i].joint.armature;
  if (armature.empty()) return;
  const std::vector<MujocoJoint> joints = mujoco_joints(model.bodies[i]);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    double* to = compiled->dof_armature + compiled->jnt_dofadr[joint(i, k)];
    if (joints[k].kind == MujocoJoint::Kind::free)
      for (Index r = 0; r < 6; ++r) to[r] = armature[(r + 3) % 6];
    if (joints[k].kind == MujocoJoint::Kind::ball)
      for (Index r = 0; r < 3; ++r) to[r] = armature[r];
  }
}

void MujocoWitness::State::set_anchors() {
  double* to = compiled->eq_data;
  for (const Constraint& c : model.constraints) {
    if (c.kind != Kind::point) continue;
    const bool turned = c.a.body == ground;
    const Vector3<double>& first = (turned ? c.b : c.a).placement.translation;
    const Vector3<double>& second = (turned ? c.a : c.b).placement.translation;
    for (Index k = 0; k < 3; ++k) to[k] = first[k], to[3 + k] = second[k];
    to += mjNEQDATA;
  }
}

void MujocoWitness::State::set_joint(Index i, const double* q) {
  const std::vector<MujocoJoint> joints = mujoco_joints(model.bodies[i]);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    double* to = data->qpos + compiled->jnt_qposadr[joint(i, k)];
    const double* from = q + joints[k].q;
    switch (joints[k].kind) {
      case MujocoJoint::Kind::hinge:
      case MujocoJoint::Kind::slide: to[0] = from[0]; break;
      case MujocoJoint::Kind::ball: std::copy(from, from + 4, to); break;
      case MujocoJoint::Kind::free: {  // a free joint is placed in the world
        const double* at = compiled->body_pos + 3 * body[i];
        const double* turned = compiled->body_quat + 4 * body[i];
        mju_rotVecQuat(to, from, turned);
        mju_addTo3(to, at);
        mju_mulQuat(to + 3, turned, from + 3);
      }
    }
  }
}

/// set_joint, the other way.
void MujocoWitness::State::read_joint(Index i, double* q) const {
  const std::vector<MujocoJoint> joints = mujoco_joints(model.bodies[i]);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const double* from = data->qpos + compiled->jnt_qposadr[joint(i, k)];
    double* to = q + joints[k].q;
    if (joints[k].kind == MujocoJoint::Kind::ball) std::copy(from, from + 4, to);
    else if (joints[k].kind != MujocoJoint::Kind::free) to[0] = from[0];
    else {
      double back[4], away[3];
      mju_negQuat(back, compiled->body_quat + 4 * body[i]);
      mju_sub3(away, from, compiled->body_pos + 3 * body[i]);
      mju_rotVecQuat(to, away, back);
      mju_mulQuat(to + 3, back, from + 3);
    }
  }
}

/// The columns of T of one joint; after the poses are known.
void MujocoWitness::State::rates(Index i, const double* q, Matrix& out) const {
  const Body& b = model.bodies[i];
  const std::vector<MujocoJoint> joints = mujoco_joints(b);
  const Index first = model.first_dof[i];
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Index row = compiled->jnt_dofadr[joint(i, k)];
    const MujocoJoint& j = joints[k];
    RowMajor<3> R;
    if (j.kind == MujocoJoint::Kind::free) {
      std::copy_n(data->xmat + 9 * body[i], 9, R.data());
      out.block<3, 3>(row, first + 3) = R;
      out.block<3, 3>(row + 3, first).setIdentity();
    } else if (j.kind == MujocoJoint::Kind::ball) {
      out.block<3, 3>(row, first + j.dof).setIdentity();
    } else if (b.joint.type == JointType::floating) {  // a slide along axis j.dof − 3 of the joint frame
      double turn[4] = {q[3], q[4], q[5], q[6]};
      mju_normalize4(turn);
      mju_quat2Mat(R.data(), turn);
      out.block<1, 3>(row, first + 3) = R.row(j.dof - 3);
    } else {
      out(row, first + j.dof) = 1;
    }
  }
}

WorldFrame MujocoWitness::State::world(const Frame& frame) const {
  if (frame.body == ground) return {0, frame.placement.rotation, frame.placement.translation};
  const int b = body[frame.body];
  const Eigen::Map<const RowMajor<3>> R(data->xmat + 9 * b);
  const Eigen::Map<const Vector3<double>> p(data->xpos + 3 * b);
  return {b, R * frame.placement.rotation, p + R * frame.placement.translation};
}

std::pair<Matrix3X, Matrix3X> MujocoWitness::State::jacobians(int b, const Vector3<double>& point) const {
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor> moving(3, nv()), turning(3, nv());
  mj_jac(compiled.get(), data.get(), moving.data(), turning.data(), point.data(), b);
  return {moving, turning};
}

/// The rows of the `connect` equality that starts at row `first` of efc_J: body 1 less body 2, world axes.
Matrix MujocoWitness::State::connect_rows(const Constraint& c, int first) const {
  const Eigen::Map<const RowMajor<Eigen::Dynamic>> rows(data->efc_J + first * nv(), 3, nv());
  const double sign = c.a.body == ground ? -1 : 1;
  return sign * (world(c.a).rotation.transpose() * rows);
}

Matrix MujocoWitness::State::frame_rows(const Constraint& c) const {
  const WorldFrame a = world(c.a), b = world(c.b);
  const bool slides = c.kind == Kind::cylindrical || c.kind == Kind::prismatic || c.kind == Kind::planar;
  const auto [moving_a, turning_a] = jacobians(a.body, slides ? b.origin : a.origin);
  const auto [moving_b, turning_b] = jacobians(b.body, b.origin);
  const std::vector<PairRow> rows = pair_rows(c.kind, a, b);
  Matrix out(static_cast<Index>(rows.size()), nv());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Matrix3X rate = rows[k].angular ? turning_a - turning_b : moving_a - moving_b;
    out.row(static_cast<Index>(k)) = rows[k].u.transpose() * rate;
  }
  return out;
}

/// Kinds without two frames: coupling and joint rows pick entries of ν; general blocks act on body axes.
Matrix MujocoWitness::State::term_rows(const Constraint& c) const {
  Matrix out = Matrix::Zero(row_count(model, c), nv());
  if (c.kind == Kind::joint_friction || c.kind == Kind::joint_lock)
    return T.middleCols(model.first_dof[c.a.body], out.rows()).transpose();  // T⁻¹ = Tᵀ
  if (c.kind == Kind::joint_limit) return c.side * T.col(model.first_dof[c.a.body] + c.dof).transpose();
  for (const Constraint::Term& t : c.terms) {
    if (c.kind == Kind::coupling) out += t.coefficient * T.col(model.first_dof[t.body] + t.dof).transpose();
    if (c.kind == Kind::coupling || t.body == ground) continue;
    const WorldFrame at = world({t.body, {}});
    const auto [moving, turning] = jacobians(at.body, at.origin);
    out += t.K.leftCols(3) * at.rotation.transpose() * turning + t.K.rightCols(3) * at.rotation.transpose() * moving;
  }
  return out;
}

void MujocoWitness::State::set_rows() {
  Index rows = 0;
  int connected = 0;
  for (const Constraint& c : model.constraints) rows += row_count(model, c), connected += c.kind == Kind::point ? 3 : 0;
  if (data->ne < connected) throw std::runtime_error("MuJoCo left out rows of a connect constraint");
  J.resize(rows, nv());
  rows = connected = 0;
  for (const Constraint& c : model.constraints) {
    const Matrix block = c.kind == Kind::point       ? connect_rows(c, connected)
                         : between_frames(c.kind) ? frame_rows(c)
                                                  : term_rows(c);
    J.middleRows(rows, block.rows()) = block;
    rows += block.rows();
    connected += c.kind == Kind::point ? 3 : 0;
  }
}

MujocoWitness::MujocoWitness(const Model& model, const MujocoMore& more) : state_(std::make_unique<State>(model, more)) {}
MujocoWitness::~MujocoWitness() = default;

void MujocoWitness::set(const VectorX<double>& q) {
  State& s = *state_;
  require(q.size() == s.model.q_size(), "q does not have Model::q_size() entries");
  const Index bodies = static_cast<Index>(s.model.bodies.size());
  mj_resetData(s.compiled.get(), s.data.get());
  for (Index i = 0; i < bodies; ++i) s.set_joint(i, q.data() + s.model.first_q[i]);
  mj_fwdPosition(s.compiled.get(), s.data.get());
  for (int k = 0; k < mjNWARNING; ++k)
    if (s.data->warning[k].number != 0)
      throw std::runtime_error(std::string("MuJoCo: ") + mju_warningText(k, s.data->warning[k].lastinfo));
  s.T = T(q);
  s.set_rows();
}

VectorX<double> MujocoWitness::q() const {
  VectorX<double> out(state_->model.q_size());
  for (Index i = 0; i < static_cast<Index>(state_->model.bodies.size()); ++i) state_->read_joint(i, out.data() + state_->model.first_q[i]);
  return out;
}

MatrixX<double> MujocoWitness::T(const VectorX<double>& q) const {
  Matrix out = Matrix::Zero(state_->nv(), state_->nv());
  for (Index i = 0; i < static_cast<Index>(state_->model.bodies.size()); ++i) state_->rates(i, q.data() + state_->model.first_q[i], out);
  return out;
}

MatrixX<double> MujocoWitness::M() const {
  const State& s = *state_;
  RowMajor<Eigen::Dynamic> full(s.nv(), s.nv());
  mj_fullM(s.compiled.get(), full.data(), s.data->qM);
  return s.T.transpose() * full * s.T;
}

mjModel_& MujocoWitness::compiled() { return *state_->compiled; }
mjData_& MujocoWitness::data() { return *state_->data; }

MatrixX<double> MujocoWitness::J() const { return state_->J * state_->T; }

MatrixX<double> MujocoWitness::A0() const {
  const State& s = *state_;
  const RowMajor<Eigen::Dynamic> forces = s.J;
  RowMajor<Eigen::Dynamic> rates(forces.rows(), forces.cols());
  mj_solveM(s.compiled.get(), s.data.get(), rates.data(), forces.data(), static_cast<int>(forces.rows()));
  return s.J * rates.transpose();
}

}  // namespace delassus::reference
