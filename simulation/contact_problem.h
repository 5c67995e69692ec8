// What a contact solver is given: a plain value that knows no scene. It can be written to a file, replayed and generated.
//
//   u = (G + R⁻¹) λ + g − target,   G = J M⁻¹ Jᵀ          velocities [m/s, rad/s] and impulses [N s, N m s] of the rows
//   group by group (u, λ) is in the complementarity of its cone K:
//     free        λ anything,           u = 0
//     half line   λ ≥ 0 ⊥ u ≥ 0
//     box         low ≤ λ ≤ high;       u ≥ 0 where λ = low, u ≤ 0 where λ = high, u = 0 between
//     Coulomb     K = {λ_n ≥ ‖(λ_i/μ_i)‖}, normal first, then one or more tangents with a coefficient each (μ_i = 0: λ_i = 0):
//                   exact     K ∋ λ ⊥ u + Γ e_n ∈ K*,   Γ = ‖(μ_i u_i)‖ (μ‖u_t‖ where all are equal)
//                   relaxed   K ∋ λ ⊥ u ∈ K*            convex; a sliding contact separates with Γ
//             K* = {u_n ≥ ‖(μ_i u_i)‖}
// The motion is v⁺ = v_f + M⁻¹ Jᵀ λ for g = J v_f.
// Source   G. de Saxcé, Z.-Q. Feng 1998 (the shift Γ); M. Anitescu, G. Hart 2004 (the relaxation).
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/kit/scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::simulation {

enum class Cone : std::uint8_t { free, half_line, box, coulomb };
[[nodiscard]] std::string_view name(Cone c);

/// What is asked of the Coulomb groups.
enum class FrictionLaw : std::uint8_t { exact, relaxed };
[[nodiscard]] std::string_view name(FrictionLaw f);

inline constexpr Index max_cone_rows = 6;  ///< of a Coulomb group: normal, two tangents, torsion, two rolling

/// Consecutive rows that share a cone. Of half line and box every row is a cone of its own.
struct ConeRows {
  Cone cone;
  Index row, rows;  ///< rows [row, row + rows); Coulomb: 2 … max_cone_rows
};

template <class T> struct ContactProblem {
  /// M (joint damping and stiffness within its armature) and J; or none, and G is given.
  std::shared_ptr<const Problem<T>> mechanism;
  MatrixX<T> G;                    ///< m × m, symmetric positive semidefinite [1/kg]; empty where there is a mechanism
  std::vector<ConeRows> groups;    ///< ascending, every row in exactly one
  FrictionLaw law = FrictionLaw::exact;
  VectorX<T> free_velocity;        ///< g, m
  VectorX<T> target;               ///< m
  std::vector<T> R_inverse;        ///< m, ≥ 0 [1/kg]; 0: hard; ∞ in every row of a group: the group is off, its λ is 0
  std::vector<T> friction;         ///< m, ≥ 0: μ_i of the tangents of Coulomb groups, 0 in other rows
  std::vector<T> low, high;        ///< m: impulses of the rows of boxes, 0 in other rows; −∞ and ∞ are allowed
  VectorX<T> warm_start;           ///< λ to begin at, m; empty: zero

  [[nodiscard]] Index rows() const { return free_velocity.size(); }
  [[nodiscard]] bool is_off(const ConeRows& c) const { return ScalarTraits<T>::is_infinite(R_inverse[static_cast<std::size_t>(c.row)]); }
  /// The damping of the rows, for an operator.
  [[nodiscard]] Damping<T> damping() const { return {R_inverse, {}}; }
  /// Zeros of the right sizes: hard rows without a group.
  void resize(Index m);
  /// @throws ModelError naming the group or row and the value where the problem cannot be right: sizes, rows in no group or in two,
  /// a Coulomb group of one row or too many, μ < 0, low > high, R⁻¹ < 0, a number that is not finite, a group that is partly off.
  void validate() const;
  /// The same in another scalar. Bounds may be infinite, and the damping of what is off.
  template <class U> [[nodiscard]] ContactProblem<U> cast() const;
};

/// Appends a group behind the last one's rows; returns it. @throws std::logic_error where the problem has not so many rows left.
template <class T> ConeRows& append(ContactProblem<T>& p, Cone cone, Index rows);
/// Coulomb rows: normal, then `tangents` with the coefficient μ.
template <class T> ConeRows& append_contact(ContactProblem<T>& p, const T& mu, Index tangents = 2);

template <class T> template <class U> ContactProblem<U> ContactProblem<T>::cast() const {
  const auto number = [](const T& x) {
    using std::isfinite;
    if (isfinite(x)) return scalar_cast<U>(x);
    if (ScalarTraits<T>::is_infinite(x)) return ScalarTraits<U>::infinity();
    return ScalarTraits<T>::is_infinite(-x) ? U(-ScalarTraits<U>::infinity()) : ScalarTraits<U>::nan();
  };
  const auto vector = [&](const VectorX<T>& x) {
    VectorX<U> y(x.size());
    for (Index k = 0; k < x.size(); ++k) y[k] = number(x[k]);
    return y;
  };
  const auto array = [&](const std::vector<T>& x) {
    std::vector<U> y;
    for (const T& v : x) y.push_back(number(v));
    return y;
  };
  ContactProblem<U> p;
  if (mechanism) p.mechanism = std::make_shared<const Problem<U>>(mechanism->template cast<U>());
  p.G.resize(G.rows(), G.cols());
  for (Index k = 0; k < G.size(); ++k) p.G.data()[k] = number(G.data()[k]);
  p.groups = groups;
  p.law = law;
  p.free_velocity = vector(free_velocity);
  p.target = vector(target);
  p.R_inverse = array(R_inverse);
  p.friction = array(friction);
  p.low = array(low);
  p.high = array(high);
  p.warm_start = vector(warm_start);
  return p;
}

}  // namespace delassus::simulation
