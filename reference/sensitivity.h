// The named bounds of the verdict error / (eps · bound) < 30: what an error of one unit roundoff may come to.
//
// Every bound is a vector of m non-negative numbers, one per row, in the unit of the row it bounds. Absolute values
// are taken entry by entry. With
//   J_abs = Σ |K_e^i||S_k| (and |𝒦_i|) over paths,
//   M_bound_kl = (d_k d'_l + d'_k d_l)/2 for joints on one path, 0 otherwise;  d_k² = Σ_i (|S_k|ᵀ h_i)² + armature_k,  h_i = √diag H_i
// a relative change of at most ε in every number of S, K, 𝒦, H, armature, R⁻¹ (a number may change differently on
// every path it is used on) changes J by |δJ| ≤ 2ε J_abs, and M by |δM| ≤ 3ε M_bound, to first order; and a factor
// M = L D Lᵀ in rounded arithmetic, by joints or by bodies, is exact for some M + δM with |δM| ≤ c ε |L||D||Lᵀ| ≤ c ε M_bound
// (Higham, section 10.1). d' = Cᵀd, C_i = |L⁻ᵀ||Lᵀ| of D_i = L diag Lᵀ: a joint is eliminated in the basis L⁻ᵀ of its degrees of
// freedom (factor.h), which is far from orthogonal where a weak one comes before a strong one; C = 1 for one. Factors: the 30.
// apply    y = J M⁻¹ Jᵀ x + R⁻¹ x gives   δy = δJ M⁻¹Jᵀx + J M⁻¹ δJᵀ x − J M⁻¹ δM M⁻¹ Jᵀ x + δR⁻¹ x, hence
//            apply_sensitivity(x) = J_abs (C|M⁻¹| + |M⁻¹|Cᵀ)/2 J_absᵀ|x| + J_abs|M⁻¹|M_bound|M⁻¹|J_absᵀ|x| + |R⁻¹||x|
//          and ε J_abs|M⁻¹|M_bound|M⁻¹|M_bound|M⁻¹|J_absᵀ|x|, of second order: it counts where the others are zero because both
//          couplings of two branches to the joint between them happen to cancel exactly, which rounding does not see.
// mobile   A_rs = Σ κ_r Ω κ_s over pairs of bodies, each mobility Ω_l = G_l M⁻¹G_lᵀ (G_l: S on the path of l) on its own. What bodies of
//          one row have in common is not there in J, but cancels here, and so does what a joint lets go in Ω_l − Pᵀ… of large numbers:
//            apply_mobile(x)_r = ω_r Σ_s ω_s |x_s|,   ω_r = Σ_{i∈r} max_{l on the path of i} √( yᵀ|Ω|_l y ),
//          |Ω|_l = |G_l| C|M⁻¹|Cᵀ |G_l|ᵀ; y = (1 + |U D⁻¹||Sᵀ|)|κ|, κ carried in exactly to the body before l, from K; of a row 𝒦 on joint i, κ = 𝒦 D⁻¹U_iᵀ on π(i), and √(|𝒦||D⁻¹||𝒦|) beside it, with the articulated inertia of i.
// solve    A λ = a gives δλ = A⁻¹ (δa − δA λ), hence
//            solve_sensitivity(a, λ) = |A⁻¹| ( apply_sensitivity(λ) + |a| ).
// normwise an explicit A factored by a method that is backward stable in norm only, ‖δA‖ ≤ ε‖A‖:
//            solve_normwise(a, λ) = ‖A⁻¹‖ ( ‖A‖ ‖λ‖ + ‖apply_sensitivity(λ)‖ + ‖a‖ ),  ∞-norms, the same on every row;
//          of an A formed by mobilities also  solve_normwise_mobile(λ) = ‖A⁻¹‖ ‖apply_mobile(λ)‖.
// refined  refinement of the numbers as given, with residuals in twice the digits, ends when the correction is below ε of the
//          largest force and below ε in the energy norm ‖ν‖²_M + ‖λ‖²_{R⁻¹} = λᵀa, in which |λ_r| ≤ √R_rr ‖·‖:
//            solve_refined(a, λ) = min( max|λ|, √R_rr √(λᵀa) ) + ε solve_sensitivity(a, λ).
//          Where R⁻¹ is singular the size of a correction is the only sign of the error: it ends when one is below 4 ε
//          itself, and the energy norm bounds no row, hence
//            solve_refined(a, λ) = max|λ| + ε solve_sensitivity(a, λ).
// mobile   of Λ_R = R − R J M_R⁻¹Jᵀ R, the mobilities of M_R below those of M:  solve_mobile(a) = |R| apply_mobile(|R||a|).
// direct   the inversion-lemma formula λ = R a − R J ν with ν = M_R⁻¹ Jᵀ R a, M_R = M + Jᵀ R J, evaluated as it stands.
//          Errors: of R a and of the difference, |R||a|; of J ν, J_abs|ν|; of ν, from M_R δν = δ(JᵀRa) − δM_R ν:
//            solve_amplified(a) = |R| ( |a| + J_abs|ν|
//                                      + J_abs|M_R⁻¹| ( M_R_bound |ν| + J_absᵀ|R||a| ) ),
//          M_R_bound_kl = D_k D_l for joints coupled by M or by a chain of constraints;  D_k² = d_k² + (J_absᵀ|R|J_abs)_kk.
//          Against λ it grows as R·λmax(J M⁻¹ Jᵀ).
//
// M⁻¹, M_R⁻¹, A⁻¹, R, ν come from Quad and are rounded once to double; the sums that follow have non-negative terms
// only, so they are low by a relative (n + m) 2⁻⁵³ at most. A bound is zero only where no data enters the row.
#pragma once

#include <memory>

#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"

namespace delassus::reference {

class Sensitivity {
 public:
  /// Forms M, J, A and |M⁻¹| in Quad: cost of `dense` and n³. @throws std::runtime_error when M is singular.
  Sensitivity(const Problem<double>& problem, const Damping<double>& damping);
  ~Sensitivity();
  Sensitivity(Sensitivity&&) noexcept;
  Sensitivity& operator=(Sensitivity&&) noexcept;

  [[nodiscard]] Index rows() const;
  /// Bound on the error of A x. Shapes m. Cost n² + n m.
  [[nodiscard]] VectorX<double> apply_sensitivity(const VectorX<double>& x) const;

  /// What is added where A is formed by mobilities of bodies. Shapes m. The first call costs n³ in Quad (not safe to make from two
  /// threads at once).
  [[nodiscard]] VectorX<double> apply_mobile(const VectorX<double>& x) const;

  // The bounds of solve: the first call costs m³ in Quad (not safe to make from two threads at once).
  /// A has no lost pivot in Quad; the three functions that need A⁻¹ throw std::runtime_error when it is not regular.
  [[nodiscard]] bool regular() const;
  /// λ = A⁻¹ a in Quad. Shapes m.
  [[nodiscard]] VectorX<Quad> solve(const VectorX<double>& a) const;
  /// Bound on the error of λ = A⁻¹ a from the data alone. Shapes m.
  [[nodiscard]] VectorX<double> solve_sensitivity(const VectorX<double>& a, const VectorX<double>& lambda) const;
  /// Bound on the error of λ in the sense of norms. Shapes m, all entries equal.
  [[nodiscard]] VectorX<double> solve_normwise(const VectorX<double>& a, const VectorX<double>& lambda) const;
  /// What is added where that A is formed by mobilities of bodies. Shapes m, all entries equal.
  [[nodiscard]] VectorX<double> solve_normwise_mobile(const VectorX<double>& lambda) const;
  /// Bound on the error of a refined solution in double. Shapes m.
  [[nodiscard]] VectorX<double> solve_refined(const VectorX<double>& a, const VectorX<double>& lambda) const;
  /// Bound on the error of the direct inversion-lemma formula. Needs R⁻¹ > 0, not A⁻¹. @throws std::runtime_error when
  /// a row or a block of R⁻¹ is singular. The first call costs n² m + n³ in Quad.
  [[nodiscard]] VectorX<double> solve_amplified(const VectorX<double>& a) const;
  /// What is added where Λ_R is formed by mobilities of bodies. Shapes m. Needs R⁻¹ > 0. Cost as apply_mobile and solve_amplified.
  [[nodiscard]] VectorX<double> solve_mobile(const VectorX<double>& a) const;
  /// κ_∞(A) = ‖A‖ ‖A⁻¹‖.
  [[nodiscard]] double condition() const;
  /// The matrices the bounds are made of.
  [[nodiscard]] const Dense<Quad>& matrices() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace delassus::reference
