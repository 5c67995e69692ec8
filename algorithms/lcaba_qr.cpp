#include "algorithms/lcaba_qr.h"

#include <algorithm>

#include "algorithms/columns.h"

namespace delassus {

template <class T> void LcabaQr<T>::do_analyze() {
  factor_.analyze(*this->structure());
  residual_.analyze(this->structure());
}

template <class T> Report LcabaQr<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  residual_.update(problem);
  residual_.update_damping(damping);
  return factored_ = factor_.update(problem, damping);
}

template <class T> Report LcabaQr<T>::do_update_damping(const Damping<T>& damping) {
  residual_.update_damping(damping);
  return factored_ = factor_.update_weights(damping);
}

template <class T> void LcabaQr<T>::solve_column(const T* a, T* f, T* work) const {
  using W = Wide<T>;
  constexpr Index wide = static_cast<Index>(sizeof(W) / sizeof(T));
  const Index n = this->structure()->dofs(), m = this->size();
  W* const nu = reinterpret_cast<W*>(work);
  W* const lambda = reinterpret_cast<W*>(work += wide * padded(n));
  T* const d_nu = work += wide * padded(m);
  T* const r1 = d_nu + padded(n);
  T* const d_lambda = r1 + padded(n);
  T* const r2 = d_lambda + padded(m);
  T* const rest = r2 + padded(m);

  factor_.solve_kkt(nullptr, a, d_nu, d_lambda, rest);
  for (Index c = 0; c < n; ++c) nu[c] = W(d_nu[c]);
  for (Index r = 0; r < m; ++r) lambda[r] = W(d_lambda[r]);
  residual_.evaluate(nu, lambda, a, r1, r2, rest);
  factor_.solve_kkt(r1, r2, d_nu, d_lambda, rest);
  for (Index r = 0; r < m; ++r) f[r] = narrow<T>(lambda[r] + W(d_lambda[r]));
}

template <class T> Report LcabaQr<T>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  if (!factored_.ok()) return factored_;
  for (Index c = 0; c < a.cols(); ++c)
    solve_column(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(), workspace);
  Report report;
  report.iterations = 1;
  return report;
}

template <class T> Index LcabaQr<T>::do_workspace(Index) const {
  constexpr Index wide = static_cast<Index>(sizeof(Wide<T>) / sizeof(T));
  const Index n = padded(this->structure()->dofs()), m = padded(this->size());
  return (wide + 2) * (n + m) + std::max(factor_.workspace(), residual_.workspace());
}

template <class T> Index LcabaQr<T>::do_bytes() const { return factor_.bytes() + residual_.bytes(); }

template class LcabaQr<double>;
template class LcabaQr<float>;
template class LcabaQr<Quad>;
template class LcabaQr<Counted>;

}  // namespace delassus
