#include "algorithms/factors/refinement.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <limits>

namespace delassus {

template <class T> void Refinement<T>::analyze(std::shared_ptr<const Structure> structure, Mass mass) {
  structure_ = std::move(structure);
  residual_.analyze(structure_);
  weights_.analyze(*structure_);
  mass_ = mass;
  beside_ = false;
  if (mass_ == Mass::factored_elsewhere) return;
  plan_M_ = make_plan(*structure_, Matrix::M);
  factor_M_.analyze(*structure_, plan_M_);
}

template <class T> void Refinement<T>::analyze(std::shared_ptr<const Structure> structure, const Plan& plan, const Factor<T>& of_M_R) {
  analyze(std::move(structure), Mass::factored_elsewhere);
  mass_ = Mass::factored_here;
  beside_ = true;
  plan_M_ = mass_plan(*structure_, plan);
  factor_M_.analyze_beside(of_M_R, plan_M_);
}

template <class T> void Refinement<T>::update(const Problem<T>& problem) {
  residual_.update(problem);
  if (mass_ == Mass::factored_elsewhere) return;
  factored_M_ = beside_ ? factor_M_.start_beside() : factor_M_.start(problem);
  M_is_current_ = false;
}

template <class T> void Refinement<T>::update_rows(const Problem<T>& problem) {
  residual_.update_rows(problem);
  if (beside_) factor_M_.move_rows_beside();
  else if (mass_ == Mass::factored_here) factor_M_.move_rows(problem);
}

template <class T> Report Refinement<T>::factor_mass() const {
  if (M_is_current_.load(std::memory_order_acquire)) return factored_M_;
  const std::lock_guard lock(factoring_M_);
  if (M_is_current_) return factored_M_;
  if (factored_M_.ok()) factored_M_ = factor_M_.update_undamped();
  M_is_current_.store(true, std::memory_order_release);
  return factored_M_;
}

template <class T> void Refinement<T>::update_damping(const Damping<T>& damping) {
  residual_.update_damping(damping);
  invertible_ = weights_.assign_inverse(damping);
  stiffest_ = 0;
  if (!invertible_.ok()) return;
  const auto at = [this](const T& R) { stiffest_ = std::max(stiffest_, std::sqrt(std::abs(static_cast<double>(R)))); };
  Index e = 0;
  const auto look = [&](Index row, Index rows) {
    const T* const block = weights_.dense(e++);
    for (Index r = 0; r < rows; ++r) at(block != nullptr ? block[r * rows + r] : weights_.diagonal(row + r));
  };
  for (const auto& c : structure_->link_constraints) look(c.row, c.rows);
  for (const auto& c : structure_->joint_constraints) look(c.row, c.rows);
}

namespace {
// xᵀ y
template <class Products, class X> Products inner(const X* x, const X* y, Index n) {
  if constexpr (std::is_same_v<Products, X>) return dot(x, y, n);
  else {
    Products sum(0);
    for (Index k = 0; k < n; ++k) sum += Products(x[k]) * Products(y[k]);
    return sum;
  }
}

template <class X> double magnitude(const X& x) { return std::abs(static_cast<double>(x)); }

// The larger one; b when it is not a number.
double larger(double a, double b) { return b <= a ? a : b; }

// By how much a correction is smaller than the one before it, at most 1.
double contraction(double now, double before) { return now < before ? now / before : now == 0 ? 0 : 1; }

double relative(double x, double to) { return x == 0 ? 0 : x / to; }
}  // namespace

template <class T> template <class X> auto Refinement<T>::energy_of(const Buffers<X>& b) -> ProductsOf<X> {
  using P = ProductsOf<X>;
  P sum = inner<P>(b.f, b.a, b.m);
  for (Index c = 0; c < b.n && b.r1_0 != nullptr; ++c) sum += P(narrow<X>(b.nu[c])) * P(b.r1_0[c]);
  return sum;
}

template <class T> template <class X> void Refinement<T>::take(Buffers<X>& b, const AskedOf<X>& asked) {
  std::copy(asked.nu, asked.nu + b.n, b.nu);
  std::copy(asked.lambda, asked.lambda + b.m, b.lambda);
  std::copy(asked.lambda, asked.lambda + b.m, b.f);
}

// (ν, λ) = (δν, δλ): the first evaluation is the correction from zero. r₁ᵀδν is 0 or not finite.
template <class T> template <class X> void Refinement<T>::start(Buffers<X>& b, Columns<X>& columns) const {
  using P = ProductsOf<X>;
  std::copy(b.d_nu, b.d_nu + b.n, b.nu);
  std::copy(b.d_lambda, b.d_lambda + b.m, b.lambda);
  std::copy(b.d_lambda, b.d_lambda + b.m, b.f);
  const P energy = inner<P>(b.r1, b.d_nu, b.n) + inner<P>(b.a, b.f, b.m);
  const auto motion = largest_magnitudes(b.d_nu, b.n), force = largest_magnitudes(b.d_lambda, b.m);
  for (int l = 0; l < columns_in<X>; ++l) {
    Progress& now = columns[l].now;
    now.size = std::isfinite(magnitude(lane(energy, l))) ? 1 : std::numeric_limits<double>::quiet_NaN();
    now.motion = motion[l];
    now.force = force[l];
  }
}

// ν += δν, λ += δλ, and what they say about the error before and after.
template <class T> template <class X> void Refinement<T>::advance(Buffers<X>& b, Columns<X>& columns) const {
  using P = ProductsOf<X>;
  for (Index c = 0; c < b.n; ++c) b.nu[c] += Wide<X>(b.d_nu[c]);
  for (Index r = 0; r < b.m; ++r) {
    b.lambda[r] += Wide<X>(b.d_lambda[r]);
    b.f[r] = narrow<X>(b.lambda[r]);
  }
  if (invertible_.ok()) weights_.multiply(b.r2, b.scratch);
  else std::copy(b.d_lambda, b.d_lambda + b.m, b.scratch);
  const auto largest = largest_magnitudes(b.f, b.m), at_stake = largest_magnitudes(b.scratch, b.m);  // max|λ|, max|R r₂|
  const auto motion = largest_magnitudes(b.d_nu, b.n), force = largest_magnitudes(b.d_lambda, b.m);
  const P gained_energy = inner<P>(b.r1, b.d_nu, b.n) + inner<P>(b.r2, b.d_lambda, b.m), total = energy_of(b);
  for (int l = 0; l < columns_in<X>; ++l) {
    Progress now;
    const Progress& before = columns[l].before;
    now.motion = motion[l];
    now.force = force[l];
    now.energy = relative(std::sqrt(magnitude(lane(gained_energy, l))), std::sqrt(magnitude(lane(total, l))));
    now.size = larger(relative(now.force, largest[l]), now.energy);
    const double rho = larger(larger(contraction(now.motion, before.motion), contraction(now.force, before.force)),
                              contraction(now.energy, before.energy));
    const double gained = larger(relative(at_stake[l], largest[l]), now.size <= 4 * unit_roundoff<T> ? 0 : now.size);
    now.expected = gained == 0 ? 0 : gained * rho / (1 - rho);  // of this and all further corrections
    if (!invertible_.ok() && now.size > 4 * unit_roundoff<T>) now.expected = larger(now.expected, now.size);  // ρ is no more than a guess
    const double by_luck = std::min(relative(at_stake[l], largest[l]), rho * before.size);  // a correction may round to 0
    now.patient = larger(now.size == 0 ? 0 : now.size * larger(1, rho / (1 - rho)), by_luck);
    columns[l].now = now;
  }
}

template <class T> template <class X> std::array<int, columns_in<X>> Refinement<T>::scale(const X* from, X* to, Index n) {
  std::array<int, columns_in<X>> exponent{};
  if constexpr (!ScalarTraits<T>::exact) {
    const auto largest = largest_magnitudes(from, n);
    for (int l = 0; l < columns_in<X>; ++l) static_cast<void>(std::frexp(largest[l], &exponent[l]));
  }
  X first{}, second{};  // 2^(−e) itself may be beyond the scalar
  for (int l = 0; l < columns_in<X>; ++l) {
    const int half = exponent[l] / 2;
    set_lane(first, l, T(std::ldexp(1.0, -half)));
    set_lane(second, l, T(std::ldexp(1.0, half - exponent[l])));
  }
  const bool as_it_is = exponent == std::array<int, columns_in<X>>{};
  for (Index k = 0; k < n; ++k) to[k] = as_it_is ? from[k] : X(X(from[k] * first) * second);
  return exponent;
}

// r₂ᵀR r₂, of r₂ as scaled
template <class T> template <class X> std::optional<X> Refinement<T>::soft_rows(Buffers<X>& b) const {
  weights_.multiply(b.d_lambda, b.scratch);
  return dot(b.d_lambda, b.scratch, b.m);
}

// B relative to the energy norm e of the solution, of which only s = νᵀr₁⁰ + λᵀr₂⁰ of the iterate is known: e (e + B) ≥ s.
template <class T>
template <class X>
void Refinement<T>::bound(const Buffers<X>& b, const Square<X>& motion, const Square<X>& rows, Columns<X>& columns) const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto root = [](const Square<X>& x, int l) { return std::ldexp(std::sqrt(magnitude(lane(x.value, l))), x.exponent[l]); };
  const auto energy = energy_of(b);
  const auto forces = largest_magnitudes(b.f, b.m), at_motion = largest_magnitudes(b.r1, b.n), at_rows = largest_magnitudes(b.r2, b.m);
  for (int l = 0; l < columns_in<X>; ++l) {
    const double of_motion = root(motion, l), of_rows = root(rows, l);
    const double bound = invertible_.ok() ? std::hypot(of_motion, of_rows) : of_motion + of_rows;
    const double s = static_cast<double>(lane(energy, l));
    const bool lost = (of_motion == 0 && at_motion[l] > 0) || (of_rows == 0 && invertible_.ok() && at_rows[l] > 0);
    const double t = relative(bound, std::sqrt(s));
    if (lost || (bound > 0 && !(s > 0))) columns[l].certificate = {infinite, infinite};
    else
      columns[l].certificate = {t * (t + std::sqrt(t * t + 4)) / 2 + 2 * unit_roundoff<T>,
                                invertible_.ok() ? relative(stiffest_ * bound, forces[l]) : infinite};
  }
}

template <class T> Index Refinement<T>::workspace(Index of_correction) const {
  return Buffers<T>::size(*structure_) + std::max({mass_ == Mass::factored_here ? factor_M_.solve_workspace() : 0, residual_.workspace(), of_correction});
}

template <class T> Index Refinement<T>::bytes() const {
  return residual_.bytes() + plan_M_.bytes() + factor_M_.bytes() + weights_.bytes();
}

#define DELASSUS_INSTANTIATE_FOR(T, X)                                                                 \
  template void Refinement<T>::start(Buffers<X>&, Columns<X>&) const;                                  \
  template void Refinement<T>::advance(Buffers<X>&, Columns<X>&) const;                                \
  template void Refinement<T>::take(Buffers<X>&, const AskedOf<X>&);                                   \
  template std::array<int, columns_in<X>> Refinement<T>::scale(const X*, X*, Index);                        \
  template std::optional<X> Refinement<T>::soft_rows(Buffers<X>&) const;                               \
  template void Refinement<T>::bound(const Buffers<X>&, const Square<X>&, const Square<X>&, Columns<X>&) const;
#define DELASSUS_INSTANTIATE(T) template class Refinement<T>; DELASSUS_INSTANTIATE_FOR(T, T)
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifndef DELASSUS_EXACT
DELASSUS_INSTANTIATE_FOR(double, Lanes8)
#endif

}  // namespace delassus
