#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/proximal.h"

namespace delassus {

template <class T, class F> void ProximalWith<T, F>::do_analyze() {
  refinement_.analyze(this->structure());
  inverse_.analyze(*this->structure());
}

template <class T, class F> Report ProximalWith<T, F>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update(problem);
  return take_rows(problem, damping);
}

template <class T, class F> Report ProximalWith<T, F>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update_rows(problem);
  return take_rows(problem, damping);
}

template <class T, class F> Report ProximalWith<T, F>::take_rows(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = refinement_.factor_mass();
  if (undamped_.ok()) undamped_ = inverse_.update(problem, refinement_.factor_M());
  return do_update_damping(damping);
}

template <class T, class F> Report ProximalWith<T, F>::do_update_damping(const Damping<T>& damping) {
  refinement_.update_damping(damping);
  return factored_ = undamped_.ok() ? inverse_.update_damping(damping) : undamped_;
}

template <class T, class F>
Report ProximalWith<T, F>::solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const {
  if (!factored_.ok()) return factored_;
  return refinement_.solve(asked, f, wanted, {max_steps, true}, [this](auto... args) { inverse_.solve_kkt(args...); }, work, nu);
}

template <class T, class F>
bool ProximalWith<T, F>::solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const {
  if (!factored_.ok()) return false;
  return this->in_lanes(refinement_, a, f, wanted, {max_steps, true}, [this](auto... args) { inverse_.solve_kkt(args...); }, reports, workspace);
}

template <class T, class F> Index ProximalWith<T, F>::do_workspace(Index columns) const {
  return this->workspace_of(columns, refinement_.workspace(inverse_.workspace()));
}

template <class T, class F> Index ProximalWith<T, F>::do_bytes() const { return refinement_.bytes() + inverse_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class ProximalWith<T, T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE
#ifndef DELASSUS_EXACT
template class ProximalWith<double, float>;
#endif

}  // namespace delassus
