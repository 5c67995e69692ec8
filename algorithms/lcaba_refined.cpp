#include "algorithms/lcaba_refined.h"

#include <algorithm>
#include <cmath>

#include "algorithms/columns.h"

namespace delassus {

// Layout of one column's vectors: Wide ones first, so that everything stays aligned.
template <class T> struct LcabaRefined<T>::Buffers {
  Index n, m;
  const T* a;
  W *nu, *lambda;
  T *d_nu, *r1, *d_lambda, *r2, *y, *scratch;  // n, n, m, m, m, m
  T* rest;

  Buffers(Index dofs, Index rows, const T* rhs, T* work) : n(dofs), m(rows), a(rhs) {
    constexpr Index wide = static_cast<Index>(sizeof(W) / sizeof(T));
    nu = reinterpret_cast<W*>(work);
    lambda = reinterpret_cast<W*>(work += wide * padded(n));
    d_nu = work += wide * padded(m);
    r1 = work += padded(n);
    d_lambda = work += padded(n);
    r2 = work += padded(m);
    y = work += padded(m);
    scratch = work += padded(m);
    rest = work + padded(m);
  }
  static Index size(Index n, Index m) {
    constexpr Index wide = static_cast<Index>(sizeof(W) / sizeof(T));
    return (wide + 2) * padded(n) + (wide + 4) * padded(m);
  }
};

template <class T> void LcabaRefined<T>::do_analyze() {
  const Structure& s = *this->structure();
  plan_ = make_plan(s, Matrix::M_R, Branches::all);
  plan_M_ = make_plan(s, Matrix::M, Branches::all);
  factor_.analyze(s, plan_);
  factor_M_.analyze(s, plan_M_);
  weights_.analyze(s);
  residual_.analyze(this->structure());
}

template <class T> Report LcabaRefined<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  residual_.update(problem);
  undamped_ = factor_.start(problem);
  factored_M_ = factor_M_.start(problem);
  if (factored_M_.ok()) factored_M_ = factor_M_.update_undamped();
  return do_update_damping(damping);
}

template <class T> Report LcabaRefined<T>::do_update_damping(const Damping<T>& damping) {
  residual_.update_damping(damping);
  factored_ = undamped_.ok() ? factored_M_ : undamped_;
  if (factored_.ok()) factored_ = weights_.assign_inverse(damping);
  if (factored_.ok()) factored_ = factor_.update_weights(weights_);
  return factored_;
}

namespace {
template <class X> double magnitude(const X* x, Index size) {
  double largest = 0;
  for (Index i = 0; i < size; ++i) {
    const double v = std::abs(static_cast<double>(x[i]));
    if (!(v <= largest)) largest = v;  // keeps a NaN
  }
  return largest;
}
}  // namespace

// M_R δν = r₁ + JᵀR r₂;  δλ = R (r₂ − J δν);  ν += δν, λ += δλ
template <class T> double LcabaRefined<T>::correct(Buffers& b, T* workspace) const {
  weights_.multiply(b.r2, b.scratch);
  const T energy = factor_.solve(b.scratch, b.r1, b.y, b.d_nu, workspace);  // ‖δν‖² in the norm of M_R
  for (Index r = 0; r < b.m; ++r) b.y[r] = b.r2[r] - b.y[r];
  weights_.multiply(b.y, b.d_lambda);
  for (Index r = 0; r < b.m; ++r) b.lambda[r] += W(b.d_lambda[r]);
  for (Index c = 0; c < b.n; ++c) b.nu[c] += W(b.d_nu[c]);
  const double lambda = magnitude(b.lambda, b.m), change = magnitude(b.d_lambda, b.m);
  const double motion = std::sqrt(std::abs(static_cast<double>(energy))) / energy_norm(b);
  return std::max(change == 0 ? 0 : change / lambda, energy == T(0) ? 0 : motion);
}

// √(λᵀa) = √(‖ν‖²_M + ‖λ‖²_{R⁻¹}) at the solution
template <class T> double LcabaRefined<T>::energy_norm(const Buffers& b) const {
  T energy(0);
  for (Index r = 0; r < b.m; ++r) energy += narrow<T>(b.lambda[r]) * b.a[r];
  return std::sqrt(std::abs(static_cast<double>(energy)));
}

// B² = r₁ᵀM⁻¹r₁ + r₂ᵀR r₂, relative to ‖ν‖²_M + ‖λ‖²_{R⁻¹} = λᵀa
template <class T> double LcabaRefined<T>::certify(Buffers& b, T* workspace) const {
  for (Index r = 0; r < b.m; ++r) b.scratch[r] = T(0);
  T squared = factor_M_.solve(b.scratch, b.r1, b.y, nullptr, workspace);
  weights_.multiply(b.r2, b.scratch);
  for (Index r = 0; r < b.m; ++r) squared += b.r2[r] * b.scratch[r];
  const double bound = std::sqrt(std::abs(static_cast<double>(squared)));
  return bound == 0 ? 0 : bound / energy_norm(b);
}

template <class T> Report LcabaRefined<T>::solve_column(const T* a, T* f, T* workspace) const {
  Buffers b(this->structure()->dofs(), this->size(), a, workspace);
  for (Index c = 0; c < b.n; ++c) b.nu[c] = W(T(0));
  for (Index r = 0; r < b.m; ++r) {
    b.lambda[r] = W(T(0));
    b.r2[r] = a[r];
  }
  for (Index c = 0; c < b.n; ++c) b.r1[c] = T(0);
  correct(b, b.rest);  // the direct formula is the first correction, from zero

  Report report;
  double before = 1, expected = 1;  // size of the last correction; the error expected to be left
  while (true) {
    residual_.evaluate(b.nu, b.lambda, a, b.r1, b.r2, b.rest);
    if (expected <= unit_roundoff<T>) break;
    if (report.iterations == max_steps) {
      report.status = Status::not_converged;
      break;
    }
    const double size = correct(b, b.rest);
    ++report.iterations;
    report.error_estimate = size;
    expected = std::min(size * (size / before), size <= 4 * unit_roundoff<T> ? 0.0 : 1.0);
    before = size;
    if (!std::isfinite(size)) {
      report.status = Status::not_finite;
      break;
    }
  }
  report.error_bound = certify(b, b.rest);
  for (Index r = 0; r < b.m; ++r) f[r] = narrow<T>(b.lambda[r]);
  return report;
}

template <class T> Report LcabaRefined<T>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  if (!factored_.ok()) return factored_;
  Report worst;
  for (Index c = 0; c < a.cols(); ++c) {
    const Report r = solve_column(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(), workspace);
    worst.iterations = std::max(worst.iterations, r.iterations);
    worst.error_bound = std::max(worst.error_bound, r.error_bound);
    worst.error_estimate = std::max(worst.error_estimate, r.error_estimate);
    if (!r.ok()) worst.status = r.status;
  }
  return worst;
}

template <class T> Index LcabaRefined<T>::do_workspace(Index) const {
  const Structure& s = *this->structure();
  return Buffers::size(s.dofs(), s.rows) + std::max(factor_.workspace(), residual_.workspace()) + padded(s.rows);
}

template <class T> Index LcabaRefined<T>::do_bytes() const {
  return plan_.bytes() + plan_M_.bytes() + factor_.bytes() + factor_M_.bytes() + weights_.bytes() + residual_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class LcabaRefined<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
