#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/lcaba_refined.h"

namespace delassus {

template <class T> void LcabaRefined<T>::do_analyze() {
  plan_ = make_plan(*this->structure(), Matrix::M_R);
  factor_.analyze(*this->structure(), plan_);
  refinement_.analyze(this->structure(), plan_, factor_);
}

template <class T> Report LcabaRefined<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = factor_.start(problem);
  refinement_.update(problem);
  return do_update_damping(damping);
}

template <class T> Report LcabaRefined<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  factor_.move_rows(problem);
  refinement_.update_rows(problem);
  return do_update_damping(damping);
}

template <class T> Report LcabaRefined<T>::do_update_damping(const Damping<T>& damping) {
  refinement_.update_damping(damping);
  factored_ = undamped_;
  if (factored_.ok()) factored_ = refinement_.invertible();
  if (factored_.ok()) factored_ = factor_.update_weights(refinement_.weights());
  return factored_;
}

// M_R δν = r₁ + JᵀR r₂;  δλ = R (r₂ − J δν)
template <class T>
template <class X>
void LcabaRefined<T>::correct(const X* r1, const X* r2, X* d_nu, X* d_lambda, X* work) const {
  X* const rate = work + factor_.solve_workspace();
  refinement_.weights().multiply(r2, d_lambda);
  factor_.solve(d_lambda, r1, rate, d_nu, work);
  for (Index r = 0; r < this->size(); ++r) rate[r] = r2[r] - rate[r];
  refinement_.weights().multiply(rate, d_lambda);
}

template <class T>
Report LcabaRefined<T>::solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const {
  if (!factored_.ok()) return factored_;
  return refinement_.solve(asked, f, wanted, {max_steps}, [this](auto... arguments) { this->correct(arguments...); }, work, nu);
}

template <class T>
bool LcabaRefined<T>::solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const {
  if (!factored_.ok()) return false;
  return this->in_lanes(refinement_, a, f, wanted, {max_steps}, [this](auto... arguments) { this->correct(arguments...); }, reports, workspace);
}

template <class T> Index LcabaRefined<T>::do_workspace(Index columns) const {
  return this->workspace_of(columns, refinement_.workspace(factor_.solve_workspace() + padded(this->size())));
}

template <class T> Index LcabaRefined<T>::do_bytes() const { return plan_.bytes() + factor_.bytes() + refinement_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class LcabaRefined<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
