// The answer in 113 bits, and how far from it another answer is.
#pragma once

#include <memory>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::accuracy {

/// An answer: constraint forces, and the motion that goes with them when the solver has one of its own.
struct Answer {
  VectorX<Quad> lambda;   ///< m
  VectorX<Quad> nu;       ///< n, or empty: M⁻¹Jᵀλ
};

/// Relative errors of an answer.
struct Errors {
  double lambda = 0;    ///< max|δλ| / max|λ|
  double motion = 0;    ///< ‖δν‖_M / ‖ν‖_M
  double energy = 0;    ///< √(‖δν‖²_M + ‖δλ‖²_{R⁻¹}) / √(λᵀa), what error_bound bounds; without ν: ‖δλ‖_{R⁻¹} alone
  double backward = 0;  ///< ‖a − A λ‖ / (‖A‖ ‖λ‖ + ‖a‖), 2-norms
};

/// λ = A⁻¹ a and ν = M⁻¹Jᵀλ of the very numbers of a problem, in Quad. Found by lcaba_refined in Quad and certified by
/// its bound; with hard rows by the definition. Where Quad is not enough, or a row is hard and A large or singular,
/// `known` is false.
class Truth {
 public:
  static constexpr double worst_bound = 1e-20;   ///< of the reference itself

  /// Shapes: a m. Cost: that of lcaba_refined in Quad. @throws std::runtime_error when M is singular.
  Truth(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a);
  ~Truth();

  [[nodiscard]] bool known() const { return why_not_.empty(); }
  [[nodiscard]] const std::string& why_not() const { return why_not_; }
  [[nodiscard]] Errors errors_of(const Answer& answer) const;
  /// Bound on the reference's own error, relative, in the energy norm; −1 for the definition, which has none.
  [[nodiscard]] double bound() const { return bound_; }
  /// λmax(J M⁻¹Jᵀ) [1/kg], a few per cent low at most (power iteration).
  [[nodiscard]] double largest_eigenvalue() const { return largest_; }
  /// κ_∞(A), beyond the size of the definition κ₂(A) by power and inverse iteration (a few per cent low); NaN where A is singular.
  /// max|δλ|/max|λ| of the reference against the definition; NaN where there is none.
  [[nodiscard]] double condition() const { return condition_; }
  [[nodiscard]] double disagreement() const { return disagreement_; }

 private:
  struct System;
  void solve();
  void compare_with_definition(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a);
  [[nodiscard]] Quad motion_energy(const VectorX<Quad>& lambda, const VectorX<Quad>& nu) const;

  std::unique_ptr<System> system_;
  VectorX<Quad> a_;
  Answer answer_;
  double bound_ = -1, largest_ = 0, condition_ = 0, disagreement_ = 0;
  std::string why_not_;
};

/// a = J ν in double (rounded once), with entries of ν uniform in [−0.1, 0.1]: an acceleration the constraints can have.
[[nodiscard]] VectorX<double> consistent_acceleration(const Problem<double>& problem, std::uint64_t seed);
/// Entries uniform in [−1, 1].
[[nodiscard]] VectorX<double> random_acceleration(Index rows, std::uint64_t seed);

}  // namespace delassus::accuracy
