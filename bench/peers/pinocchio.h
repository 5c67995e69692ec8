// A scene as Pinocchio 4 sees it, for the sources of bench/peers that compile its headers.
//
// Model    one joint per body with placement, inertia and armature, in depth-first order (its sparsity wants subtrees in one piece).
//          v = T ν: floating joints have their linear velocity first, planar ones theirs in body axes.
// Rows     points and contacts are its PointAnchor constraints, whose rows are the motion of frame 2 less that of frame 1 in the axes
//          of 1. The ground is frame 1 wherever it is an end, else a; the axes are those of our rows at q, for contacts in the order
//          z, x, y. Signs follow ours.
// Sources  few of its templates in each: in a large one g++ 12 inlines less, and its operator took up to twice as long.
#pragma once

#include <pinocchio/multibody.hpp>
#include <pinocchio/constraints.hpp>

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include <Eigen/Geometry>

#include "bench/peers/peer.h"

namespace delassus::bench {

namespace pin = pinocchio;
static_assert(PINOCCHIO_MAJOR_VERSION >= 4, "the comparison is written for Pinocchio 4");
using Kind = Constraint::Kind;
using Vector = VectorX<double>;
using Matrix = MatrixX<double>;
using Anchor = pin::PointAnchorConstraintModelTpl<double>;

[[noreturn]] inline void refuse(const std::string& what, const std::string& value, const std::string& accepted) {
  throw ModelError("", what, value, accepted);
}

inline pin::SE3 placement(const Pose<double>& pose) { return {pose.rotation, pose.translation}; }

/// A joint of ours as one of theirs.
inline pin::JointModel joint_model(const Joint& joint) {
  const Vector3<double>& axis = joint.axis;
  const Vector3<double> x = Vector3<double>::UnitX(), y = Vector3<double>::UnitY(), z = Vector3<double>::UnitZ();
  switch (joint.type) {
    case JointType::revolute:
      if (axis == x) return pin::JointModelRX();
      if (axis == y) return pin::JointModelRY();
      if (axis == z) return pin::JointModelRZ();
      return pin::JointModelRevoluteUnaligned(axis);
    case JointType::prismatic:
      if (axis == x) return pin::JointModelPX();
      if (axis == y) return pin::JointModelPY();
      if (axis == z) return pin::JointModelPZ();
      return pin::JointModelPrismaticUnaligned(axis);
    case JointType::universal: return pin::JointModelUniversal(axis, joint.axis2);
    case JointType::spherical: return pin::JointModelSpherical();
    case JointType::floating: return pin::JointModelFreeFlyer();
    case JointType::planar:
      if (axis == z) return pin::JointModelPlanar();
      refuse(joint.name + " axis", "a planar joint not about z", "z: Pinocchio's planar joint has no other");
    case JointType::cylindrical: refuse(joint.name + " type", "cylindrical", "a joint that Pinocchio has");
  }
  refuse(joint.name + " type", "unknown", "a joint that Pinocchio has");
}

/// Their q of one joint, and the columns of T.
inline void set_joint(const Joint& joint, const double* q, double* to, Eigen::Ref<Matrix> T) {
  T.setIdentity();
  switch (joint.type) {
    case JointType::floating:
      std::copy(q, q + 3, to);
      to[3] = q[4], to[4] = q[5], to[5] = q[6], to[6] = q[3];
      T << Matrix::Zero(3, 3), Matrix::Identity(3, 3), Matrix::Identity(3, 3), Matrix::Zero(3, 3);
      break;
    case JointType::spherical: to[0] = q[1], to[1] = q[2], to[2] = q[3], to[3] = q[0]; break;
    case JointType::planar: {
      const double c = std::cos(q[0]), s = std::sin(q[0]);
      to[0] = q[1], to[1] = q[2], to[2] = c, to[3] = s;
      T << 0, c, s, 0, -s, c, 1, 0, 0;
      break;
    }
    default: std::copy(q, q + q_size(joint.type), to);
  }
}

/// The tree, q and T.
struct Tree {
  pin::Model model;
  pin::Data data;
  Vector q;
  Matrix T;
  std::vector<pin::JointIndex> joint;  ///< of each body

  explicit Tree(const Scene& scene) : joint(scene.model.bodies.size()) {
    model.gravity.setZero();
    std::vector<std::vector<Index>> children(scene.model.bodies.size() + 1);
    for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) children[static_cast<std::size_t>(scene.model.bodies[i].parent + 1)].push_back(static_cast<Index>(i));
    add_children(scene.model, children, ground);
    data = pin::Data(model);
    q.resize(model.nq);
    T = Matrix::Zero(model.nv, model.nv);
    for (std::size_t i = 0; i < joint.size(); ++i) set(scene, i);
    pin::forwardKinematics(model, data, q);
  }

  void add_children(const Model& ours, const std::vector<std::vector<Index>>& children, Index parent) {
    for (const Index i : children[static_cast<std::size_t>(parent + 1)]) {
      const Body& b = ours.bodies[static_cast<std::size_t>(i)];
      const pin::JointIndex above = parent == ground ? 0 : joint[static_cast<std::size_t>(parent)];
      joint[static_cast<std::size_t>(i)] = model.addJoint(above, joint_model(b.joint), placement(b.joint.placement), std::to_string(i));
      model.appendBodyToJoint(joint[static_cast<std::size_t>(i)], pin::Inertia(b.mass, b.com, b.inertia), pin::SE3::Identity());
      add_children(ours, children, i);
    }
  }

  void set(const Scene& scene, std::size_t i) {
    const Joint& ours = scene.model.bodies[i].joint;
    const int first = model.idx_vs[joint[i]], n = model.nvs[joint[i]];
    const Index dof = scene.model.first_dof[i];
    set_joint(ours, scene.q.data() + scene.model.first_q[i], q.data() + model.idx_qs[joint[i]], T.block(first, dof, n, n));
    if (ours.armature.empty()) return;
    const Eigen::Map<const Vector> armature(ours.armature.data(), n);
    if (ours.type == JointType::planar && (armature.array() != 0).any()) refuse(ours.name + " armature", "on a planar joint", "none: Pinocchio's turns with the body");
    model.armature.segment(first, n) = T.block(first, dof, n, n) * armature;
  }

  [[nodiscard]] pin::SE3 world(const Frame& f) const {
    return f.body == ground ? placement(f.placement) : data.oMi[joint[static_cast<std::size_t>(f.body)]] * placement(f.placement);
  }
};

/// The two ends of a constraint on a point, with the axes of our rows on the first.
struct Ends {
  pin::JointIndex first, second;
  pin::SE3 on_first, on_second;
  double sign;  ///< our rows are that times theirs
};
inline Ends ends_of(const Tree& t, const Constraint& c) {
  if (c.kind != Kind::point && c.kind != Kind::contact) refuse(c.name, std::string(name(c.kind)), "points and contacts: this comparison makes no others for Pinocchio");
  Matrix3<double> axes = t.world(c.a).rotation();
  if (c.kind == Kind::contact) axes = (Matrix3<double>() << axes.col(2), axes.col(0), axes.col(1)).finished();
  const bool b_first = c.b.body == ground;
  const Frame &one = b_first ? c.b : c.a, &two = b_first ? c.a : c.b;
  const auto on = [&](const Frame& f) {
    const pin::JointIndex j = f.body == ground ? 0 : t.joint[static_cast<std::size_t>(f.body)];
    return std::pair(j, t.data.oMi[j].actInv(pin::SE3(axes, t.world(f).translation())));
  };
  const auto [first, on_first] = on(one);
  const auto [second, on_second] = on(two);
  return {first, second, on_first, on_second, b_first ? 1. : -1.};
}

inline Vector in_rows(const Vector& signs, const Vector& x) { return signs.cwiseProduct(x); }

/// What all have: the tree, the damping and the vector in their rows.
class Common : public Peer {
 public:
  Common(const Scene& scene, const Damping<double>& damping, const Vector& x) : tree(scene), signs(Vector::Ones(x.size())), y(x.size()) {
    if (!damping.blocks.empty()) refuse("damping", "in blocks", "a number per row");
    R_inverse = Eigen::Map<const Vector>(damping.diagonal.data(), x.size());
    other = 1.5 * R_inverse;
  }
  [[nodiscard]] Vector answer() const override { return in_rows(signs, y); }
  [[nodiscard]] Matrix M() override {
    pin::Data fresh(tree.model);
    Matrix upper = pin::crba(tree.model, fresh, tree.q, pin::Convention::WORLD);
    upper.triangularView<Eigen::StrictlyLower>() = upper.transpose();
    return tree.T.transpose() * upper * tree.T;
  }

 protected:
  const Vector& next_damping() { return (odd_ = !odd_) ? other : R_inverse; }

  Tree tree;
  Vector signs, R_inverse, other, x, y;

 private:
  bool odd_ = false;
};

/// With its constraint models.
class WithRows : public Common {
 public:
  WithRows(const Scene& scene, const Damping<double>& damping, const Vector& given) : Common(scene, damping, given) {
    for (const Constraint& c : scene.model.constraints) {
      const Ends e = ends_of(tree, c);
      signs.segment<3>(3 * static_cast<Index>(models.size())).setConstant(e.sign);
      models.push_back(Anchor(tree.model, e.first, e.on_first, e.second, e.on_second));
    }
    for (const Anchor& m : models) datas.push_back(m.createData());
    x = in_rows(signs, given);
    tree.data.q_in = tree.q;
    kinematics();
  }

 protected:
  void kinematics() {
    pin::computeJointJacobians(tree.model, tree.data, tree.q);
    calculate();
  }
  void calculate() { pin::calc(tree.model, tree.data, models, datas); }

  std::vector<Anchor> models;
  std::vector<Anchor::ConstraintData> datas;
};

/// A row's maker; the others' are in their own sources.
template <class Way> std::unique_ptr<Peer> make_way(const Scene& scene, const Damping<double>& damping, const VectorX<double>& x) { return std::make_unique<Way>(scene, damping, x); }
[[nodiscard]] std::vector<PeerRow> pinocchio_explicit(const std::string& program);

}  // namespace delassus::bench
