// What accuracy is measured on: a scene or a member of a family, anywhere in the world.
#pragma once

#include <string>
#include <string_view>

#include "algorithms/problem/problem.h"
#include "models/scene.h"

namespace delassus::accuracy {

/// One problem, twice: as the library builds it, and as it is built about the origin of the world.
struct Subject {
  std::string name;
  bool is_scene = false;
  double away = 0;            ///< distance of the mechanism from where its description puts it, along x [m]
  Problem<double> problem;    ///< each tree about its own reference point
  Problem<double> world;      ///< the same numbers transformed to the world's origin in double
  Damping<double> damping;    ///< its own

  [[nodiscard]] Index rows() const { return problem.structure->rows; }
  [[nodiscard]] Index dofs() const { return problem.structure->dofs(); }
};

/// The scene moved by `away` before its kinematics: poses of roots, constraint frames in the world.
[[nodiscard]] Subject subject_of(Scene scene, double away);
/// Families have no world: theirs is `away` from every tree. @throws ModelError listing the families.
[[nodiscard]] Subject subject_of(std::string_view family, Index n, std::uint64_t seed, double away);
/// The size in the middle of a family's list.
[[nodiscard]] Index middle_size(std::string_view family);

/// The same problem about other points: tree t's reference point is at points[t] in the new frame, t its root body.
/// Motions v ← v + p × ω, inertias and rows accordingly. `points` has one entry per body; only roots' are read.
[[nodiscard]] Problem<double> about_origin(const Problem<double>& problem, const std::vector<Vector3<double>>& points);

}  // namespace delassus::accuracy
