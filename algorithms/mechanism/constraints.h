// Internals of kinematics: described numbers in the scalar of a computation, and the rows K of the constraint kinds.
#pragma once

#include <type_traits>

#include "algorithms/kit/scalars.h"
#include "algorithms/mechanism/kinematics.h"

namespace delassus {

/// Whether the kind has a position level that assembly can close.
[[nodiscard]] bool has_closure(Constraint::Kind kind);

/// Distinct bodies a link constraint touches, ground left out: frame a's, then frame b's; for coupling and general
/// in the order of the terms, a joint's body before its parent.
[[nodiscard]] std::vector<Index> attached_bodies(const Model& model, const Constraint& c);

/// Checks one constraint of a model whose bodies are valid. @throws ModelError naming file, constraint and value.
void validate_constraint(const Model& model, const Constraint& c, const std::string& file);

/// One end of a constraint at given poses.
template <class T> struct End {
  Index body, tree;       ///< ground for a frame fixed in the world
  Matrix3<T> rotation;    ///< world from frame axes
  Vector3<T> position;    ///< of the frame's origin from the tree's reference point; zero in the world
  Vector3<T> reference;   ///< the tree's reference point in the world; the frame's origin itself in the world
};
template <class T> [[nodiscard]] End<T> end_of(const Poses<T>& poses, const Frame& frame);

/// Origin of a minus origin of b, world axes [m]. Within one tree no world position enters.
template <class T> [[nodiscard]] Vector3<T> offset(const End<T>& a, const End<T>& b) {
  const Vector3<T> local = a.position - b.position;
  if (a.tree == b.tree && a.tree != ground) return local;
  return local + (a.reference - b.reference);
}

/// A rotation given in double as a matrix over T. Scalars wider than double see the nearest orthogonal matrix (two
/// steps of R ← R(3 − RᵀR)/2), so that lengths are kept to their own rounding.
template <class T> [[nodiscard]] Matrix3<T> rotation_as(const Matrix3<double>& R) {
  Matrix3<T> r = R.cast<T>();
  if constexpr (unit_roundoff<T> < 0x1p-53)
    for (int step = 0; step < 2; ++step)
      r = (r * (T(3) * Matrix3<T>::Identity() - r.transpose() * r) / T(2)).eval();
  return r;
}

/// A unit vector given in double, of unit length to the rounding of T.
template <class T> [[nodiscard]] Vector3<T> unit_as(const Vector3<double>& axis) {
  using std::sqrt;
  const Vector3<T> a = axis.cast<T>();
  return a / T(sqrt(T(a.dot(a))));
}

}  // namespace delassus
