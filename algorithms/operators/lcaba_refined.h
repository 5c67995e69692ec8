// lcaba_refined: lcaba with adaptive refinement on the KKT residual, and a certificate. The first rung of the default (ladder.h).
//
// What     f = Λ_R a to full accuracy wherever eps · R λmax(Λ⁻¹) < 1, with a rigorous error bound.
// Formula  (K) of refinement.h by the inversion lemma:  M_R δν = r₁ + JᵀR r₂,  δλ = R (r₂ − J δν).
// Steps    one leaves c eps · R λmax(Λ⁻¹) of the error, of which c = 280 was seen (five bodies): four bits
//          a step where R λmax(Λ⁻¹) < 2⁻¹³/eps, and 53 bits in twelve.
// Singular as lcaba. Refinement that has not reached its target after max_steps is reported as not_converged.
// How      the factor of lcaba; the loop and the certificate of refinement.h.
// Cost     update: lcaba, and the factor of M at the first solve that asks for a certificate; solve: lcaba + (k + 1) residuals + k sweeps; k = 1 mostly.
// Workspace  that of lcaba + refinement's; eight times as much from four columns on, which go in lanes.
// Error    refined: within the data's own sensitivity, or eps of the largest force and eps in the energy norm.
// Source   paper, Algorithm 4; refinement.h.
#pragma once

#include "algorithms/operators/refined.h"

namespace delassus {

template <class T> class LcabaRefined : public Refined<T> {
 public:
  static constexpr int max_steps = 12;  // four bits a step and more

  /// One column, as solve; nu, when given, receives ν = M⁻¹Jᵀf (n), which keeps its digits where J^T f cancels.
  Report solve_with_motion(const T* a, T* f, T* nu, Accuracy wanted, T* work) const { return solve_pair({.r2 = a}, f, nu, wanted, work); }
  bool solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const override;
  /// What update was given; `to` has the structure and the sizes.
  void numbers(Problem<T>& to) const { refinement_.numbers(to); }
  /// zero_damping where the last R⁻¹ has no inverse.
  [[nodiscard]] const Report& invertible() const { return refinement_.invertible(); }

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  template <class X> void correct(const X* r1, const X* r2, X* d_nu, X* d_lambda, X* work) const;

  Plan plan_;
  Factor<T> factor_;
  Refinement<T> refinement_;
  Report undamped_, factored_;
};

}  // namespace delassus
