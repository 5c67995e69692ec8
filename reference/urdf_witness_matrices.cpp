// M, J and A0 of urdf_witness.h, in Quad.
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"
#include "reference/urdf_witness.h"
#include "reference/witness_matrices.h"

namespace delassus::reference {
namespace {

using Kind = UrdfWitness::Kind;
using namespace witness;

Transform placed(const UrdfWitness::Triple& xyz, const UrdfWitness::Triple& rpy) { return {of_rpy(rpy), wide(xyz)}; }
Transform placed(const Pose<double>& x) { return {x.rotation.cast<Quad>(), x.translation.cast<Quad>()}; }

/// The two directions in which a planar joint slides (model.h).
std::pair<Real3, Real3> in_plane(const UrdfWitness::Triple& axis, const Real3& unit) {
  Index k = 0;
  for (Index i = 1; i < 3; ++i)
    if (std::fabs(axis[static_cast<std::size_t>(i)]) < std::fabs(axis[static_cast<std::size_t>(k)])) k = i;
  Real3 first = Real3::Constant(Quad(0));
  first[k] = Quad(1);
  first -= unit[k] * unit;
  first /= length(first);
  return {first, unit.cross(first)};
}

/// What moves a link, and the entries of q and ν that belong to it.
struct Mover {
  Kind kind = Kind::fixed;
  Transform placement;             ///< before the motion
  UrdfWitness::Triple axis{1, 0, 0};
  double armature = 0;
  Index q = 0, dof = 0;
};

Index freedoms(Kind kind) {
  switch (kind) {
    case Kind::fixed: return 0;
    case Kind::planar: return 3;
    case Kind::floating: return 6;
    default: return 1;
  }
}

class Mechanism {
 public:
  explicit Mechanism(const UrdfWitness& witness) : w_(witness), movers_(witness.links.size()) {
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      if (w_.links[i].joint < 0) continue;
      const UrdfWitness::Joint& j = w_.joints[static_cast<std::size_t>(w_.links[i].joint)];
      movers_[i] = {j.kind, placed(j.xyz, j.rpy), j.axis, j.armature, 0, 0};
    }
  }

  /// Freedoms in the order of the file, the base first; all of q zero.
  void number_by_file(bool free_base) {
    if (free_base) mover(w_.root).kind = Kind::floating;
    for (const Index i : w_.order) {
      Mover& m = mover(i);
      m.q = q_size_, m.dof = dofs_;
      dofs_ += freedoms(m.kind);
      q_size_ += m.kind == Kind::floating ? 7 : freedoms(m.kind);
    }
  }

  /// Freedoms in the order of the model.
  void number_by_model(const Model& model, const std::string& robot);

  [[nodiscard]] Index dofs() const { return dofs_; }
  [[nodiscard]] Index q_size() const { return q_size_; }
  [[nodiscard]] Kind kind(Index link) const { return movers_[static_cast<std::size_t>(link)].kind; }
  [[nodiscard]] Index dof(Index link) const { return movers_[static_cast<std::size_t>(link)].dof; }
  void place(const VectorX<double>& q);
  void mass_matrix(MatrixX<Quad>& M, MatrixX<Quad>& bound) const;
  /// Six rows of link i from row r on.
  void weld(Index i, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound) const;
  /// The row ν_link − multiplier · ν_master.
  void mimic(Index link, Index master, double multiplier, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound) const;

 private:
  Mover& mover(Index link) { return movers_[static_cast<std::size_t>(link)]; }
  void move_base(Index link, const Body& body, Index q, Index dof);
  [[nodiscard]] Quad centre_of_root_body(Index link) const;
  void move(Index link, Placed& at, const VectorX<double>& q);

  const UrdfWitness& w_;
  std::vector<Mover> movers_;     ///< by link
  std::vector<Placed> at_;        ///< by link
  std::vector<Freedom> freedom_;
  Index dofs_ = 0, q_size_ = 0;
};

Kind kind_of(JointType type) {
  switch (type) {
    case JointType::revolute: return Kind::revolute;
    case JointType::prismatic: return Kind::prismatic;
    case JointType::planar: return Kind::planar;
    case JointType::floating: return Kind::floating;
    default: return Kind::fixed;
  }
}

/// The base moves `link`, which hangs on the root by fixed joints only: the root takes its place, backwards.
void Mechanism::move_base(Index link, const Body& body, Index q, Index dof) {
  for (Index i = link; w_.links[static_cast<std::size_t>(i)].joint >= 0;) {
    const UrdfWitness::Joint& j = w_.joints[static_cast<std::size_t>(w_.links[static_cast<std::size_t>(i)].joint)];
    if (j.kind != Kind::fixed || i != link) throw std::runtime_error("the model's base " + body.name + " is no root of the file");
    i = j.parent;
    if (w_.links[static_cast<std::size_t>(i)].mass != 0 || i != w_.root)
      throw std::runtime_error("the model's base " + body.name + " leaves out link " + w_.links[static_cast<std::size_t>(i)].name);
  }
  mover(link) = {kind_of(body.joint.type), placed(body.joint.placement), {body.joint.axis[0], body.joint.axis[1], body.joint.axis[2]}, 0, q, dof};
}

void Mechanism::number_by_model(const Model& model, const std::string& robot) {
  std::map<std::string, Index> link_of;   // by joint
  for (const UrdfWitness::Joint& j : w_.joints) link_of[robot + "/" + j.name] = j.child;
  std::map<std::string, Index> link;
  for (std::size_t i = 0; i < w_.links.size(); ++i) link[robot + "/" + w_.links[i].name] = static_cast<Index>(i);
  std::vector<char> seen(w_.links.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    const auto of_body = link.find(body.name);
    if (of_body == link.end()) throw std::runtime_error("the file has no link for the model's body " + body.name);
    const Index q = model.first_q[b], dof = model.first_dof[b], i = of_body->second;
    const auto it = link_of.find(body.joint.name);
    if (it == link_of.end() || (body.parent == ground && it->second != i)) move_base(i, body, q, dof);
    else {
      if (it->second != i || mover(i).kind != kind_of(body.joint.type) || mover(i).kind == Kind::fixed)
        throw std::runtime_error("joint " + body.joint.name + " of the model is not that of the file");
      mover(i).q = q, mover(i).dof = dof;
    }
    seen[static_cast<std::size_t>(i)] = 1;
  }
  for (std::size_t i = 0; i < movers_.size(); ++i)
    if (movers_[i].kind != Kind::fixed && !seen[i]) throw std::runtime_error("the model lacks the joint of link " + w_.links[i].name);
  dofs_ = model.dofs(), q_size_ = model.q_size();
}

/// How far the centre of mass of all that is fixed to `link` may be from its origin.
Quad Mechanism::centre_of_root_body(Index link) const {
  std::map<Index, Quad> reach{{link, Quad(0)}};
  Quad sum(0), mass(0);
  for (const Index i : w_.order) {
    const UrdfWitness::Link& l = w_.links[static_cast<std::size_t>(i)];
    if (i != link && l.joint >= 0 && kind(i) == Kind::fixed) {
      const UrdfWitness::Joint& j = w_.joints[static_cast<std::size_t>(l.joint)];
      if (const auto parent = reach.find(j.parent); parent != reach.end()) reach[i] = parent->second + length(wide(j.xyz));
    }
    const auto it = reach.find(i);
    if (it == reach.end()) continue;
    mass += Quad(std::fabs(l.mass));
    sum += Quad(std::fabs(l.mass)) * (it->second + length(wide(l.com)));
  }
  return mass > Quad(0) ? sum / mass : Quad(0);
}

void Mechanism::move(Index link, Placed& at, const VectorX<double>& q) {
  const Mover& m = mover(link);
  const Index n = freedoms(m.kind);
  const auto qk = [&](Index k) { return Quad(q[m.q + k]); };
  const Real3 axis = wide(m.axis) / length(wide(m.axis));
  Real3 travel = Real3::Constant(Quad(0)), t1 = travel, t2 = travel;
  Transform motion;
  if (m.kind == Kind::revolute || m.kind == Kind::planar) motion.R = turned(axis, qk(0));
  if (m.kind == Kind::prismatic) travel = qk(0) * axis;
  if (m.kind == Kind::planar) {
    std::tie(t1, t2) = in_plane(m.axis, axis);
    travel = qk(1) * t1 + qk(2) * t2;
  }
  if (m.kind == Kind::floating) {
    travel = Real3(qk(0), qk(1), qk(2));
    motion.R = of_quaternion(qk(3), Real3(qk(4), qk(5), qk(6)));
  }
  motion.p = travel;
  const Real33 before = at.X.R;
  const bool root_body = at.freedoms.empty();
  at.X = at.X * motion;
  at.reach = root_body ? centre_of_root_body(link) : at.reach + length(travel);
  if (root_body) at.steps = Quad(1);
  for (Index k = 0; k < n; ++k) {
    Freedom& f = freedom_[static_cast<std::size_t>(m.dof + k)];
    f.o = at.X.p, f.reach = at.reach;
    f.turns = m.kind == Kind::floating ? k < 3 : k == 0 && m.kind != Kind::prismatic;
    const Real3 direction = m.kind == Kind::floating ? Real3(at.X.R.col(k % 3)) : Real3(before * (k == 0 ? axis : k == 1 ? t1 : t2));
    (f.turns ? f.w : f.v) = direction;
    at.freedoms.push_back(m.dof + k);
  }
}

void Mechanism::place(const VectorX<double>& q) {
  at_.assign(w_.links.size(), {});
  freedom_.assign(static_cast<std::size_t>(dofs_), {});
  for (const Index i : w_.order) {
    const Index joint = w_.links[static_cast<std::size_t>(i)].joint;
    Placed& at = at_[static_cast<std::size_t>(i)];
    const bool base = joint < 0 || (w_.joints[static_cast<std::size_t>(joint)].kind == Kind::fixed && kind(i) != Kind::fixed);
    if (base) at.X = mover(i).placement;
    else {
      at = at_[static_cast<std::size_t>(w_.joints[static_cast<std::size_t>(joint)].parent)];
      at.X = at.X * mover(i).placement;
      at.reach += length(mover(i).placement.p);
      at.steps += Quad(1);
    }
    if (kind(i) != Kind::fixed) move(i, at, q);
  }
}

void Mechanism::mass_matrix(MatrixX<Quad>& M, MatrixX<Quad>& bound) const {
  M = bound = MatrixX<Quad>::Constant(dofs_, dofs_, Quad(0));
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const UrdfWitness::Link& l = w_.links[i];
    add_link({l.mass, placed(l.com, l.rpy), l.inertia}, at_[i], freedom_, M, bound);
  }
  for (const Mover& m : movers_)
    for (Index k = 0; k < freedoms(m.kind); ++k) M(m.dof + k, m.dof + k) += Quad(m.armature), bound(m.dof + k, m.dof + k) += Quad(m.armature);
}

void Mechanism::weld(Index i, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound) const { add_weld(at_[static_cast<std::size_t>(i)], freedom_, r, J, bound); }

void Mechanism::mimic(Index link, Index master, double multiplier, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound) const {
  for (const auto& [i, coefficient] : {std::pair<Index, double>{link, 1}, {master, -multiplier}}) {
    const Placed& at = at_[static_cast<std::size_t>(i)];
    for (const Index a : at.freedoms)
      bound(r, a) += at.steps * Quad(std::fabs(coefficient)) * (Quad(1) + at.reach + freedom_[static_cast<std::size_t>(a)].reach);
    J(r, dof(i)) += Quad(coefficient);
  }
}

struct MimicRow {
  Index link, master;
  double multiplier;
};

std::vector<MimicRow> mimics_of(const UrdfWitness& w, const Mechanism& mechanism) {
  std::map<std::string, Index> child;
  for (const UrdfWitness::Joint& j : w.joints) child[j.name] = j.child;
  std::vector<MimicRow> out;
  for (const UrdfWitness::Joint& j : w.joints) {
    const auto master = child.find(j.master);
    if (j.master.empty() || master == child.end()) continue;
    if (freedoms(mechanism.kind(j.child)) == 1 && freedoms(mechanism.kind(master->second)) == 1) out.push_back({j.child, master->second, j.multiplier});
  }
  return out;
}

}  // namespace

UrdfMatrices urdf_matrices(const UrdfWitness& witness, const Model& model, const std::string& robot, const VectorX<double>& q,
                           const std::vector<Index>& welded) {
  Mechanism mechanism(witness);
  mechanism.number_by_model(model, robot);
  mechanism.place(q);
  UrdfMatrices out;
  mechanism.mass_matrix(out.M, out.M_bound);
  const std::vector<MimicRow> mimics = mimics_of(witness, mechanism);
  const Index rows = static_cast<Index>(mimics.size() + 6 * welded.size());
  out.J = out.J_bound = MatrixX<Quad>::Constant(rows, mechanism.dofs(), Quad(0));
  Index r = 0;
  for (const MimicRow& m : mimics) mechanism.mimic(m.link, m.master, m.multiplier, r++, out.J, out.J_bound);
  for (const Index i : welded) mechanism.weld(i, r, out.J, out.J_bound), r += 6;
  couple(out);
  return out;
}

bool urdf_regular(const UrdfWitness& witness, bool free_base) {
  Mechanism mechanism(witness);
  mechanism.number_by_file(free_base);
  VectorX<double> q = VectorX<double>::Zero(mechanism.q_size());
  if (free_base) q[3] = 1;
  for (const bool moved : {false, true}) {
    if (moved)
      for (Index k = free_base ? 7 : 0; k < q.size(); ++k) q[k] = 0.3 + 0.7 * static_cast<double>(k % 5) / 4;
    mechanism.place(q);
    MatrixX<Quad> M, bound;
    mechanism.mass_matrix(M, bound);
    if (!PivotedLdlt<Quad>(M).regular()) return false;
  }
  return true;
}

}  // namespace delassus::reference
