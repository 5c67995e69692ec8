#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/lcaba_qr.h"

namespace delassus {

template <class T> void LcabaQr<T>::do_analyze() {
  factor_.analyze(*this->structure());
  refinement_.analyze(this->structure(), Refinement<T>::Mass::factored_elsewhere);
}

template <class T> Report LcabaQr<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update(problem);
  refinement_.update_damping(damping);
  return factored_ = factor_.update(problem, damping);
}

template <class T> Report LcabaQr<T>::do_update_damping(const Damping<T>& damping) {
  refinement_.update_damping(damping);
  return factored_ = factor_.update_weights(damping);
}

template <class T>
Report LcabaQr<T>::solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const {
  if (!factored_.ok()) return factored_;
  const auto correct = [this](auto... arguments) { factor_.solve_kkt(arguments...); };
  const auto energy = [this](const T* tau, T* rest) { return factor_.mass().energy(tau, rest); };
  return refinement_.solve_with(asked, f, wanted, {max_steps}, correct, energy, work, nu);
}

template <class T> Index LcabaQr<T>::do_workspace(Index) const { return refinement_.workspace(factor_.workspace()); }

template <class T> Index LcabaQr<T>::do_bytes() const { return factor_.bytes() + refinement_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class LcabaQr<T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
