// The cones of contact_problem.h: projections, their derivatives, distances to the dual cones. Any scalar with a square root.
//
//   Π(x)    argmin over K of ‖x − λ‖                                      half line, box: clamped
//   Coulomb inside: x. −x in K*: 0. Else on the boundary, λ = (1 + s C)⁻¹ x, C = diag(−1, 1/μ_i²), with s > 0 of λᵀCλ = 0:
//             all μ_i equal: λ_n = (x_n + μ‖x_t‖)/(1 + μ²), λ_t = μ λ_n x_t/‖x_t‖
//             otherwise Newton within a bracket on x_n − (1 − s) N(s), N = ‖(x_i μ_i/(μ_i² + s))‖ = λ_n, which increases
//   Π'(x)   on the boundary B − (B w)(B w)ᵀ/(wᵀB w), w = C λ, B = (1 + s C)⁻¹; with b_i = μ_i²/(μ_i² + s), w_i = λ_i/μ_i²,
//           q = Σ b_i w_i² and D = (1 − s) q + λ_n² > 0, which has no pole at s = 1:
//             Π'_nn = q/D,  Π'_ni = λ_n b_i w_i/D,  Π'_ij = b_i δ_ij − (1 − s) b_i w_i b_j w_j/D
//   K*      {u_n ≥ ‖(μ_i u_i)‖}; Π_K*(u) = u + Π(−u)                       (Moreau)
// Cost     O(rows), and of unequal μ_i that times at most 60 steps. Nothing allocates.
#pragma once

#include <algorithm>
#include <cmath>

#include "simulation/contact_problem.h"

namespace delassus::simulation {

/// ‖(μ_i u_i)‖ over the tangents: the shift Γ. u: rows of the group; mu: its coefficients, mu[0] unused.
template <class T> [[nodiscard]] T tangent_norm(const T* u, const T* mu, Index rows) {
  using std::sqrt;
  T sum(0);
  for (Index k = 1; k < rows; ++k) sum += (mu[k] * u[k]) * (mu[k] * u[k]);
  return sqrt(sum);
}

/// How far u is from K* along the normal: max(0, ‖(μ_i u_i)‖ − u_n) [m/s]. Zero exactly where u is in K*.
template <class T> [[nodiscard]] T dual_defect(const T* u, const T* mu, Index rows) {
  return std::max(T(0), T(tangent_norm(u, mu, rows) - u[0]));
}

/// How far λ is from K: max(0, ‖λ_t‖ − the radius μ λ_n in its direction), and −λ_n where that is negative [N s].
template <class T> [[nodiscard]] T cone_defect(const T* lambda, const T* mu, Index rows) {
  using std::sqrt;
  T length(0), scaled(0), frictionless(0);
  for (Index k = 1; k < rows; ++k) {
    const T square = lambda[k] * lambda[k];
    if (mu[k] > T(0)) {
      length += square;
      scaled += square / (mu[k] * mu[k]);
    } else {
      frictionless += square;
    }
  }
  const T normal = std::max(T(0), lambda[0]);
  T excess = sqrt(frictionless);
  if (scaled > T(0) && sqrt(scaled) > normal) excess = std::max(excess, T(sqrt(length) * (T(1) - normal / sqrt(scaled))));
  return std::max(excess, std::max(T(0), T(-lambda[0])));
}

/// Where Π(x) of a Coulomb cone lies.
enum class Region : std::uint8_t { inside, apex, boundary };

/// The projection on a Coulomb cone, in place, and the number s of its derivative.
template <class T> struct ConeProjection {
  Region region = Region::inside;
  T s{};

  /// x: rows of the group, overwritten by Π(x).
  static ConeProjection project(T* x, const T* mu, Index rows);
  /// d: rows × rows, column-major: Π'(x) with λ = Π(x). One-sided on the cone's edges.
  void derivative(const T* lambda, const T* mu, Index rows, T* d) const;
};

/// Π of every row of a group: x points at the problem's row c.row.
template <class T> void project(const ContactProblem<T>& p, const ConeRows& c, T* x) {
  const auto first = static_cast<std::size_t>(c.row);
  switch (c.cone) {
    case Cone::free: return;
    case Cone::half_line:
      for (Index k = 0; k < c.rows; ++k) x[k] = std::max(x[k], T(0));
      return;
    case Cone::box:
      for (Index k = 0; k < c.rows; ++k) x[k] = std::min(std::max(x[k], p.low[first + k]), p.high[first + k]);
      return;
    case Cone::coulomb: ConeProjection<T>::project(x, p.friction.data() + first, c.rows); return;
  }
}

/// The same of all groups; those that are off are set to 0.
template <class T> void project_all(const ContactProblem<T>& p, T* lambda) {
  for (const ConeRows& c : p.groups) {
    if (p.is_off(c)) std::fill(lambda + c.row, lambda + c.row + c.rows, T(0));
    else project(p, c, lambda + c.row);
  }
}

}  // namespace delassus::simulation
