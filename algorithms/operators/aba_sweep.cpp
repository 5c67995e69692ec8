#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/aba_sweep.h"

namespace delassus {

template <class T> void AbaSweep<T>::do_analyze() {
  plan_ = make_plan(*this->structure(), Matrix::M);
  factor_.analyze(*this->structure(), plan_);
  damping_.analyze(*this->structure());
}

template <class T> Report AbaSweep<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  damping_.assign(damping);
  factored_ = factor_.start(problem);
  if (factored_.ok()) factored_ = factor_.update_undamped();
  return factored_;
}

template <class T> Report AbaSweep<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  factor_.move_rows(problem);
  return do_update_damping(damping);
}

template <class T> Report AbaSweep<T>::do_update_damping(const Damping<T>& damping) {
  damping_.assign(damping);
  return factored_;
}

template <class T> Report AbaSweep<T>::do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const {
  if (!factored_.ok()) return factored_;
  for_columns<T>(f, a, workspace, [this](const auto* x, auto* y, auto* work) { delassus_product(factor_, damping_, this->size(), x, y, work); });
  return {};
}

template <class T> Index AbaSweep<T>::do_workspace(Index columns) const {
  return columns_workspace<T>(this->size(), factor_.workspace() + padded(this->size()), columns);
}

template <class T> Index AbaSweep<T>::do_bytes() const { return plan_.bytes() + factor_.bytes() + damping_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class AbaSweep<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
