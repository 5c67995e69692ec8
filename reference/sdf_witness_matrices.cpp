// M, J and A0 of sdf_witness.h, in Quad.
#include <algorithm>
#include <map>
#include <stdexcept>

#include "algorithms/kit/test_scalars.h"
#include "reference/sdf_witness.h"

namespace delassus::reference {
namespace {

using Kind = SdfWitness::Kind;
using Posed = SdfWitness::Posed;
using namespace witness;

std::size_t z(Index i) { return static_cast<std::size_t>(i); }
Index freedoms_of(Kind kind) { return kind == Kind::fixed ? 0 : kind == Kind::ball ? 3 : kind == Kind::universal || kind == Kind::screw ? 2 : 1; }

/// A turn about a line through a point of the world.
Transform about(const Real3& point, const Real33& R) { return {R, Real3(point - R * point)}; }

class Mechanism {
 public:
  Mechanism(const SdfWitness& w, const Model& model, const std::string& robot, bool base_given) : w_(w), model_(model), robot_(robot) { number(base_given); }

  void place(const VectorX<double>& q);
  void mass_matrix(double armature, MatrixX<Quad>& M, MatrixX<Quad>& bound) const;
  void weld(Index link, Index r, WitnessMatrices& out) const { add_weld(at_[z(link)], freedom_, r, out.J, out.J_bound); }
  void constraint(const Constraint& c, Index r, WitnessMatrices& out) const;
  void check_loops(std::size_t own) const;

 private:
  struct Mover {
    Index q = -1, dof = -1;
    bool floats = false;
  };
  [[nodiscard]] const SdfWitness::Joint* joint_of(Index link) const {
    const Index j = w_.links[z(link)].joint;
    return j < 0 ? nullptr : &w_.joints[z(j)];
  }
  void number(bool base_given);
  void move(Index link, const SdfWitness::Joint& j, const VectorX<double>& q);
  void move_base(Index link, const VectorX<double>& q);
  [[nodiscard]] Freedom& freedom(Index k) { return freedom_[z(k)]; }
  [[nodiscard]] Quad centre_of(Index link) const;
  [[nodiscard]] Index carrier(Index link) const;
  /// Frame of a joint on one of its links (−1: the world).
  [[nodiscard]] Placed frame(const SdfWitness::Joint& j, Index link) const;
  void loop(const SdfWitness::Joint& j, const Constraint& c, Index r, WitnessMatrices& out) const;
  void angle(Index link, const Real3& axis, double coefficient, Index r, WitnessMatrices& out) const;
  [[nodiscard]] Real3 gear_axis(const Real3& own, Index link, Index reference) const;
  void gearbox(const SdfWitness::Joint& j, Index r, WitnessMatrices& out) const;
  void screw(const SdfWitness::Joint& j, Index r, WitnessMatrices& out) const;

  const SdfWitness& w_;
  const Model& model_;
  const std::string& robot_;
  std::vector<Mover> movers_;       ///< by link
  std::vector<Transform> moved_;    ///< D, by link
  std::vector<Quad> within_;        ///< ℓ of the link's origin in its body, by link
  std::vector<Placed> at_;          ///< by link
  std::vector<Freedom> freedom_;
};

bool agrees(Kind kind, JointType type) {
  switch (type) {
    case JointType::revolute: return kind == Kind::revolute;
    case JointType::prismatic: return kind == Kind::prismatic;
    case JointType::spherical: return kind == Kind::ball;
    case JointType::universal: return kind == Kind::universal;
    case JointType::cylindrical: return kind == Kind::screw;
    default: return false;
  }
}

/// Freedoms in the order of the model, roots as the file has them.
void Mechanism::number(bool base_given) {
  movers_.assign(w_.links.size(), {});
  std::map<std::string, Index> link;
  for (std::size_t i = 0; i < w_.links.size(); ++i) link[robot_ + "/" + w_.links[i].name] = static_cast<Index>(i);
  for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
    const Body& body = model_.bodies[b];
    const auto it = link.find(body.name);
    if (it == link.end()) throw std::runtime_error("the file has no link for the model's body " + body.name);
    const SdfWitness::Joint* j = joint_of(it->second);
    Mover& m = movers_[z(it->second)];
    m = {model_.first_q[b], model_.first_dof[b], false};
    if (body.joint.type == JointType::floating && body.parent == ground) m.floats = true;
    else if (j == nullptr || !agrees(j->kind, body.joint.type) || body.joint.name != robot_ + "/" + j->name)
      throw std::runtime_error("joint " + body.joint.name + " of the model is not that of the file");
  }
  bool first = base_given;
  for (std::size_t i = 0; i < w_.links.size(); ++i) {
    const SdfWitness::Joint* j = joint_of(static_cast<Index>(i));
    const bool stands = w_.root_stands(static_cast<Index>(i)), root = j == nullptr || stands;
    if (!root && movers_[i].q < 0 && j->kind != Kind::fixed) throw std::runtime_error("the model lacks the joint of link " + w_.links[i].name);
    if (root && !std::exchange(first, false) && movers_[i].floats == stands) throw std::runtime_error("link " + w_.links[i].name + (stands ? " floats" : " stands"));
  }
}

void Mechanism::move_base(Index link, const VectorX<double>& q) {
  const Mover& m = movers_[z(link)];
  const auto qk = [&](Index k) { return Quad(q[m.q + k]); };
  Placed& at = at_[z(link)];
  at = {};
  at.X = {of_quaternion(qk(3), Real3(qk(4), qk(5), qk(6))), Real3(qk(0), qk(1), qk(2))};
  at.reach = centre_of(link);
  moved_[z(link)] = at.X * inverse(w_.links[z(link)].at.X);
  for (Index k = 0; k < 6; ++k) {
    Freedom& f = freedom(m.dof + k);
    f.turns = k < 3;
    (f.turns ? f.w : f.v) = at.X.R.col(k % 3);
    f.o = at.X.p, f.reach = at.reach;
    at.freedoms.push_back(m.dof + k);
  }
}

/// How far the centre of mass of all that is fixed to a mover's link may be from its origin.
Quad Mechanism::centre_of(Index link) const {
  Quad sum(0), mass(0);
  for (const Index i : w_.order) {
    if (carrier(i) != link) continue;
    const Solid& s = w_.links[z(i)].solid;
    mass += abs(Quad(s.mass));
    sum += abs(Quad(s.mass)) * (within_[z(i)] + length(s.centre.p));
  }
  return mass > Quad(0) ? sum / mass : Quad(0);
}

/// The link whose mover moves this one; −1 for the ground.
Index Mechanism::carrier(Index link) const {
  while (link >= 0 && movers_[z(link)].q < 0) {
    const SdfWitness::Joint* j = joint_of(link);
    link = j == nullptr ? -1 : j->parent;
  }
  return link;
}

/// Link i of moving joint j: D_i = D_parent · (the motion about the joint's place in the world).
void Mechanism::move(Index link, const SdfWitness::Joint& j, const VectorX<double>& q) {
  const Mover& m = movers_[z(link)];
  const auto qk = [&](Index k) { return Quad(q[m.q + k]); };
  Placed& at = at_[z(link)];
  Transform& D = moved_[z(link)];
  const bool root_body = at.freedoms.empty();
  const Real3 o = j.at.X.p;
  const Transform before = D;
  Real3 axes[3];
  Transform motion;
  for (std::size_t k = 0; k < j.axes.size(); ++k) axes[k] = j.axes[k];
  if (j.kind == Kind::revolute || j.kind == Kind::screw) motion = about(o, turned(axes[0], qk(0)));
  if (j.kind == Kind::prismatic) motion.p = qk(0) * axes[0];
  if (j.kind == Kind::screw) motion.p += qk(1) * axes[0], axes[1] = axes[0];
  if (j.kind == Kind::universal) {
    const Real33 first = turned(axes[0], qk(0));
    motion = about(o, first * turned(axes[1], qk(1)));
    axes[1] = first * axes[1];
  }
  if (j.kind == Kind::ball) {
    const Real33 turn = j.at.X.R * of_quaternion(qk(0), Real3(qk(1), qk(2), qk(3)));
    motion = about(o, turn * j.at.X.R.transpose());
    for (Index k = 0; k < 3; ++k) axes[k] = turn.col(k);
  }
  D = before * motion;
  const Quad travel = j.kind == Kind::prismatic ? abs(qk(0)) : j.kind == Kind::screw ? abs(qk(1)) : Quad(0);
  at.reach = root_body ? centre_of(link) : at.reach + travel;
  for (Index k = 0; k < freedoms_of(j.kind); ++k) {
    Freedom& f = freedom(m.dof + k);
    f.turns = j.kind != Kind::prismatic && !(j.kind == Kind::screw && k == 1);
    (f.turns ? f.w : f.v) = before.R * axes[k];
    f.o = Real3(D.R * o + D.p), f.reach = at.reach;
    at.freedoms.push_back(m.dof + k);
  }
}

void Mechanism::place(const VectorX<double>& q) {
  at_.assign(w_.links.size(), {});
  moved_.assign(w_.links.size(), {});
  freedom_.assign(z(model_.dofs()), {});
  within_.assign(w_.links.size(), Quad(0));
  const auto offset = [&](const SdfWitness::Joint& j, Index link) { return j.at.reach + w_.links[z(link)].at.reach; };
  for (const Index i : w_.order)
    if (const SdfWitness::Joint* j = joint_of(i); j != nullptr && !movers_[z(i)].floats)
      within_[z(i)] = offset(*j, i) + (movers_[z(i)].q < 0 && j->parent >= 0 ? within_[z(j->parent)] + offset(*j, j->parent) : Quad(0));
  for (const Index i : w_.order) {
    const SdfWitness::Joint* j = joint_of(i);
    Placed& at = at_[z(i)];
    if (movers_[z(i)].floats) {
      move_base(i, q);
      continue;
    }
    if (j != nullptr && j->parent >= 0) {
      at = at_[z(j->parent)], moved_[z(i)] = moved_[z(j->parent)];
      at.reach += offset(*j, j->parent);
      at.steps += j->at.steps + w_.links[z(j->parent)].at.steps;
    }
    if (j != nullptr && j->kind != Kind::fixed) move(i, *j, q);
    if (j != nullptr) at.reach += offset(*j, i), at.steps += j->at.steps + w_.links[z(i)].at.steps;
    at.X = moved_[z(i)] * w_.links[z(i)].at.X;
  }
}

void Mechanism::mass_matrix(double armature, MatrixX<Quad>& M, MatrixX<Quad>& bound) const {
  M = bound = MatrixX<Quad>::Constant(model_.dofs(), model_.dofs(), Quad(0));
  for (std::size_t i = 0; i < at_.size(); ++i) {
    add_link(w_.links[i].solid, at_[i], freedom_, M, bound);
    const SdfWitness::Joint* j = joint_of(static_cast<Index>(i));
    if (armature <= 0 || j == nullptr || movers_[i].floats || movers_[i].q < 0) continue;
    for (Index k = movers_[i].dof; k < movers_[i].dof + freedoms_of(j->kind); ++k) M(k, k) += Quad(armature), bound(k, k) += Quad(armature);
  }
}

Placed Mechanism::frame(const SdfWitness::Joint& j, Index link) const {
  if (link < 0) return {j.at.X, j.at.reach, j.at.steps, {}};
  Placed out = at_[z(link)];
  out.X = moved_[z(link)] * j.at.X;
  out.reach += j.at.reach + w_.links[z(link)].at.reach;
  out.steps += j.at.steps + w_.links[z(link)].at.steps;
  return out;
}

/// Rows in the axes of the joint's frame on its child: the child's motion less the parent's.
void Mechanism::loop(const SdfWitness::Joint& j, const Constraint& c, Index r, WitnessMatrices& out) const {
  using Of = Constraint::Kind;
  const Of expected = j.kind == Kind::revolute ? Of::hinge : j.kind == Kind::ball ? Of::point : j.kind == Kind::fixed ? Of::weld
                    : j.kind == Kind::prismatic ? Of::prismatic : j.kind == Kind::universal ? Of::universal : Of::general;
  if (c.kind != expected) throw std::runtime_error("constraint " + c.name + " is not of the joint's kind");
  Placed a = frame(j, j.child), b = frame(j, j.parent);
  // z along the joint's own axis; x where the constraint has it, as far as that is perpendicular
  const Index body = carrier(j.child);
  Real33 given = c.a.placement.rotation.cast<Quad>();
  if (body >= 0) given = (movers_[z(body)].floats ? w_.links[z(body)].at.X.R : joint_of(body)->at.X.R) * given;
  Real33 axes = given;
  if (!j.axes.empty()) {
    const Real3 along = j.axes.back();
    Real3 x = given.col(0) - along * Quad(along.dot(Real3(given.col(0))));
    x /= length(x);
    axes << x, along.cross(x), along;
  }
  const Real33 A = j.child < 0 ? axes : Real33(moved_[z(j.child)].R * axes);
  std::vector<Real3> angular, linear{A.col(0), A.col(1), A.col(2)};
  if (expected == Of::hinge) angular = {A.col(0), A.col(1)};
  if (expected == Of::weld || expected == Of::prismatic) angular = linear;
  if (expected == Of::prismatic) linear.pop_back(), a.X.p = b.X.p, a.reach += b.reach, b.reach = a.reach;
  if (expected == Of::universal) angular = {Real3(A.col(2)).cross(Real3((j.parent < 0 ? Real33::Identity() : moved_[z(j.parent)].R) * j.axes[0]))};
  const Quad steps = a.steps + b.steps;
  const auto side = [&](const Placed& at, const Quad& sign) {
    for (const Index k : at.freedoms) {
      const Freedom& f = freedom_[z(k)];
      const Real3 v = f.v + f.w.cross(Real3(at.X.p - f.o));
      Index row = r;
      for (const Real3& u : angular) out.J(row, k) += sign * u.dot(f.w), out.J_bound(row++, k) += f.turns ? steps : Quad(0);
      for (const Real3& u : linear) out.J(row, k) += sign * u.dot(v), out.J_bound(row++, k) += steps * (f.turns ? at.reach + f.reach : Quad(1));
    }
  };
  side(a, Quad(1)), side(b, Quad(-1));
}

/// coefficient · (how fast a link turns about an axis of the world)
void Mechanism::angle(Index link, const Real3& axis, double coefficient, Index r, WitnessMatrices& out) const {
  if (link < 0) return;
  const Placed& at = at_[z(link)];
  for (const Index k : at.freedoms) {
    const Freedom& f = freedom_[z(k)];
    out.J(r, k) += Quad(coefficient) * axis.dot(f.w);
    out.J_bound(r, k) += at.steps * abs(Quad(coefficient)) * (Quad(1) + at.reach + f.reach);
  }
}

/// A gearbox's axis at q: that of the hinge between the link and the reference body, in the sense of the gearbox's own
/// (files give the two to a few digits, parallel as they are meant).
Real3 Mechanism::gear_axis(const Real3& own, Index link, Index reference) const {
  const Real33 R = reference < 0 ? Real33::Identity() : moved_[z(reference)].R;
  for (const SdfWitness::Joint& j : w_.joints)
    if (j.in_tree && j.kind == Kind::revolute && ((j.parent == reference && j.child == link) || (j.child == reference && j.parent == link)) && abs(Quad(j.axes[0].dot(own))) > Quad(0.5))
      return R * Real3(j.axes[0].dot(own) > Quad(0) ? j.axes[0] : Real3(-j.axes[0]));
  return R * own;
}

/// angle of the child + ratio · angle of the parent = 0, both against the reference body, about its two axes.
void Mechanism::gearbox(const SdfWitness::Joint& j, Index r, WitnessMatrices& out) const {
  const Real3 first = gear_axis(j.axes[0], j.parent, j.reference), second = gear_axis(j.axes[1], j.child, j.reference);
  angle(j.child, second, 1, r, out), angle(j.reference, second, -1, r, out);
  angle(j.parent, first, j.ratio, r, out), angle(j.reference, first, -j.ratio, r, out);
}

/// travel + angle / thread_pitch = 0
void Mechanism::screw(const SdfWitness::Joint& j, Index r, WitnessMatrices& out) const {
  const Index dof = movers_[z(j.child)].dof;
  const Placed& at = at_[z(j.child)];
  out.J(r, dof + 1) += Quad(1), out.J(r, dof) += Quad(1) / Quad(j.pitch);
  for (const Index k : at.freedoms) out.J_bound(r, k) += at.steps * (Quad(1) + abs(Quad(1) / Quad(j.pitch))) * (Quad(1) + at.reach + freedom_[z(k)].reach);
}

void Mechanism::constraint(const Constraint& c, Index r, WitnessMatrices& out) const {
  for (const SdfWitness::Joint& j : w_.joints) {
    const std::string name = robot_ + "/" + j.name;
    if (j.kind == Kind::gearbox && c.name == name + " gearbox") return gearbox(j, r, out);
    if (j.kind == Kind::screw && j.in_tree && c.name == name + " screw") return screw(j, r, out);
    if (!j.in_tree && j.kind != Kind::gearbox && c.name == name) return loop(j, c, r, out);
  }
  throw std::runtime_error("the file has no joint for the constraint " + c.name);
}

/// Every joint that ties two bodies beside the tree is a constraint; `own`: of the model, less the welds.
void Mechanism::check_loops(std::size_t own) const {
  for (const SdfWitness::Joint& j : w_.joints) {
    const bool ties = j.kind == Kind::gearbox || j.kind == Kind::screw || (!j.in_tree && carrier(j.child) != carrier(j.parent));
    const std::string name = robot_ + "/" + j.name + (j.kind == Kind::gearbox ? " gearbox" : j.kind == Kind::screw && j.in_tree ? " screw" : "");
    if (ties && std::none_of(model_.constraints.begin(), model_.constraints.begin() + static_cast<std::ptrdiff_t>(own), [&](const Constraint& c) { return c.name == name; }))
      throw std::runtime_error("the model has no constraint for joint " + j.name);
  }
}

}  // namespace

WitnessMatrices sdf_matrices(const SdfWitness& witness, const Model& model, const std::string& robot, const VectorX<double>& q,
                             const std::vector<Index>& welded, double armature, bool base_given) {
  Mechanism mechanism(witness, model, robot, base_given);
  const std::size_t own = model.constraints.size() - welded.size();
  mechanism.check_loops(own);
  mechanism.place(q);
  WitnessMatrices out;
  mechanism.mass_matrix(armature, out.M, out.M_bound);
  Index rows = 0;
  for (const Constraint& c : model.constraints) rows += row_count(model, c);
  out.J = out.J_bound = MatrixX<Quad>::Constant(rows, model.dofs(), Quad(0));
  Index r = 0;
  for (std::size_t k = 0; k < own; ++k) {
    mechanism.constraint(model.constraints[k], r, out);
    r += row_count(model, model.constraints[k]);
  }
  for (const Index i : welded) mechanism.weld(i, r, out), r += 6;
  couple(out);
  return out;
}

}  // namespace delassus::reference
