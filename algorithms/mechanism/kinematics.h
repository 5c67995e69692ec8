// From a described mechanism and a configuration to the numbers of a Problem.
//
// Reference point of a tree: the centre of mass of its root body (the origin of the root body's frame when massless).
// All positions are propagated relative to it; neither the position of a floating base nor the placement of a root in
// the world enters them, so a robot kilometres from the origin loses no digit. World positions enter in two places
// only, as differences of reference points: the rows of kinds whose frames slide or stand apart (cylindrical,
// prismatic, planar, distance) between two trees or a tree and the world, and closure errors.
//
// Instantiated for double, float, Quad and Counted. Scalars wider than double take the rotations and axes of a model as
// the nearest orthogonal ones.
#pragma once

#include "algorithms/mechanism/model.h"

namespace delassus {

/// The tree and constraint attachments of a model. Constraints keep their order; rows follow it. A frame fixed in the
/// world adds no attachment; several terms on one body are merged. Cost O(N + m). @throws ModelError for a constraint
/// of a body with itself, or one that names what does not exist.
[[nodiscard]] std::shared_ptr<const Structure> structure_of(const Model& model);

/// Body poses at a configuration, relative to the reference points.
template <class T> struct Poses {
  std::vector<Matrix3<T>> rotation;       ///< world from body axes
  std::vector<Vector3<T>> position;       ///< of the body frame's origin, from the tree's reference point
  std::vector<Index> tree;                ///< tree (index of its root body) of each body
  std::vector<Vector3<T>> reference;      ///< at roots: the tree's reference point in the world; elsewhere unused
};

/// Fills `out` at q (size q_size; quaternions of any length but zero stand for their direction). Compiles the bodies at each
/// call: who asks again and again keeps a Mechanism (mechanism.h). Cost O(N). @throws std::logic_error when q does not fit.
template <class T> void poses(const Model& model, const VectorX<T>& q, Poses<T>& out);

/// Fills S, armature, H, K and joint_K at q (size q_size), world axes, each tree about its reference point.
/// `out.structure` must come from structure_of(model). As poses, it compiles the model at each call. Cost O(N + m).
/// Rows are the motion of side a minus that of side b, in the axes of frame a. Each side's point is the origin of its
/// own frame; kinds whose origins drift apart (cylindrical, prismatic, planar) take the origin of b on both sides.
/// H is symmetric to the bit. @throws std::logic_error when sizes do not fit. NaN in q, or a distance of zero length,
/// gives NaN.
template <class T> void kinematics(const Model& model, const VectorX<T>& q, Poses<T>& poses, Problem<T>& out);

/// The same with fresh storage.
template <class T> [[nodiscard]] Problem<T> kinematics(const Model& model, const VectorX<T>& q);

/// q moved by the constant velocity ν for unit time: q ⊕ ν. Exact for every joint: quaternions by the exponential map,
/// floating bodies on their screw motion (ω and v constant in body axes). Lengths of quaternions are kept. Cost O(N).
/// @throws std::logic_error when sizes do not fit.
template <class T> [[nodiscard]] VectorX<T> integrate(const Model& model, const VectorX<T>& q, const VectorX<T>& v);

}  // namespace delassus
