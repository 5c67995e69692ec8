#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/lcaba.h"

namespace delassus {

template <class T> void Lcaba<T>::do_analyze() {
  plan_ = make_plan(*this->structure(), Matrix::M_R);
  factor_.analyze(*this->structure(), plan_);
  weights_.analyze(*this->structure());
}

template <class T> Report Lcaba<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = factor_.start(problem);
  return do_update_damping(damping);
}

template <class T> Report Lcaba<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  factor_.move_rows(problem);
  return do_update_damping(damping);
}

template <class T> Report Lcaba<T>::do_update_damping(const Damping<T>& damping) {
  factored_ = undamped_;
  if (factored_.ok()) factored_ = weights_.assign_inverse(damping);
  if (factored_.ok()) factored_ = factor_.update_weights(weights_);
  return factored_;
}

template <class T> Report Lcaba<T>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  const Index m = this->size();
  if (!factored_.ok()) return factored_;
  for_columns<T>(a, f, workspace, [&](const auto* x, auto* y, auto* work) {
    auto* const compliant = work + factor_.workspace();
    auto* const motion = compliant + padded(m);
    weights_.multiply(x, compliant);              // λ_R = R a
    factor_.project(compliant, motion, work);     // a_R = J M_R⁻¹ Jᵀ λ_R
    weights_.multiply(motion, y);                 // λ = λ_R − R a_R
    for (Index r = 0; r < m; ++r) y[r] = compliant[r] - y[r];
  });
  return {};
}

// M_R ν = r₁ + JᵀR r₂;  λ = R (r₂ − J ν)
template <class T>
Report Lcaba<T>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy, Start, T* workspace) const {
  if (!factored_.ok()) return factored_;
  T* const rate = workspace + factor_.solve_workspace();
  weights_.multiply(r2, lambda);
  factor_.solve(lambda, r1, rate, nu, workspace);
  for (Index r = 0; r < this->size(); ++r) rate[r] = r2[r] - rate[r];
  weights_.multiply(rate, lambda);
  return {};
}

template <class T> Index Lcaba<T>::do_workspace(Index columns) const {
  return columns_workspace<T>(this->size(), factor_.workspace() + 2 * padded(this->size()), columns);
}

template <class T> Index Lcaba<T>::do_bytes() const { return plan_.bytes() + factor_.bytes() + weights_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class Lcaba<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
