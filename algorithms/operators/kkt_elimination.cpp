#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/ldlt_pivoted.h"
#include "algorithms/operators/kkt_elimination.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace delassus {

template <class T, Dependent policy> void KktEliminationWith<T, policy>::do_analyze() {
  const Index m = this->structure()->rows;
  refinement_.analyze(this->structure());
  damping_.analyze(*this->structure());
  hard_rows_.analyze(*this->structure());
  A0_.setZero(m, m);
  A_.setZero(m, m);
  factor_.setZero(m, m);
  unit_.assign(static_cast<std::size_t>(m), T(0));
  column_ = unit_;
  kinds_.assign(unit_.size(), Kind::damped);
  order_.assign(static_cast<std::size_t>(m), 0);
  dependent_.clear();
  dependent_.reserve(static_cast<std::size_t>(m));
  sweep_work_ = std::make_unique<Workspace<T>>(refinement_.factor_M().workspace());
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update(problem);
  return take_rows(problem, damping);
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update_rows(problem);
  return take_rows(problem, damping);
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::take_rows(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = refinement_.factor_mass();
  if (undamped_.ok())
    for (Index c = 0; c < A0_.cols(); ++c) {  // J M⁻¹Jᵀ e_c
      unit_[c] = T(1);
      refinement_.factor_M().project(unit_.data(), A0_.data() + c * A0_.rows(), sweep_work_->data());
      unit_[c] = T(0);
    }
  if (undamped_.ok()) hard_rows_.update(problem, refinement_.factor_M());
  return do_update_damping(damping);
}

// A = J M⁻¹Jᵀ + R⁻¹ = P ᵀL D Lᵀ P, as far as its rank goes
template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::do_update_damping(const Damping<T>& damping) {
  dependent_.clear();
  if (!undamped_.ok()) return undamped_;
  refinement_.update_damping(damping);
  damping_.assign(damping);
  const Index m = this->size();
  A_ = A0_;
  for (Index c = 0; c < m; ++c) {  // + R⁻¹ e_c
    unit_[c] = T(1);
    damping_.multiply(unit_.data(), column_.data());
    unit_[c] = T(0);
    for (Index r = 0; r < m; ++r) A_(r, c) += column_[r];
    kinds_[c] = column_[c] == T(0) ? Kind::hard : Kind::damped;
  }
  for (const Index r : damping_.off()) {
    A_.row(r).setZero();
    A_.col(r).setZero();
    kinds_[r] = Kind::off;
  }
  const bool any_hard = std::find(kinds_.begin(), kinds_.end(), Kind::hard) != kinds_.end();
  rank_ = any_hard ? factor_by_rows() : factor_by_pivots();
  std::copy_if(order_.begin() + rank_, order_.end(), std::back_inserter(dependent_), [this](Index r) { return kinds_[r] != Kind::off; });
  std::sort(dependent_.begin(), dependent_.end());
  factored_ = {};
  for (const Index r : dependent_)  // a damped row never depends: this arithmetic cannot tell
    if (factored_.ok() && (policy == Dependent::refused || kinds_[r] == Kind::damped)) factored_ = {.status = Status::lost_pivot, .where = r, .of_A = true};
  trust_ = trust_in_factor();
  return {};  // apply is defined all the same; solve reports the lost pivot
}

// t, when it is at least a half
template <class T, Dependent policy> double KktEliminationWith<T, policy>::trust_in_factor() {
  if (refinement_.invertible().ok() || !factored_.ok()) return 0;  // another bound, or no answer
  if (ScalarTraits<T>::exact) return 1;
  T trace(0);
  for (Index c = 0; c < rank_; ++c) {  // ‖D^(−½) L⁻¹ e_c‖²
    for (Index k = c; k < rank_; ++k) unit_[k] = T(k == c ? 1 : 0);
    T entry(0);
    for (Index k = c; k < rank_; ++k) {
      const T* const column = factor_.data() + k * this->size();
      entry += unit_[k] * unit_[k] / column[k];
      for (Index r = k + 1; r < rank_; ++r) unit_[r] -= column[r] * unit_[k];
    }
    trace += entry * (hard_rows_.size(order_[c]) + (A_(order_[c], order_[c]) - A0_(order_[c], order_[c])));
  }
  std::fill(unit_.begin(), unit_.end(), T(0));
  const double k = static_cast<double>(rank_);
  const double trust = 1 - std::sqrt(k) * (k + 30) * unit_roundoff<T> * std::sqrt(static_cast<double>(trace));
  return trust >= 0.5 ? trust : 0;
}

// ‖D^(−½) L⁻¹ r₂‖² / t² of the rows not left out; none when that is not known, or underflows
template <class T, Dependent policy>
std::optional<T> KktEliminationWith<T, policy>::bound_at_rows(const T* r2, T* work) const {
  if (!(trust_ > 0)) return std::nullopt;
  for (Index k = 0; k < rank_; ++k) work[k] = r2[order_[k]];
  const bool all_zero = std::all_of(work, work + rank_, [](const T& x) { return x == T(0); });
  T square(0);
  for (Index k = 0; k < rank_; ++k) {
    const T* const column = factor_.data() + k * this->size();
    square += work[k] * work[k] / column[k];
    for (Index r = k + 1; r < rank_; ++r) work[r] -= column[r] * work[k];
  }
  if (square == T(0) && !all_zero) return std::nullopt;
  return square / T(trust_ * trust_);
}

template <class T, Dependent policy> Index KktEliminationWith<T, policy>::factor_by_rows() {
  const Index rank = hard_rows_.factor(kinds_, damping_, refinement_.factor_M(), order_.data(), sweep_work_->data());
  for (Index k = 0; k < rank; ++k)
    for (Index r = k; r < rank; ++r) factor_(r, k) = hard_rows_.share(order_[r], k);
  return rank;
}

template <class T, Dependent policy> Index KktEliminationWith<T, policy>::factor_by_pivots() {
  for (Index c = 0; c < A_.cols(); ++c) column_[c] = A_(c, c);
  factor_ = A_;
  for (const Index r : damping_.off()) factor_(r, r) = T(1);  // λ_r = 0 of a right-hand side 0
  return ldlt_pivoted(factor_.data(), A_.cols(), order_.data(), [&](Index row, T& pivot, Index steps) {
    const T least = damping_.diagonal(row);  // 0 for rows of a dense block
    if (least > pivot) pivot = least;
    if (least > T(0)) return true;
    const T noise = T(30 * unit_roundoff<T> * static_cast<double>(steps)) * column_[row];
    return ScalarTraits<T>::usable_pivot(pivot) && pivot > noise;
  });
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::do_apply(ConstRef<T> f, Ref<T> a, T*) const {
  if (!undamped_.ok()) return undamped_;
  for (Index c = 0; c < f.cols(); ++c) {
    a.col(c).setZero();
    for (Index k = 0; k < f.rows(); ++k) a.col(c) += A_.col(k) * f(k, c);
  }
  return {};
}

// λ of the independent rows; 0 for the others
template <class T, Dependent policy>
void KktEliminationWith<T, policy>::solve_multipliers(const T* right, T* lambda, T* work) const {
  const Index m = this->size();
  for (Index k = 0; k < rank_; ++k) work[k] = right[order_[k]];
  ldlt_solve(factor_.data(), rank_, m, work);
  for (Index r = 0; r < m; ++r) lambda[r] = T(0);
  for (Index k = 0; k < rank_; ++k) lambda[order_[k]] = work[k];
}

// A δλ = r₂ − J M⁻¹ r₁;  δν = M⁻¹(r₁ + Jᵀδλ)
template <class T, Dependent policy>
void KktEliminationWith<T, policy>::solve_kkt(const T* r1, const T* r2, T* d_nu, T* d_lambda, T* work) const {
  const Index m = this->size();
  T* const right = work + refinement_.factor_M().solve_workspace();
  T* const rate = right + padded(m);
  std::copy(r2, r2 + m, right);
  if (r1 != nullptr) {
    std::fill(d_lambda, d_lambda + m, T(0));
    refinement_.factor_M().solve(d_lambda, r1, rate, d_nu, work);
    for (Index r = 0; r < m; ++r) right[r] -= rate[r];
  }
  damping_.switch_off(right);
  solve_multipliers(right, d_lambda, rate);
  refinement_.factor_M().solve(d_lambda, r1, rate, d_nu, work);
}

// The rows left out must hold by themselves. ν keeps the digits that a product with A_, itself rounded, does not show.
template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::check_dependent(const typename Refinement<T>::Asked& asked, const T* f, const T* nu, T* work) const {
  using std::abs;
  using std::sqrt;
  if (dependent_.empty()) return {};
  const Index m = this->size();
  T *const r1 = work, *const r2 = r1 + padded(this->structure()->dofs());
  refinement_.residual(nu, f, asked.r2, r1, r2, r2 + padded(m));
  T energy(0), of_r1(0);  // of the motion by λ, λᵀA₀λ, and by r₁
  for (Index k = 0; k < m; ++k)
    for (Index r = 0; r < m; ++r) energy += f[r] * A0_(r, k) * f[k];
  if (asked.r1 != nullptr) of_r1 = refinement_.factor_M().energy(asked.r1, r2 + padded(m));
  for (const Index r : dependent_) {
    T size = T(abs(asked.r2[r]));
    if constexpr (!ScalarTraits<T>::exact)
      size += T(sqrt(hard_rows_.size(r))) * (T(sqrt(T(abs(energy)))) + T(sqrt(T(abs(of_r1)))));
    for (Index k = 0; k < m; ++k) size += T(abs(A_(r, k))) * T(abs(f[k]));
    if (T(abs(r2[r])) > T(30 * unit_roundoff<T> * static_cast<double>(m)) * size) return {Status::inconsistent, r};
  }
  return {};
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const {
  if (!undamped_.ok()) return undamped_;
  if (!factored_.ok()) return factored_;
  const auto solved = [&](Accuracy accuracy) {
    return refinement_.solve(
        asked, f, accuracy, {max_steps}, [this](auto... args) { solve_kkt(args...); }, work, nu,
        [this](const T* r2, T* rest) { return bound_at_rows(r2, rest); });
  };
  Report report = solved(wanted), consistent = check_dependent(asked, f, nu, work);
  if (!consistent.ok() && wanted.error > 0) {  // what is left may be the answer's own error
    report = solved({0, wanted.steps});
    consistent = check_dependent(asked, f, nu, work);
  }
  return consistent.ok() ? report : consistent;
}

template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const {
  return solve_pair({.r2 = a}, f, workspace, wanted, workspace + padded(this->structure()->dofs()));
}

template <class T, Dependent policy> Index KktEliminationWith<T, policy>::do_workspace(Index) const {
  return padded(this->structure()->dofs()) + refinement_.workspace(refinement_.factor_M().solve_workspace() + 2 * padded(this->size()));
}

template <class T, Dependent policy> Index KktEliminationWith<T, policy>::do_bytes() const {
  return refinement_.bytes() + damping_.bytes() + hard_rows_.bytes() +
         static_cast<Index>(sizeof(T)) * (3 * A_.size() + static_cast<Index>(2 * unit_.size()) + sweep_work_->size()) +
         static_cast<Index>(sizeof(Index) * 2 * order_.size() + sizeof(Kind) * kinds_.size());
}

#define DELASSUS_INSTANTIATE(T)                              \
  template class KktEliminationWith<T, Dependent::left_out>; \
  template class KktEliminationWith<T, Dependent::refused>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
