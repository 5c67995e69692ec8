// Symbolic reference: from the geometry of a mechanism to M, J and Λ⁻¹ by differentiation, without spatial algebra.
//
//   bodies       mass m, centre of mass c(q), rotation R(q), inertia I about c in body axes, hence the second moment
//                P = ∫ x xᵀ dm = ½ tr(I) 1 − I
//   velocities   ḟ = Σ_k (∂f/∂q_k) q̇_k, with the rate q̇_k of every coordinate linear in ν
//   energy       T = Σ ½ ∫ |ċ + Ṙ x|² dm + Σ ½ A_k ν_k² = Σ ½ m ċ·ċ + Σ ½ tr(Ṙ P Ṙᵀ) + Σ ½ A_k ν_k²
//   inertia      M = ∂²T / ∂ν ∂ν
//   constraints  J = E(q)ᵀ ∂φ̇/∂ν, with E the axes in which a constraint's rows are taken
//   bias         c_k = Σ m (c̈ − g)·∂ċ/∂ν_k + Σ tr(R̈ P (∂Ṙ/∂ν_k)ᵀ) at ν̇ = 0 (d'Alembert),   J̇ν = d/dt (Eᵀφ̇) at ν̇ = 0
//   operator     Λ⁻¹ = J M⁻¹ Jᵀ,  A = Λ⁻¹ + R⁻¹,  Λ_R = A⁻¹
//
// Of algorithms/ only the scalar Quad and the matrix types are used. Trusted for small mechanisms: the expressions grow
// with the depth of the tree. SI units, radians. Needs GiNaC.
#pragma once

#include <ginac/ginac.h>

#include <string>
#include <vector>

#include "algorithms/kit/spatial.h"
#include "algorithms/kit/test_scalars.h"

namespace delassus::reference::lagrangian {

/// A constant of the mechanism.
struct Parameter {
  GiNaC::symbol symbol;
  std::string meaning, unit;
  double low = 0, high = 1;   ///< where random values are drawn from
};

/// A coordinate and its rate, an expression in the coordinates and linear in ν.
struct Coordinate {
  GiNaC::symbol symbol;
  GiNaC::ex rate;
  std::string meaning, unit;
};

struct RigidBody {
  GiNaC::ex mass;             ///< [kg]
  GiNaC::matrix com;          ///< 3×1, world [m]
  GiNaC::matrix rotation;     ///< 3×3, world from body axes
  GiNaC::matrix inertia;      ///< 3×3 about com, body axes [kg m²]
};

/// k rows with one constraint function each: J = axesᵀ ∂φ̇/∂ν.
struct Rows {
  std::string meaning;
  GiNaC::matrix phi;          ///< k×1 [m or rad]
  GiNaC::matrix axes;         ///< k×k; columns are the axes of the rows
};

/// What docs/closed_forms.md shows of a mechanism: some rows, with values put in for some parameters.
struct Shown {
  std::string text;
  std::vector<unsigned> rows;
  GiNaC::exmap values;               ///< parameter to expression
  std::vector<Parameter> added;      ///< parameters the values are made of
};

struct Mechanism {
  std::string name, about;
  std::vector<Parameter> parameters;
  std::vector<Coordinate> q;
  std::vector<GiNaC::symbol> nu;
  std::vector<unsigned> quaternions;   ///< index in q of the w of every unit quaternion w x y z
  std::vector<RigidBody> bodies;
  std::vector<GiNaC::ex> armature;     ///< per entry of ν [kg m² or kg]
  std::vector<Rows> rows;
  Shown shown;
};

/// pendulum, cart_pole, double_pendulum, planar_arm, spherical_pendulum, four_bar, slider_crank, free_body.
[[nodiscard]] const std::vector<Mechanism>& mechanisms();

/// The mechanism with Shown::values put in; its parameters are those that remain and those added.
[[nodiscard]] Mechanism specialised(const Mechanism& mechanism);

/// M (n × n) and J (m × n), as differentiated.
struct Derived {
  GiNaC::matrix M, J;
};
[[nodiscard]] GiNaC::ex kinetic_energy(const Mechanism& mechanism);
/// df/dt along q̇(q, ν).
[[nodiscard]] GiNaC::ex rate(const Mechanism& mechanism, const GiNaC::ex& f);
[[nodiscard]] Derived derive(const Mechanism& mechanism);

/// c (n × 1) and J̇ν (m × 1), expressions in q and ν; g (3×1): acceleration of gravity, world axes. No armature: it has no bias.
struct Bias {
  GiNaC::matrix forces, rows;
};
[[nodiscard]] Bias bias(const Mechanism& mechanism, const GiNaC::matrix& g);

/// The expressions evaluated to 60 digits at given numbers.
class Numbers {
 public:
  /// Numbers are taken as they are in double; quaternions stand for their direction. Cost: one substitution per entry
  /// and one inverse of n × n. @throws std::logic_error when sizes do not fit.
  Numbers(const Mechanism& mechanism, const Derived& derived, const std::vector<double>& parameters,
          const VectorX<double>& q);

  // Rounded once, to Quad.
  [[nodiscard]] MatrixX<Quad> M() const;
  [[nodiscard]] MatrixX<Quad> J() const;
  /// Λ⁻¹ = J M⁻¹ Jᵀ, m × m.
  [[nodiscard]] MatrixX<Quad> lambda_inverse() const;
  /// (Λ⁻¹ + R⁻¹) x for a diagonal R⁻¹. Shapes m.
  [[nodiscard]] VectorX<Quad> apply(const std::vector<double>& R_inverse, const VectorX<double>& x) const;
  /// Λ_R a = (Λ⁻¹ + R⁻¹)⁻¹ a. Shapes m. @throws std::runtime_error when Λ⁻¹ + R⁻¹ is singular.
  [[nodiscard]] VectorX<Quad> solve(const std::vector<double>& R_inverse, const VectorX<double>& a) const;
  /// Any expression in the symbols of the mechanism, at these numbers.
  [[nodiscard]] MatrixX<Quad> evaluate(const GiNaC::matrix& expressions) const;
  /// The same of expressions in ν too. @throws std::logic_error when ν does not fit.
  [[nodiscard]] MatrixX<Quad> evaluate(const GiNaC::matrix& expressions, const VectorX<double>& nu) const;

 private:
  [[nodiscard]] GiNaC::matrix substitute(const GiNaC::matrix& expressions) const;
  [[nodiscard]] GiNaC::matrix damped(const std::vector<double>& R_inverse) const;

  std::vector<GiNaC::symbol> nu_;
  GiNaC::exmap values_;
  GiNaC::matrix M_, J_, lambda_inverse_;
};

}  // namespace delassus::reference::lagrangian
