// Rows of one step that are in a cone: on a joint, or of a contact of two bodies. Plain values that effects write one after another.
#pragma once

#include "algorithms/problem/problem.h"
#include "simulation/state.h"

namespace delassus::simulation {

template <class T> struct RowSet {
  enum class Kind : std::uint8_t { limit, joint_friction, contact } kind = Kind::contact;
  Identity identity{};
  Index body = ground, other = ground;  ///< the moved body of a joint; the two bodies of a contact
  Index dof = 0;                        ///< of the joint
  int side = 1;                         ///< limit: row side · ν_dof
  Vector3<T> point, point_of_other;     ///< the contact's point from the reference points of either tree [m]
  Matrix3<T> axes;                      ///< columns: normal from `other` to `body`, two tangents; world
  Index directions = 1;                 ///< rows: the normal, and what friction adds: row()
  bool tangents = false;                ///< Coulomb's two
  T gap{};                              ///< [m or rad]
  T friction{-1};                       ///< coefficient as the scene has it; negative: not given
  T target{};                           ///< least velocity along the normal after the step
  T coefficient{};                      ///< of all rows behind the normal
  T torsion{}, rolling{};               ///< arms of the rows about the normal and about the tangents [m]; 0: none
  T effort{};                           ///< joint_friction: largest |impulse| [N m s or N s]
  T R_inverse{};                        ///< [1/kg]

  /// Row k of a contact: the velocity of the point along a column of the axes, or arm · the angular velocity about it.
  struct Row {
    Index axis;
    bool spins;
    T arm;
  };
  [[nodiscard]] Row row(Index k) const {
    if (k == 0) return {0, false, T(0)};
    if (tangents && k < 3) return {k, false, T(0)};
    if (tangents) k -= 2;
    if (torsion > T(0) && k == 1) return {0, true, torsion};
    return {torsion > T(0) ? k - 1 : k, true, rolling};
  }
};

inline constexpr double gap_share = 0.2;   ///< β: of a deep penetration that is taken back in a step
inline constexpr double gap_speed = 1;     ///< fastest [m/s or rad/s]
inline constexpr double even_speed = 0.01; ///< up to this a penetration is taken back like an opening is closed, at once [m/s or rad/s]

/// Least velocity of a row whose gap is φ: −φ/h, and of what exceeds even_speed the share β, at most gap_speed. The same slope on both
/// sides of φ = 0: four corners of one face have gaps that fit together, and so must their velocities, or one of them has to open.
template <class T> [[nodiscard]] T target_of_gap(const T& gap, const T& h) {
  const T speed = -gap / h;
  if (!(speed > T(even_speed))) return speed;
  return std::min(T(gap_speed), T(T(even_speed) + T(gap_share) * (speed - T(even_speed))));
}

}  // namespace delassus::simulation
