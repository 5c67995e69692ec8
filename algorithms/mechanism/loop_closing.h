// Closing loops: the position-level errors of constraints, and the configuration that brings them to zero.
//
// Unknowns are the degrees of freedom of the trees that loops touch, and of those coupled with them, less the held ones.
// Couplings (gears, mimics) are linear in q: every step keeps them exactly, up to rounding, so that a loop that cannot
// quite close leaves its gap in the loop. The step is the shortest one that minimises the errors left (complete
// orthogonal decomposition), halved while they do not fall. Errors are weighed as angles: lengths are divided by the
// lever arm of their constraint. Files give angles with four to six decimals; a linkage that is planar but for these
// decimals has rows of 1e-5 that should be zero, and a step that believes them moves its driver by a radian. So
// directions that answer a thousand times more weakly than the strongest are left alone first, and taken only where
// that closes the loops to rounding, or where they stay open without.
#pragma once

#include "algorithms/mechanism/kinematics.h"

namespace delassus {

/// Position-level error φ(q) of a constraint [rad, m]: row_count entries in the order of its rows; zero for rows without
/// a position level (contact tangents, joint_friction, joint_lock, coupling, general). Linear entries are the offset of
/// the origins, a minus b, in the axes of a; angular entries are 2 sin(θ/2) × axis of the rotation of a relative to b
/// (weld, prismatic) or of its z axis (hinge, cylindrical, planar), a.z · b.x for universal. At φ = 0 the rate is the
/// rows times ν.
template <class T>
[[nodiscard]] VectorX<T> closure_error(const Model& model, const Constraint& c, const Poses<T>& poses);
/// The same into `e`, without allocating; returns the number of its entries.
template <class T> Index closure_error(const Model& model, const Constraint& c, const Poses<T>& poses, T* e);

/// Gap accepted when nobody says otherwise: 1e-4 rad, and as much of the lever arm of the closure. What files round
/// (angles to 1e-4, lengths to 0.1 mm) adds up to less; a pose that is simply wrong leaves more.
inline constexpr double accepted_gap = 1e-4;

struct AssemblyOptions {
  std::vector<bool> held;  ///< per degree of freedom, or empty: not moved. Those of joint_lock never are
  double tolerance = -1;   ///< [m or rad] of closures without one of their own; negative: accepted_gap
};

/// What is left of the error of a loop constraint: of its entries the largest against what is accepted.
struct Gap {
  Index constraint = 0;    ///< in Model::constraints
  double before = 0;       ///< its largest entry before assembly [rad or m]
  double after = 0;
  double rounding = 0;     ///< rounding alone may leave this: 30 u · joints on the ways to the roots · lengths (at least 1)
  double accepted = 0;     ///< the closure is open above; never below `rounding`
  bool angle = false;      ///< after, rounding and accepted are rad, else m
  [[nodiscard]] bool open() const { return !(after <= accepted); }
};

/// A joint that assembly moved by more than rounding.
struct Move {
  Index body = 0;
  double turned = 0, shifted = 0;  ///< angle [rad] and distance [m]
};

/// A degree of freedom that assembly took beyond its limit, because no pose within the limits was found.
struct Beyond {
  Index body = 0, dof = 0;
  double value = 0, limit = 0;     ///< [rad or m]
};

/// What assembly came to: the configuration, and the largest |φ| [rad or m] of the loop constraints before and after.
struct Assembly {
  VectorX<double> q;
  double residual_before = 0, residual = 0;
  int steps = 0;
  std::vector<Gap> gaps;           ///< one per loop constraint, in their order
  std::vector<Move> moves;         ///< in the order of the bodies
  std::vector<Beyond> beyond;
};

/// Newton's method on the constraints marked `loop`. Couplings keep the sum Σ coefficient · q that they have at q; terms
/// on spherical and floating joints have none and are left out. Limits of joints are kept (those that q breaks
/// already, where q is) when a pose within them is found from q or from the middle of the ranges; else `beyond` says
/// which are not. Never throws for loops that stay open: `gaps` tell. Dense: cost per step O(rows² · dofs) of the trees
/// concerned. @throws std::logic_error when sizes do not fit.
[[nodiscard]] Assembly close_loops(const Model& model, const VectorX<double>& q, const AssemblyOptions& options = {});

/// The same. @throws ModelError naming the constraints that stay open, and by how much.
[[nodiscard]] Assembly assemble(const Model& model, const VectorX<double>& q, const std::string& file,
                                const AssemblyOptions& options = {});

/// What is wrong and what is accepted, for a message about the loops of `a` that stay open; `worst` is the gap it is
/// about, the one largest against what is accepted.
struct OpenLoops {
  const Gap* worst = nullptr;      ///< null: none is open
  std::string problem, accepted;
};
[[nodiscard]] OpenLoops open_loops(const Model& model, const Assembly& a);

}  // namespace delassus
