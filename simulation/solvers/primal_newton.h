// Newton's method on the motion: what newton_convex is, and what proximal does inside.
//
//   min over w  ½ wᵀM w + Σ_c ℓ_c(u_c),   u = J w + b,   ℓ_c(u) = −min over λ ∈ K_c of ½ λᵀR⁻¹λ + λᵀu
//   w is the motion of λ − λ₀: λ₀ = 0, or impulses whose motion b holds already, and what is rounded is of the size of a change
//   λ_c(u) = Π in the metric R⁻¹ of −R u:  λ = R^½ Π̂(−R^½ u), Π̂ on the cone with coefficients μ_i (R_n/R_i)^½ … ; −∇ℓ_c = λ_c
//   gradient  M w − Jᵀ(λ(u) − λ₀)
//   Hessian   M + JᵀH J,  H_c = R^½ Π̂' R^½ ≥ 0, 3 × 3 for a contact, 0 where it is open
//   step      d = (M + JᵀH J)⁻¹ (Jᵀ(λ − λ₀) − M w): the factor of lcaba with H as weights. Only H changes: update_weights.
//   length    the zero of φ'(α) = dᵀM (w + α d) − (J d)ᵀ (λ(u + α J d) − λ₀), which increases: Newton within a bracket, O(m) each,
//             until |φ'(α)| ≤ flat_enough |φ'(0)|; φ''(α), and with it H, only where α is not it. What an exact zero would gain, the next
//             step's H gains better: as many steps, and most of them with one λ(u)
// Cost     O(n + m) an iteration with local loops. Nothing allocates after analyze.
// Source   E. Todorov 2014 (MuJoCo); A. Castro, F. Permenter, X. Han 2022 (SAP). The factor: paper, Algorithm 4.
#pragma once

#include <memory>

#include "algorithms/dynamics/tree_operators.h"
#include "algorithms/factors/factor.h"
#include "algorithms/operators/operator.h"
#include "simulation/cones.h"

namespace delassus::simulation {

template <class T> class PrimalNewton {
 public:
  static constexpr double flat_enough = 0.1;  ///< of the slope along a step, what is left at its end
  /// Why the rows cannot be taken, or "": the rows of a Coulomb group must be rows of one constraint.
  [[nodiscard]] static std::string refusal(const ContactProblem<T>& p);
  void analyze(const ContactProblem<T>& p);
  /// Numbers of the mechanism, which `tree` has taken and keeps; w and λ₀ are set to zero.
  [[nodiscard]] Report start(const ContactProblem<T>& p, TreeOperators<T>& tree);
  /// w = M⁻¹Jᵀλ: where a warm start begins.
  [[nodiscard]] Report begin_at(const VectorX<T>& lambda);

  /// λ₀ = λ: the b of minimise has the motion of λ in it. w: a step of Newton from u = −R⁻¹x, the cones where x is in them.
  [[nodiscard]] Report begin_from(const VectorX<T>& lambda, const VectorX<T>& x, const VectorX<T>& R_inverse, const VectorX<T>& b);

  struct Outcome {
    Report report;
    int iterations = 0;
  };
  /// Minimises with R⁻¹ > 0 (m) and b (m) from the w it holds, until λ after a whole step is what H said, to `velocity` [m/s] in R⁻¹λ of every
  /// row or to rounding, or a step moves no row.
  Outcome minimise(const VectorX<T>& R_inverse, const VectorX<T>& b, double velocity, int iterations, VectorX<T>& lambda);
  /// Duality gap at w and the λ of minimise [J]; −1: M is singular.
  [[nodiscard]] double gap(const VectorX<T>& lambda);
  [[nodiscard]] const VectorX<T>& motion() const { return w_; }  ///< w, shape n

  // How λ answers a small change of b, after minimise.
  /// H and the factor of M + JᵀHJ at the λ it left.
  [[nodiscard]] Report linearise(const VectorX<T>& R_inverse, const VectorX<T>& lambda);
  /// J (M + JᵀHJ)⁻¹ Jᵀ x.
  void respond(const VectorX<T>& x, VectorX<T>& Jd);
  /// y = H x.
  void multiply_hessian(const VectorX<T>& x, VectorX<T>& y) const;
  /// Whether λ of a Coulomb group is inside its cone.
  [[nodiscard]] bool sticks(std::size_t group) const { return projected_[group].region == Region::inside; }

  /// Whether it is on the boundary of its cone.
  [[nodiscard]] bool slides(std::size_t group) const { return projected_[group].region == Region::boundary; }

  // One step taken apart, for tests of the Hessian.
  /// λ(u) with its blocks H in hessian().
  void evaluate(const VectorX<T>& R_inverse, const VectorX<T>& u, VectorX<T>& lambda);
  [[nodiscard]] const Damping<T>& hessian() const { return H_; }
  /// d = (M + JᵀHJ)⁻¹ (Jᵀ(λ − λ₀) − M w) and J d.
  [[nodiscard]] Report direction(const VectorX<T>& lambda, VectorX<T>& d, VectorX<T>& Jd);

 private:
  void take(const VectorX<T>& R_inverse);
  void impulses(const VectorX<T>& R_inverse, const VectorX<T>& u, VectorX<T>& lambda);
  void curve(const VectorX<T>& R_inverse, const VectorX<T>& u, const VectorX<T>& lambda);
  Report factor_hessian();
  T length(const VectorX<T>& R_inverse);
  bool is_expected(const VectorX<T>& R_inverse, const VectorX<T>& b, const VectorX<T>& lambda, double velocity) const;
  const ContactProblem<T>* problem_ = nullptr;
  Plan plan_;
  Factor<T> factor_;
  BlockDiagonal<T> weights_;
  TreeOperators<T>* tree_ = nullptr;
  std::unique_ptr<Workspace<T>> work_;
  Damping<T> H_;
  std::vector<std::size_t> block_of_;           // per group
  std::vector<ConeProjection<T>> projected_;    // per group, of the last λ(u)
  VectorX<T> root_, mu_, scaled_;               // of Coulomb rows: R^½, coefficients in the metric R⁻¹, Π̂
  VectorX<T> w_, Mw_, d_, Md_, u_, Jd_, HJd_, expected_, moved_, trial_, tau_, origin_, gained_;
  bool expects_ = false;  // w, u and expected_ are those of begin_from
};

}  // namespace delassus::simulation
