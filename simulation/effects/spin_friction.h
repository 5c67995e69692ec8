// Torsional and rolling friction: rows about the normal and about the tangents of contacts. Two rows of the table.
//
//   torsional   a row ℓ ω_n, ℓ = c/μ          |moment about the normal| ≤ c λ_n
//   rolling     two rows ℓ ω_t, ℓ = c/μ       ‖moment across it‖ ≤ c λ_n
// for a coefficient c [m] of the scene and μ that of sliding (1 where nothing slides). Measured at the arm ℓ all rows of a contact are
// speeds [m/s] with impulses [N s] and one coefficient: K = {λ_n ≥ ‖λ_i‖/μ}, a circular cone, projected in closed form.
// Couples  One cone holds all of them: (‖λ_t‖/μ)² + (moments/c)² ≤ λ_n², with the most dissipation. What slides and spins spends
//          less on each, and what rolls while it is decelerated creeps, by u_t of order (c/(μ r))² of its speed at radius r.
// Cost     a row 40 operations beside the solver. Energy: dissipates.
// Source   E. Todorov 2014 (elliptic cones of up to six rows); R. I. Leine, Ch. Glocker 2003 (Coulomb–Contensou).
#pragma once

#include "simulation/terms.h"

namespace delassus::simulation {

template <class T> class TorsionalFriction final : public Effect, public RowsTerm<T> {
 public:
  explicit TorsionalFriction(double c) : c_(c) {}
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this)); }

 private:
  T c_;
};

template <class T> class RollingFriction final : public Effect, public RowsTerm<T> {
 public:
  explicit RollingFriction(double c) : c_(c) {}
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this)); }

 private:
  T c_;
};

}  // namespace delassus::simulation
