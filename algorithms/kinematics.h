// From a described mechanism and a configuration to the numbers of a Problem.
//
// Reference point of a tree: the centre of mass of its root body (the root joint frame's origin when massless). All
// positions are propagated relative to it and the world position of a floating base never enters them, so a robot
// kilometres from the origin loses no digit.
#pragma once

#include "algorithms/model.h"

namespace delassus {

/// The tree and constraint attachments of a model. Constraints keep their order; rows follow it.
[[nodiscard]] std::shared_ptr<const Structure> structure_of(const Model& model);

/// Body poses at a configuration, relative to the reference points.
template <class T> struct Poses {
  std::vector<Matrix3<T>> rotation;       ///< world from body axes
  std::vector<Vector3<T>> position;       ///< of the body frame's origin, from the tree's reference point
  std::vector<Index> tree;                ///< tree (index of its root body) of each body
  std::vector<Vector3<T>> reference;      ///< per body (used at roots): the tree's reference point in the world
};

template <class T> void poses(const Model& model, const VectorX<T>& q, Poses<T>& out);

/// Fills S, armature, H, K and joint_K at q (size q_size). `out` must come from structure_of(model) and is not
/// reallocated. @throws std::logic_error when sizes do not fit. Cost O(N + m).
template <class T> void kinematics(const Model& model, const VectorX<T>& q, Poses<T>& poses, Problem<T>& out);

/// The same with fresh storage.
template <class T> [[nodiscard]] Problem<T> kinematics(const Model& model, const VectorX<T>& q);

/// q moved by the velocity ν for unit time: q ⊕ ν (exact for quaternions: exponential map).
template <class T> [[nodiscard]] VectorX<T> integrate(const Model& model, const VectorX<T>& q, const VectorX<T>& v);

/// Position-level error φ(q) of a constraint, whose rate is J ν: row_count entries; zero for constraints that have no
/// position level (contact tangents, joint friction, general).
template <class T>
[[nodiscard]] VectorX<T> closure_error(const Model& model, const Constraint& c, const Poses<T>& poses);

/// Newton's method on the constraints marked `loop`: moves q by the least-squares step until the closure error stops
/// falling. Returns the configuration and the largest remaining |φ|. @throws ModelError when it stays above 1e-9 · size.
struct Assembly {
  VectorX<double> q;
  double residual_before = 0, residual = 0;
  int steps = 0;
};
[[nodiscard]] Assembly assemble(const Model& model, const VectorX<double>& q, const std::string& file);

}  // namespace delassus
