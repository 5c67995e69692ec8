#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/ldlt_pivoted.h"
#include "algorithms/kit/vectors.h"
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
  factor_.setZero(m, m);
  lower_.setZero(padded(m), m);
  upper_.setZero(padded(m), m);
  inverse_pivots_ = unit_ = column_ = VectorX<T>::Constant(padded(m), T(0));
  kinds_.assign(static_cast<std::size_t>(m), Kind::damped);
  order_.assign(static_cast<std::size_t>(m), 0);
  dependent_.clear();
  dependent_.reserve(static_cast<std::size_t>(m));
  sweep_work_ = std::make_unique<Workspace<T>>(hard_rows_.workspace(refinement_.factor_M()));
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
  formed_ = false;
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
  for (Index r = 0; r < this->size(); ++r) kinds_[r] = damping_.entry(r) == T(0) ? Kind::hard : Kind::damped;
  for (const Index r : damping_.off()) kinds_[r] = Kind::off;
  any_hard_ = std::find(kinds_.begin(), kinds_.end(), Kind::hard) != kinds_.end();
  rank_ = any_hard_ ? factor_by_rows() : factor_by_pivots();
  std::copy_if(order_.begin() + rank_, order_.end(), std::back_inserter(dependent_), [this](Index r) { return kinds_[r] != Kind::off; });
  std::sort(dependent_.begin(), dependent_.end());
  factored_ = {};
  for (const Index r : dependent_) {  // a damped row never depends: this arithmetic cannot tell
    if (factored_.ok() && (policy == Dependent::refused || kinds_[r] == Kind::damped)) factored_ = {.status = Status::lost_pivot, .where = r, .of_A = true};
    if (any_hard_) hard_rows_.column(r, A0_.data() + r * A0_.rows());
  }
  trust_ = trust_in_factor();
  for (Index k = 0; k < rank_; ++k) {  // what stood there was L⁻¹
    std::fill_n(upper_.data() + k * upper_.rows(), padded(rank_), T(0));
    for (Index j = 0; j < k; ++j) upper_(j, k) = lower_(k, j);
  }
  return {};  // apply is defined all the same; solve reports the lost pivot
}

// t, when it is at least a half
template <class T, Dependent policy> double KktEliminationWith<T, policy>::trust_in_factor() {
  if (refinement_.invertible().ok() || !factored_.ok()) return 0;  // another bound, or no answer
  if (ScalarTraits<T>::exact) return 1;
  for (Index c = 0; c < rank_; ++c) column_[c] = hard_rows_.size(order_[c]) + damping_.entry(order_[c]);
  std::fill(column_.data() + rank_, column_.data() + column_.size(), T(0));
  const V* const sizes = reinterpret_cast<const V*>(column_.data());
  const Index panels = upper_.rows() / width;
  V* const inverse = reinterpret_cast<V*>(upper_.data());
  V sum{};  // Σ s_c² (L⁻¹)_kc² / d_k
  for (Index k = 0; k < rank_; ++k)
    for (Index p = 0; p <= k / width; ++p) {  // e_kᵀL⁻¹ = e_kᵀ − Σ l_kj e_jᵀL⁻¹
      V row{};
      if (p == k / width) set_lane(row, static_cast<int>(k % width), T(1));
      for (Index j = p * width; j < k; ++j) row -= inverse[j * panels + p] * lower_(k, j);
      inverse[k * panels + p] = row;
      sum += row * row * sizes[p] * inverse_pivots_[k];
    }
  T trace(0);
  for (int l = 0; l < width; ++l) trace += lane(sum, l);
  const double k = static_cast<double>(rank_);
  const double trust = 1 - std::sqrt(k) * (k + 30) * unit_roundoff<T> * std::sqrt(static_cast<double>(trace));
  return trust >= 0.5 ? trust : 0;
}

// x = L⁻¹ right of the rows not left out, zero up to the padded end; as many entries at once as there are lanes
template <class T, Dependent policy> void KktEliminationWith<T, policy>::forward(const T* right, T* x) const {
  const Index rank = rank_, stride = lower_.rows() / width;
  const V* const columns = reinterpret_cast<const V*>(lower_.data());
  for (Index k = 0; k < rank; ++k) x[k] = right[order_[k]];
  std::fill(x + rank, x + padded(rank), T(0));
  for (Index p = 0; p * width < rank; ++p) {
    V& panel = reinterpret_cast<V*>(x)[p];
    V sum = panel;
    for (Index k = 0; k < p * width; ++k) sum -= columns[k * stride + p] * x[k];
    panel = sum;
    for (Index k = p * width; k < std::min(rank, (p + 1) * width); ++k) panel -= columns[k * stride + p] * x[k];
  }
}

// ‖D^(−½) L⁻¹ r₂‖² / t² of the rows not left out; none when that is not known, or underflows
template <class T, Dependent policy>
std::optional<T> KktEliminationWith<T, policy>::bound_at_rows(const T* r2, T* work) const {
  if (!(trust_ > 0)) return std::nullopt;
  forward(r2, work);
  const T square = dot(work, work, inverse_pivots_.data(), rank_);
  if (square == T(0))
    for (Index k = 0; k < rank_; ++k)
      if (r2[order_[k]] != T(0)) return std::nullopt;
  return square / T(trust_ * trust_);
}

template <class T, Dependent policy> Index KktEliminationWith<T, policy>::factor_by_rows() {
  formed_ = false;
  const Index rank = hard_rows_.factor(kinds_, damping_, refinement_.factor_M(), order_.data(), sweep_work_->data());
  for (Index k = 0; k < rank; ++k) {
    T* const column = lower_.data() + k * lower_.rows();
    std::fill_n(column, padded(rank), T(0));
    for (Index r = k + 1; r < rank; ++r) column[r] = hard_rows_.share(order_[r], k);
    inverse_pivots_[k] = T(1) / hard_rows_.share(order_[k], k);
  }
  return rank;
}

// Of A, formed.
template <class T, Dependent policy> Index KktEliminationWith<T, policy>::factor_by_pivots() {
  const Index m = this->size();
  for (Index c = 0; c < m; ++c) {
    unit_[c] = T(1);
    if (!formed_) refinement_.factor_M().project(unit_.data(), A0_.data() + c * m, sweep_work_->data());
    damping_.multiply(unit_.data(), column_.data());
    unit_[c] = T(0);
    factor_.col(c) = A0_.col(c) + column_.head(m);
  }
  formed_ = true;
  for (const Index r : damping_.off()) {
    factor_.row(r).setZero();
    factor_.col(r).setZero();
    factor_(r, r) = T(1);  // λ_r = 0 of a right-hand side 0
  }
  for (Index c = 0; c < m; ++c) column_[c] = factor_(c, c);
  const Index rank = ldlt_pivoted(factor_.data(), m, order_.data(), [&](Index row, T& pivot, Index steps) {
    const T least = damping_.diagonal(row);  // 0 for rows of a dense block
    if (least > pivot) pivot = least;
    if (least > T(0)) return true;
    const T noise = T(30 * unit_roundoff<T> * static_cast<double>(steps)) * column_[row];
    return ScalarTraits<T>::usable_pivot(pivot) && pivot > noise;
  });
  for (Index k = 0; k < rank; ++k) {
    T* const column = lower_.data() + k * lower_.rows();
    std::fill_n(column, padded(rank), T(0));
    for (Index r = k + 1; r < rank; ++r) column[r] = factor_(r, k);
    inverse_pivots_[k] = T(1) / factor_(k, k);
  }
  return rank;
}

// J M⁻¹Jᵀ by a sweep where it is not formed.
template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::do_apply(ConstRef<T> f, Ref<T> a, T* work) const {
  if (!undamped_.ok()) return undamped_;
  const Index m = this->size();
  T *const x = work, *const y = x + padded(m);
  for (Index c = 0; c < f.cols(); ++c) {
    for (Index r = 0; r < m; ++r) x[r] = f(r, c);
    damping_.switch_off(x);
    T* const to = a.data() + c * a.outerStride();
    if (any_hard_) refinement_.factor_M().project(x, to, y + padded(m));
    else a.col(c).setZero();
    for (Index k = 0; k < m && !any_hard_; ++k) a.col(c) += A0_.col(k) * x[k];
    damping_.multiply(x, y);
    for (Index r = 0; r < m; ++r) to[r] += y[r];
    damping_.switch_off(to);
  }
  return {};
}

// λ of the independent rows; 0 for the others
template <class T, Dependent policy>
void KktEliminationWith<T, policy>::solve_multipliers(const T* right, T* lambda, T* work) const {
  forward(right, work);
  const Index stride = upper_.rows() / width;
  const V* const columns = reinterpret_cast<const V*>(upper_.data());
  for (Index k = 0; k < rank_; ++k) work[k] *= inverse_pivots_[k];
  for (Index p = (rank_ + width - 1) / width; p-- > 0;) {
    V& panel = reinterpret_cast<V*>(work)[p];
    V sum = panel;
    for (Index k = (p + 1) * width; k < rank_; ++k) sum -= columns[k * stride + p] * work[k];
    panel = sum;
    for (Index k = std::min(rank_, (p + 1) * width); k-- > p * width;) panel -= columns[k * stride + p] * work[k];
  }
  for (Index r = 0; r < this->size(); ++r) lambda[r] = T(0);
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

// The rows left out must hold by themselves. ν keeps the digits that a product with A, itself rounded, does not show.
template <class T, Dependent policy>
Report KktEliminationWith<T, policy>::check_dependent(const typename Refinement<T>::Asked& asked, const T* f, const T* nu, T* work) const {
  using std::abs;
  using std::sqrt;
  if (dependent_.empty()) return {};
  const Index m = this->size();
  T *const r1 = work, *const r2 = r1 + padded(this->structure()->dofs());
  refinement_.residual(nu, f, asked.r2, r1, r2, r2 + padded(m));
  T energy(-1), of_r1(0);  // of the motion by λ, λᵀA₀λ, and by r₁; where they are called for
  for (const Index r : dependent_) {
    T size = T(abs(asked.r2[r]));
    const auto is_off = [&] { return T(abs(r2[r])) > T(30 * unit_roundoff<T> * static_cast<double>(m)) * size; };
    for (Index k = 0; k < m; ++k) size += T(abs(A0_(k, r))) * T(abs(f[k]));
    if (!is_off()) continue;
    if constexpr (!ScalarTraits<T>::exact) {
      const Factor<T>& M = refinement_.factor_M();
      if (energy < T(0)) {
        M.half(f, r1, r2 + padded(m));
        energy = T(0);
        for (Index c = 0; c < M.columns(); ++c) energy += r1[c] * r1[c] / M.inverse_pivots()[c];
        if (asked.r1 != nullptr) of_r1 = M.energy(asked.r1, r2 + padded(m));
      }
      size += T(sqrt(hard_rows_.size(r))) * (T(sqrt(energy)) + T(sqrt(of_r1)));
    }
    if (is_off()) return {Status::inconsistent, r};
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
  if (!std::isfinite(wanted.error)) return solved(wanted);
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
         static_cast<Index>(sizeof(T)) * (2 * A0_.size() + 2 * lower_.size() + 3 * unit_.size() + sweep_work_->size()) +
         static_cast<Index>(sizeof(Index) * 2 * order_.size() + sizeof(Kind) * kinds_.size());
}

#define DELASSUS_INSTANTIATE(T)                              \
  template class KktEliminationWith<T, Dependent::left_out>; \
  template class KktEliminationWith<T, Dependent::refused>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
