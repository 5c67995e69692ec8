#include "cli/gravity.h"

#include "algorithms/delassus.h"
#include "algorithms/mechanism/kinematics.h"

namespace delassus::cli {

namespace {

/// τ_i = S_iᵀ Σ_{bodies above i} H (0; g), one number per degree of freedom.
VectorX<double> weights(const Problem<double>& p, const Model& model, const Vector3<double>& g) {
  std::vector<Vector6<double>> force;
  Vector6<double> fall;
  fall << Vector3<double>::Zero(), g;
  for (const Matrix6<double>& H : p.H) force.push_back(H * fall);
  VectorX<double> tau(model.dofs());
  for (Index i = static_cast<Index>(model.bodies.size()) - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    for (Index d = model.first_dof[k]; d < model.first_dof[k + 1]; ++d) tau[d] = p.S[static_cast<std::size_t>(d)].dot(force[k]);
    if (model.bodies[k].parent != ground) force[static_cast<std::size_t>(model.bodies[k].parent)] += force[k];
  }
  return tau;
}

}  // namespace

std::optional<VectorX<double>> rest_under_gravity(const Scene& scene) {
  if (!scene.has_gravity || scene.gravity.isZero(0)) return std::nullopt;
  Model with_motors = scene.model;  // a row for every degree of freedom behind the scene's own: J' = (J; 1)
  for (Index i = 0; i < static_cast<Index>(with_motors.bodies.size()); ++i) {
    Constraint& motor = with_motors.constraints.emplace_back();
    motor.kind = Constraint::Kind::joint_lock;
    motor.a.body = i;
  }
  const Problem<double> p = kinematics<double>(with_motors, scene.q);
  const Index rows = structure_of(scene.model)->rows;
  MatrixX<double> f = MatrixX<double>::Zero(p.structure->rows, 1), a = f;
  f.bottomRows(scene.model.dofs()) = weights(p, scene.model, scene.gravity);
  const auto op = find_operator("aba_sweep").make<double>();
  op->analyze(p.structure);
  if (!op->update(p, Damping<double>::uniform(p.structure->rows, 0)).ok()) return std::nullopt;
  Workspace<double> workspace(op->workspace());
  if (!op->apply(f, a, workspace).ok()) return std::nullopt;
  return -a.col(0).head(rows);
}

}  // namespace delassus::cli
