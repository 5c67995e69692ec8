// Closing loops: the position-level errors of constraints, and the configuration that brings them to zero.
#pragma once

#include "algorithms/kinematics.h"

namespace delassus {

/// Position-level error φ(q) of a constraint [rad, m]: row_count entries in the order of its rows; zero for rows without
/// a position level (contact tangents, joint_friction, joint_lock, coupling, general). Linear entries are the offset of
/// the origins, a minus b, in the axes of a; angular entries are 2 sin(θ/2) × axis of the rotation of a relative to b
/// (weld, prismatic) or of its z axis (hinge, cylindrical, planar), a.z · b.x for universal. At φ = 0 the rate is the
/// rows times ν.
template <class T>
[[nodiscard]] VectorX<T> closure_error(const Model& model, const Constraint& c, const Poses<T>& poses);

/// What assembly came to: the configuration, and the largest |φ| [rad or m] of the loop constraints before and after.
struct Assembly {
  VectorX<double> q;
  double residual_before = 0, residual = 0;
  int steps = 0;
};
/// Newton's method on the constraints marked `loop`: moves q by the least-squares step −J⁺φ over the trees they touch,
/// halved while the error does not fall, until it no longer falls. Joint limits are not looked at. Dense: cost per step
/// O(rows² · dofs) of these trees. @throws ModelError naming the constraint when one stays above 30 eps · joints · size:
/// the joints on its way to the roots, and the largest length that enters its error (at least 1); std::logic_error when q
/// does not fit.
[[nodiscard]] Assembly assemble(const Model& model, const VectorX<double>& q, const std::string& file);

}  // namespace delassus
