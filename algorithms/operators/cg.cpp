#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/aba_sweep.h"
#include "algorithms/operators/cg.h"

#include <algorithm>
#include <cmath>

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

template <class T, class P> void CgWith<T, P>::do_analyze() {
  plan_ = make_plan(*this->structure(), Matrix::M);
  factor_.analyze(*this->structure(), plan_);
  damping_.analyze(*this->structure());
  preconditioner_.analyze(*this->structure());
}

template <class T, class P> Report CgWith<T, P>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  factored_ = factor_.start(problem);
  if (factored_.ok()) factored_ = factor_.update_undamped();
  return take_rows(problem, damping);
}

template <class T, class P> Report CgWith<T, P>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  factor_.move_rows(problem);
  return take_rows(problem, damping);
}

template <class T, class P> Report CgWith<T, P>::take_rows(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = factored_.ok() ? preconditioner_.update(problem, factor_) : factored_;
  return do_update_damping(damping);
}

template <class T, class P> Report CgWith<T, P>::do_update_damping(const Damping<T>& damping) {
  damping_.assign(damping);
  preconditioned_ = undamped_.ok() ? preconditioner_.update_damping(damping) : undamped_;
  return factored_;  // apply is defined without the preconditioner; solve reports it
}

template <class T, class P> void CgWith<T, P>::multiply(const T* x, T* y, T* workspace) const {
  delassus_product(factor_, damping_, this->size(), x, y, workspace);
}

template <class T, class P> Report CgWith<T, P>::do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const {
  if (!factored_.ok()) return factored_;
  for (Index c = 0; c < f.cols(); ++c)
    multiply(f.data() + c * f.outerStride(), a.data() + c * a.outerStride(), workspace);
  return {};
}

template <class T, class P> void CgWith<T, P>::precondition(const T* r, T* z, T* work) const {
  if constexpr (!plain) preconditioner_.template solve_kkt<T>(nullptr, r, nullptr, z, work);
}

template <class T, class P> Report CgWith<T, P>::solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const {
  return iterate(a, f, wanted, Start::zero, workspace);
}

// A λ = r₂ − J M⁻¹ r₁;  ν = M⁻¹(r₁ + Jᵀλ)
template <class T, class P>
Report CgWith<T, P>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const {
  if (!factored_.ok()) return factored_;
  const Index m = this->size();
  T *const right = workspace, *const rate = right + padded(m), *const work = rate + padded(m);
  std::fill(right, right + m, T(0));
  factor_.solve(right, r1, rate, nu, work);
  for (Index r = 0; r < m; ++r) right[r] = r2[r] - rate[r];
  const Report report = iterate(right, lambda, wanted, start, work);
  factor_.solve(lambda, r1, rate, nu, work);
  return report;
}

template <class T, class P>
Report CgWith<T, P>::iterate(const T* a, T* f, Accuracy wanted, Start start, T* workspace) const {
  if (!factored_.ok()) return factored_;
  if (!preconditioned_.ok()) return preconditioned_;
  const Index m = this->size();
  T* const z = plain ? workspace : workspace + 3 * padded(m);  // P r; r itself
  T* const inner_work = workspace + (plain ? 3 : 4) * padded(m);
  ConstMap<T> b(a, m);
  Map<T> x(f, m), r(workspace, m), p(workspace + padded(m), m), q(workspace + 2 * padded(m), m);
  r = b;
  damping_.switch_off(r.data());
  const T eps_squared = T(unit_roundoff<T>) * T(unit_roundoff<T>), bb = inner(r, r);
  const double attainable = ScalarTraits<T>::exact ? 0.0 : 30 * unit_roundoff<T> * static_cast<double>(m);
  T largest = T(0);  // largest Rayleigh quotient seen: a lower estimate of λmax(A)
  Report report;
  if (start == Start::zero) x.setZero();
  damping_.switch_off(f);
  if (bb == T(0) && std::any_of(r.data(), r.data() + m, [](const T& e) { return !(e == T(0)); })) {  // its square underflows
    report.status = Status::not_converged;
    return report;
  }
  const Index most = 10 * m + 50, limit = std::min<Index>(most, wanted.steps);
  if (start == Start::given) {
    multiply(x.data(), q.data(), inner_work);
    r -= q;
  }
  bool cut_short = false;
  for (int round = 0; round < max_starts && !cut_short; ++round) {
    precondition(r.data(), z, inner_work);
    p = Map<T>(z, m);
    T rr = inner(r, r), rz = inner(r, Map<T>(z, m));
    const auto small_enough = [&] { return !(rr > eps_squared * (largest * largest * inner(x, x) + bb)); };
    while (!small_enough()) {
      multiply(p.data(), q.data(), inner_work);                 // q = A p
      const T pq = inner(p, q);
      if (!ScalarTraits<T>::usable_pivot(pq)) break;            // p in the null space, or not finite
      const T quotient = pq / inner(p, p);
      if (quotient > largest) largest = quotient;
      if (!(quotient > T(unit_roundoff<T>) * largest)) break;    // in the null space, as far as rounding can tell
      if (cut_short = report.iterations == limit; cut_short) break;
      // α = rᵀz / pᵀAp; with P in float, pᵀr: the energy cannot grow, even when p is little more than rounding
      const T alpha = (plain ? rz : T(inner(p, r))) / pq;
      x += p * alpha;
      r -= q * alpha;
      rr = inner(r, r);
      precondition(r.data(), z, inner_work);                    // z = P r
      const T next = inner(r, Map<T>(z, m));
      // β = rᵀz / (rᵀz before); with P in float, −zᵀA p / pᵀAp: P need not be the same from step to step
      const T beta = plain ? T(next / rz) : T(-inner(q, Map<T>(z, m)) / pq);
      p = Map<T>(z, m) + p * beta;
      rz = next;
      ++report.iterations;
    }
    multiply(x.data(), q.data(), inner_work);
    r = b - q;
    damping_.switch_off(r.data());
    const double residual = std::sqrt(static_cast<double>(inner(r, r)));
    const double scale = static_cast<double>(largest) * std::sqrt(static_cast<double>(inner(x, x))) +
                         std::sqrt(static_cast<double>(bb));
    report.backward_error = std::isfinite(scale) ? (scale > 0 ? residual / scale : residual) : scale;  // squares overflow: nothing is known
    if (!(report.backward_error > attainable)) break;
  }
  if (!(report.backward_error <= attainable) || (cut_short && limit < most)) report.status = Status::not_converged;
  if (!std::isfinite(report.backward_error)) report.status = Status::not_finite;
  return report;
}

template <class T, class P> Index CgWith<T, P>::do_workspace(Index) const {
  return std::max(factor_.workspace() + padded(this->size()), preconditioner_.workspace()) + 4 * padded(this->size());
}

template <class T, class P> Index CgWith<T, P>::do_kkt_workspace() const {
  return 2 * padded(this->size()) + std::max(factor_.solve_workspace(), do_workspace(1));
}

template <class T, class P> Index CgWith<T, P>::do_bytes() const { return plan_.bytes() + factor_.bytes() + damping_.bytes() + preconditioner_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class CgWith<T, NoPreconditioner<T>>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
template class CgWith<Quad, CappedInverse<Quad, Quad>>;
template class CgWith<Counted, CappedInverse<Counted, Counted>>;
#else
template class CgWith<double, CappedInverse<double, float>>;
template class CgWith<float, CappedInverse<float, float>>;
#endif

}  // namespace delassus
