// One problem to more digits than any operator is judged by, and the error of an answer in the norms the library uses.
//
//   ‖x‖²_A = xᵀ A x = ‖M⁻¹Jᵀx‖²_M + ‖x‖²_{R⁻¹}                 the energy norm; of λ itself it is λᵀa
//
// A certificate B² = r₁ᵀM⁻¹r₁ + r₂ᵀR r₂ of a pair (ν, λ) bounds that of λ alone: from (K) of algorithms/factors/refinement.h,
// A δλ = r₂ − J M⁻¹r₁, so ‖δλ‖²_A = δλᵀr₂ − (M⁻¹Jᵀδλ)ᵀr₁ ≤ ‖δλ‖_A B, by Cauchy and Schwarz.
// A refined λ is rounded to double when it is returned. That changes it by e, |e_r| ≤ eps |λ_r|, or half the least denormal
// number 2⁻¹⁰⁷⁴ where λ_r is below that, and its energy by at most
//   ‖e‖_A ≤ √(|e|ᵀ|A||e|)                                      `rounding`
// which is more than eps ‖λ‖_A where forces cancel: no answer in double can be expected to be better.
// B² itself is evaluated with the factors of M and R⁻¹, to a relative eps κ, κ the larger condition number of the two when
// brought to unit diagonal (Higham, section 10.1): `violation` counts an excess over the bound in units of that. Where a row is
// hard, with √κ of A in the place of R⁻¹: the factor is one of rows within eps of those of A (hard_rows.h).
#pragma once

#include <optional>

#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"

namespace delassus::laws {

/// Relative errors of a λ̂ against λ.
struct Errors {
  double force = 0;      ///< max|δλ| / max|λ|
  double motion = 0;     ///< ‖M⁻¹Jᵀδλ‖_M / ‖M⁻¹Jᵀλ‖_M
  double energy = 0;     ///< ‖δλ‖_A / ‖λ‖_A
  double backward = 0;   ///< ‖a − A λ̂‖ / (‖A‖‖λ̂‖ + ‖a‖), ∞-norms
};

class Truth {
 public:
  /// Up to 100 degrees of freedom and 150 rows by the definition in Quad; beyond, the columns of J M⁻¹Jᵀ by aba_sweep in
  /// Quad. Cost m sweeps and m³. @throws std::runtime_error when M is singular.
  Truth(const Problem<double>& problem, const Damping<double>& damping);

  /// A has no lost pivot in Quad.
  [[nodiscard]] bool regular() const { return factor_->regular(); }
  /// λ = A⁻¹ a. Shapes m. @throws std::runtime_error when A is singular.
  [[nodiscard]] VectorX<Quad> solve(const VectorX<double>& a) const;
  /// J M⁻¹Jᵀ x, rounded: an acceleration that forces can cause; of x times a power of two where it would exceed 2¹⁰⁰⁰. Shapes m.
  [[nodiscard]] VectorX<double> reachable(const VectorX<double>& x) const;
  /// Shapes m. λ̂ holds no NaN.
  [[nodiscard]] Errors errors(const VectorX<double>& a, const VectorX<Quad>& lambda, const VectorX<double>& answer) const;
  /// √(xᵀ A x).
  [[nodiscard]] Quad energy(const VectorX<Quad>& x) const;
  /// √(|e|ᵀ|A||e|) / ‖λ‖_A.
  [[nodiscard]] double rounding(const VectorX<Quad>& lambda) const;
  /// (error − bound − rounding) / (eps κ bound), 0 when the error is not above; to be judged below 30 (verdict.h).
  [[nodiscard]] double violation(double error, double bound, double rounding) const;
  /// The matrices; none beyond the size of the definition.
  [[nodiscard]] const std::optional<reference::Dense<Quad>>& dense() const { return dense_; }

 private:
  std::optional<reference::Dense<Quad>> dense_;
  std::optional<reference::PivotedLdlt<Quad>> factor_;
  MatrixX<Quad> A0_, A_;
};

/// √(xᵀ B x), B symmetric positive semidefinite; 0 where rounding leaves it negative.
[[nodiscard]] Quad norm(const MatrixX<Quad>& B, const VectorX<Quad>& x);
/// |X|.
[[nodiscard]] MatrixX<Quad> entrywise(const MatrixX<Quad>& X);

}  // namespace delassus::laws
