#include "cli/gravity.h"

#include "algorithms/dynamics/dynamics.h"
#include "algorithms/dynamics/tree_operators.h"

namespace delassus::cli {

std::optional<VectorX<double>> rest_under_gravity(const Scene& scene) {
  if (!scene.has_gravity || scene.gravity.isZero(0)) return std::nullopt;
  Dynamics<double> dynamics(scene.model, scene.gravity, "lcaba");
  const Problem<double>& p = dynamics.problem();
  const VectorX<double> rest = VectorX<double>::Zero(scene.model.dofs());
  VectorX<double> fall = rest, a = VectorX<double>::Zero(structure_of(scene.model)->rows);
  if (!dynamics.update(scene.q, rest, Damping<double>::uniform(a.size(), 1)).ok() || !dynamics.aba(rest, fall).ok()) return std::nullopt;
  TreeOperators<double> tree(p.structure);
  static_cast<void>(tree.update(p));  // J asks for no M⁻¹
  tree.J(fall, a);
  return -a;
}

}  // namespace delassus::cli
