// Bounds of the comparison with MuJoCo (mujoco_witness.h). Nothing here calls MuJoCo.
#include <cmath>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/loop_closing.h"
#include "reference/definition.h"
#include "reference/mujoco_witness.h"

namespace delassus::reference {
namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

/// Length of the translation of a joint at its own entries of q.
double joint_travel(JointType type, const double* q) {
  switch (type) {
    case JointType::prismatic: return std::fabs(q[0]);
    case JointType::cylindrical: return std::fabs(q[1]);
    case JointType::planar: return std::hypot(q[1], q[2]);
    case JointType::floating: return std::hypot(q[0], q[1], q[2]);
    default: return 0;
  }
}

/// ℓ_i of every body's frame: the path to it, and to the two points about which its tree is computed: the tree's centre of
/// mass by MuJoCo, that of the root body by kinematics; and `farther`.
Vector reach_of(const Model& model, const Vector& q, const Vector& farther) {
  Vector reach(static_cast<Index>(model.bodies.size()));
  for (Index i = 0; i < reach.size(); ++i) {
    const Body& body = model.bodies[i];
    reach[i] = (body.parent == ground ? 0 : reach[body.parent]) + body.joint.placement.translation.stableNorm() +
               joint_travel(body.joint.type, q.data() + model.first_q[i]);
  }
  const auto tree = [&](Index i) {
    while (model.bodies[i].parent != ground) i = model.bodies[i].parent;
    return i;
  };
  Vector mass = Vector::Zero(reach.size()), moment = mass;  // by the tree's root
  for (Index i = 0; i < reach.size(); ++i) {
    const Body& body = model.bodies[i];
    const Index root = tree(i);
    mass[root] += body.mass, moment[root] += body.mass * (reach[i] + body.com.stableNorm());
  }
  for (Index i = 0; i < reach.size(); ++i)
    if (mass[tree(i)] > 0) reach[i] += moment[tree(i)] / mass[tree(i)];
  for (Index i = 0; i < reach.size(); ++i) {
    const Body& root = model.bodies[tree(i)];
    if (root.mass > 0) reach[i] += root.com.stableNorm();
  }
  return farther.size() == 0 ? reach : Vector(reach + farther);
}

Vector6<double> halves(double angular, double linear) {
  Vector6<double> x;
  x << Vector3<double>::Constant(angular), Vector3<double>::Constant(linear);
  return x;
}

Matrix6<double> inertia_size(const Body& body, double reach) {
  const double c = reach + body.com.norm(), m = body.mass;
  Matrix6<double> H;
  H.topLeftCorner<3, 3>().setConstant(body.inertia.norm() + m * c * c);
  H.topRightCorner<3, 3>().setConstant(m * c);
  H.bottomLeftCorner<3, 3>().setConstant(m * c);
  H.bottomRightCorner<3, 3>().setConstant(m);
  return H;
}

/// By how much the direction of a distance row is worse than the positions it comes from.
double direction_loss(const Model& model, const Constraint& c, const Vector& reach, const Poses<double>& at) {
  if (c.kind != Constraint::Kind::distance) return 1;
  double ends = 0;
  for (const Frame* f : {&c.a, &c.b}) ends += (f->body == ground ? 0 : reach[f->body]) + f->placement.translation.stableNorm();
  return 1 + ends / (closure_error(model, c, at)[0] + c.length);
}

/// The problem with every number replaced by the size of what it was computed from.
Problem<double> sizes_of(const Model& model, const Vector& q, Problem<double> p, const Vector& farther) {
  const Structure& s = *p.structure;
  const Vector reach = reach_of(model, q, farther);
  Poses<double> at;
  poses(model, q, at);
  for (Index i = 0; i < s.bodies(); ++i) {
    p.H[i] = inertia_size(model.bodies[i], reach[i]);
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      const bool turns = !(p.S[k].head<3>().array() == 0).all();
      p.S[k] = turns ? halves(1, reach[i]) : halves(0, 1);
    }
  }
  std::size_t link = 0;
  for (const Constraint& c : model.constraints) {
    if (acts_on_joint(c.kind)) continue;
    const Structure::LinkConstraint& e = s.link_constraints[link++];
    const double loss = direction_loss(model, c, reach, at);
    for (const auto& l : e.links) {
      double arm = reach[l.body];
      for (const Frame* f : {&c.a, &c.b}) arm += f->placement.translation.stableNorm();
      for (Index k = 0; k < e.rows; ++k) {
        const double linear = loss * p.K[l.first + k].tail<3>().stableNorm(), angular = p.K[l.first + k].head<3>().stableNorm();
        p.K[l.first + k] = halves(angular + linear * arm, linear);
      }
    }
  }
  for (double& k : p.joint_K) k = 1;  // T turns the axes within a joint
  return p;
}

}  // namespace

WitnessBounds witness_bounds(const Model& model, const VectorX<double>& q, const Problem<double>& problem, const VectorX<double>& farther) {
  const Problem<double> sizes = sizes_of(model, q, problem, farther);
  WitnessBounds b{mass_matrix(sizes), constraint_jacobian(sizes), {}};
  const Problem<Quad> wide = problem.cast<Quad>();
  const MatrixX<Quad> X = PivotedLdlt<Quad>(mass_matrix(wide)).solve(constraint_jacobian(wide).transpose());
  Matrix size(X.rows(), X.cols());
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) size(i, j) = std::fabs(static_cast<double>(X(i, j)));
  const Matrix of_J = b.J * size;
  b.A = of_J + of_J.transpose() + size.transpose() * (b.M * size);
  return b;
}

}  // namespace delassus::reference
