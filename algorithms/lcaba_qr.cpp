#include "algorithms/lcaba_qr.h"

namespace delassus {

template <class T> void LcabaQr<T>::do_analyze() {
  factor_.analyze(*this->structure());
  refinement_.analyze(this->structure());
}

template <class T> Report LcabaQr<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  factored_M_ = refinement_.update(problem);
  refinement_.update_damping(damping);
  factored_ = factor_.update(problem, damping);
  return factored_ = factored_M_.ok() ? factored_ : factored_M_;
}

template <class T> Report LcabaQr<T>::do_update_damping(const Damping<T>& damping) {
  refinement_.update_damping(damping);
  factored_ = factor_.update_weights(damping);
  return factored_ = factored_M_.ok() ? factored_ : factored_M_;
}

template <class T> Report LcabaQr<T>::do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* workspace) const {
  if (!factored_.ok()) return factored_;
  Report worst;
  for (Index c = 0; c < a.cols(); ++c) {
    bool first = true;  // r₁ is zero
    const auto correct = [&](const T* r1, const T* r2, T* d_nu, T* d_lambda, T* work) {
      factor_.solve_kkt(first ? nullptr : r1, r2, d_nu, d_lambda, work);
      first = false;
    };
    worst = worse(worst, refinement_.solve(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(),
                                           wanted, {max_steps}, correct, workspace));
  }
  return worst;
}

template <class T> Index LcabaQr<T>::do_workspace(Index) const { return refinement_.workspace(factor_.workspace()); }

template <class T> Index LcabaQr<T>::do_bytes() const { return factor_.bytes() + refinement_.bytes(); }

template class LcabaQr<double>;
template class LcabaQr<float>;
template class LcabaQr<Quad>;
template class LcabaQr<Counted>;

}  // namespace delassus
