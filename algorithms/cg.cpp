#include "algorithms/cg.h"

#include <cmath>

#include "algorithms/columns.h"

namespace delassus {
namespace {

template <class T> using Map = Eigen::Map<VectorX<T>>;
template <class T> using ConstMap = Eigen::Map<const VectorX<T>>;

// xᵀy, zero for no rows.
template <class X, class Y> auto inner(const X& x, const Y& y) {
  using T = typename X::Scalar;
  return x.size() == 0 ? T(0) : T(x.dot(y));
}

}  // namespace

template <class T> void Cg<T>::do_analyze() {
  plan_ = make_plan(*this->structure(), Matrix::M);
  factor_.analyze(*this->structure(), plan_);
  damping_.analyze(*this->structure());
}

template <class T> Report Cg<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  damping_.assign(damping);
  factored_ = factor_.start(problem);
  if (factored_.ok()) factored_ = factor_.update_undamped();
  return factored_;
}

template <class T> Report Cg<T>::do_update_damping(const Damping<T>& damping) {
  damping_.assign(damping);
  return factored_;
}

// y = (J M⁻¹ Jᵀ + R⁻¹) x
template <class T> void Cg<T>::multiply(const T* x, T* y, T* workspace) const {
  T* const damped = workspace + factor_.workspace();
  factor_.project(x, y, workspace);
  damping_.multiply(x, damped);
  for (Index r = 0; r < this->size(); ++r) y[r] += damped[r];
}

template <class T> Report Cg<T>::do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const {
  if (!factored_.ok()) return factored_;
  for (Index c = 0; c < f.cols(); ++c)
    multiply(f.data() + c * f.outerStride(), a.data() + c * a.outerStride(), workspace);
  return {};
}

template <class T> Report Cg<T>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  if (!factored_.ok()) return factored_;
  Report worst;
  for (Index c = 0; c < a.cols(); ++c)
    worst = worse(worst, solve_column(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(), workspace));
  return worst;
}

template <class T> Report Cg<T>::solve_column(const T* a, T* f, T* workspace) const {
  const Index m = this->size();
  T* const inner_work = workspace + 3 * padded(m);
  ConstMap<T> b(a, m);
  Map<T> x(f, m), r(workspace, m), p(workspace + padded(m), m), q(workspace + 2 * padded(m), m);
  const T eps_squared = T(unit_roundoff<T>) * T(unit_roundoff<T>), bb = inner(b, b);
  const double attainable = ScalarTraits<T>::exact ? 0.0 : 30 * unit_roundoff<T> * static_cast<double>(m);
  T largest = T(0);  // largest Rayleigh quotient seen: a lower estimate of λmax(A)
  Report report;
  x.setZero();
  r = b;
  const Index limit = 10 * m + 50;
  for (int start = 0; start < max_starts; ++start) {
    p = r;
    T rr = inner(r, r);
    const auto small_enough = [&] { return !(rr > eps_squared * (largest * largest * inner(x, x) + bb)); };
    while (!small_enough() && report.iterations < limit) {
      multiply(p.data(), q.data(), inner_work);                 // q = A p
      const T pq = inner(p, q);
      if (!ScalarTraits<T>::usable_pivot(pq)) break;            // p in the null space, or not finite
      const T quotient = pq / inner(p, p);
      if (quotient > largest) largest = quotient;
      const T alpha = rr / pq;                                  // α = rᵀr / pᵀAp
      x += p * alpha;
      r -= q * alpha;
      const T next = inner(r, r);
      p = r + p * T(next / rr);                                 // p = r + β p
      rr = next;
      ++report.iterations;
    }
    multiply(x.data(), q.data(), inner_work);
    r = b - q;
    const double residual = std::sqrt(static_cast<double>(inner(r, r)));
    const double scale = static_cast<double>(largest) * std::sqrt(static_cast<double>(inner(x, x))) +
                         std::sqrt(static_cast<double>(bb));
    report.backward_error = scale > 0 ? residual / scale : residual;
    if (!(report.backward_error > attainable)) break;
  }
  if (!(report.backward_error <= attainable)) report.status = Status::not_converged;
  if (!std::isfinite(report.backward_error)) report.status = Status::not_finite;
  return report;
}

template <class T> Index Cg<T>::do_workspace(Index) const {
  return factor_.workspace() + 4 * padded(this->size());
}

template <class T> Index Cg<T>::do_bytes() const { return plan_.bytes() + factor_.bytes() + damping_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class Cg<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
