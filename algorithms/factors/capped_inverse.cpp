#include "algorithms/factors/capped_inverse.h"
#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"

#include <cmath>

namespace delassus {

template <class T, class F> void CappedInverse<T, F>::analyze(const Structure& structure) {
  structure_ = std::make_shared<const Structure>(structure);
  plan_ = make_plan(*structure_, Matrix::M_R);
  factor_.analyze(*structure_, plan_);
  narrow_ = Problem<F>(structure_);
  weights_.analyze(*structure_);
  narrow_weights_.analyze(*structure_);
  damping_.analyze(*structure_);
  least_.assign(static_cast<std::size_t>(structure_->rows), T(0));
  shift_ = least_;
  omega_.assign(static_cast<std::size_t>(structure_->bodies()), SixBySix<T>::zero());
}

namespace {
/// 2^k as T where F is narrower, so that other units give the same bits; 1 where it is not, or x is no positive number.
template <class T, class F> T power_of_two_below(const T& x) {
  if constexpr (!std::is_same_v<T, F>)
    if (x > 0 && std::isfinite(x)) return std::exp2(std::ilogb(x));
  return T(1);
}
}  // namespace

template <class T, class F> T CappedInverse<T, F>::unit_of_mass(const Problem<T>& problem) const {
  using std::abs;
  T largest(0);
  for (const Matrix6<T>& H : problem.H)
    for (Index c = 0; c < 6; ++c) largest = std::max(largest, T(abs(H(c, c))));
  for (const T& A : problem.armature) largest = std::max(largest, T(abs(A)));
  return power_of_two_below<T, F>(largest);
}

template <class T, class F> Report CappedInverse<T, F>::update(const Problem<T>& problem, const Factor<T>& M) {
  const auto round = [](const auto& from, auto& to, const T& unit) {
    for (std::size_t i = 0; i < from.size(); ++i)
      for (Index k = 0; k < from[i].size(); ++k) to[i].data()[k] = static_cast<F>(T(from[i].data()[k] / unit));
  };
  if (structure_->rows == 0) return undamped_ = {};  // nothing will be asked
  unit_ = unit_of_mass(problem);
  round(problem.S, narrow_.S, T(1));
  round(problem.H, narrow_.H, unit_);
  round(problem.K, narrow_.K, T(1));
  for (std::size_t c = 0; c < problem.armature.size(); ++c) narrow_.armature[c] = static_cast<F>(T(problem.armature[c] / unit_));
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), narrow_.joint_K.begin());
  M.row_mobility(least_.data(), omega_.data());
  for (T& d : least_) d *= T(1 / g_);
  return undamped_ = factor_.start(narrow_);
}

template <class T, class F> Report CappedInverse<T, F>::update_damping(const Damping<T>& damping) {
  if (!undamped_.ok() || structure_->rows == 0) return undamped_;
  damping_.assign(damping);
  for (Index r = 0; r < structure_->rows; ++r) {
    const T missing = least_[r] - damping_.diagonal(r);  // 0 for rows of a block, which may be singular
    shift_[r] = missing > T(0) ? missing : T(0);
  }
  const Report inverted = weights_.assign_inverse(damping, shift_.data());
  if (!inverted.ok()) return inverted;
  narrow_weights_.round(weights_, unit_);
  return factor_.update_weights(narrow_weights_);
}

namespace {
/// X in F, and back.
template <class F, class X> auto rounded(const X& x) {
  if constexpr (columns_in<X> == 1) return static_cast<F>(x);
  else if constexpr (std::is_same_v<F, float>) return narrowed(x);
  else return x;
}
template <class X, class Y> X restored(const Y& x) {
  if constexpr (columns_in<X> == 1) return X(x);
  else if constexpr (std::is_same_v<Y, Lanes8f>) return widened(x);
  else return x;
}
}  // namespace

// A narrow F works on residuals scaled to about 1: 1e-50 must not vanish in float.
template <class T, class F>
template <class X>
void CappedInverse<T, F>::solve_kkt(const X* r1, const X* r2, X* d_nu, X* d_lambda, X* work) const {
  using Y = decltype(rounded<F>(X{}));
  const Index n = structure_->dofs(), m = structure_->rows;
  Y* const tau = reinterpret_cast<Y*>(work);
  Y* const nu = tau + padded(n);
  Y* const right = nu + padded(n);
  Y* const rate = right + padded(m);
  Y* const force = rate + padded(m);
  Y* const inner = force + padded(m);
  X scale{};  // powers of two
  for (int l = 0; l < columns_in<X>; ++l) {
    using std::abs;
    T size(0);
    for (Index c = 0; c < n && r1 != nullptr; ++c) size = std::max(size, T(abs(T(lane(r1[c], l))) / unit_));
    for (Index r = 0; r < m; ++r) size = std::max(size, T(abs(T(lane(r2[r], l)))));
    set_lane(scale, l, power_of_two_below<T, F>(size));
  }
  for (Index c = 0; c < n; ++c) tau[c] = r1 != nullptr ? rounded<F>(X(r1[c] / unit_ / scale)) : Y{};
  for (Index r = 0; r < m; ++r) right[r] = rounded<F>(X(r2[r] / scale));
  narrow_weights_.multiply(right, force);
  factor_.solve(force, tau, rate, nu, inner);
  for (Index r = 0; r < m; ++r) rate[r] = right[r] - rate[r];
  narrow_weights_.multiply(rate, force);
  for (Index c = 0; c < n && d_nu != nullptr; ++c) d_nu[c] = restored<X>(nu[c]) * scale;
  for (Index r = 0; r < m; ++r) d_lambda[r] = restored<X>(force[r]) * scale * unit_;
}

template <class T, class F> Index CappedInverse<T, F>::workspace() const {
  static_assert(sizeof(F) <= sizeof(T));
  return 2 * padded(structure_->dofs()) + 3 * padded(structure_->rows) + factor_.solve_workspace();
}

template <class T, class F> Index CappedInverse<T, F>::bytes() const {
  return plan_.bytes() + factor_.bytes() + damping_.bytes() + weights_.bytes() + narrow_weights_.bytes() +
         static_cast<Index>(narrow_.S.size() * sizeof(Vector6<F>) + narrow_.H.size() * sizeof(Matrix6<F>) +
                            narrow_.K.size() * sizeof(Vector6<F>) + 2 * shift_.size() * sizeof(T) +
                            omega_.size() * sizeof(SixBySix<T>));
}

#define DELASSUS_INSTANTIATE(T) template class CappedInverse<T, T>; template void CappedInverse<T, T>::solve_kkt(const T*, const T*, T*, T*, T*) const;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE
#ifndef DELASSUS_EXACT
template class CappedInverse<double, float>;
template void CappedInverse<double, float>::solve_kkt(const double*, const double*, double*, double*, double*) const;
template void CappedInverse<double, float>::solve_kkt(const Lanes8*, const Lanes8*, Lanes8*, Lanes8*, Lanes8*) const;
template void CappedInverse<double, double>::solve_kkt(const Lanes8*, const Lanes8*, Lanes8*, Lanes8*, Lanes8*) const;
#endif

}  // namespace delassus
