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
  if (mass_ == Mass::factored_elsewhere) return;
  plan_M_ = make_plan(*structure_, Matrix::M);
  factor_M_.analyze(*structure_, plan_M_);
}

template <class T> void Refinement<T>::update(const Problem<T>& problem) {
  residual_.update(problem);
  if (mass_ == Mass::factored_elsewhere) return;
  factored_M_ = factor_M_.start(problem);
  M_is_current_ = false;
}

template <class T> void Refinement<T>::update_rows(const Problem<T>& problem) {
  residual_.update_rows(problem);
  if (mass_ == Mass::factored_here) factor_M_.move_rows(problem);
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
template <class Products, class T> Products inner(const T* x, const T* y, Index n) {
  if constexpr (std::is_same_v<Products, T>) return dot(x, y, n);
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

template <class T> typename Refinement<T>::Products Refinement<T>::energy_of(const Buffers& b) {
  Products sum = inner<Products>(b.f, b.a, b.m);
  for (Index c = 0; c < b.n && b.r1_0 != nullptr; ++c) sum += Products(narrow<T>(b.nu[c])) * Products(b.r1_0[c]);
  return sum;
}

template <class T> void Refinement<T>::take(Buffers& b, const Asked& asked) {
  std::copy(asked.nu, asked.nu + b.n, b.nu);
  std::copy(asked.lambda, asked.lambda + b.m, b.lambda);
  std::copy(asked.lambda, asked.lambda + b.m, b.f);
}

// (ν, λ) = (δν, δλ): the first evaluation is the correction from zero. r₁ᵀδν is 0 or not finite.
template <class T> typename Refinement<T>::Progress Refinement<T>::start(Buffers& b) const {
  std::copy(b.d_nu, b.d_nu + b.n, b.nu);
  std::copy(b.d_lambda, b.d_lambda + b.m, b.lambda);
  std::copy(b.d_lambda, b.d_lambda + b.m, b.f);
  Progress now;
  now.size = std::isfinite(magnitude(Products(inner<Products>(b.r1, b.d_nu, b.n) + inner<Products>(b.a, b.f, b.m)))) ? 1 : std::numeric_limits<double>::quiet_NaN();
  now.motion = largest_magnitude(b.d_nu, b.n);
  now.force = largest_magnitude(b.d_lambda, b.m);
  return now;
}

// ν += δν, λ += δλ, and what they say about the error before and after.
template <class T> typename Refinement<T>::Progress Refinement<T>::advance(Buffers& b, const Progress& before) const {
  for (Index c = 0; c < b.n; ++c) b.nu[c] += W(b.d_nu[c]);
  for (Index r = 0; r < b.m; ++r) {
    b.lambda[r] += W(b.d_lambda[r]);
    b.f[r] = narrow<T>(b.lambda[r]);
  }
  if (invertible_.ok()) weights_.multiply(b.r2, b.scratch);
  else std::copy(b.d_lambda, b.d_lambda + b.m, b.scratch);
  const double largest = largest_magnitude(b.f, b.m), at_stake = largest_magnitude(b.scratch, b.m);  // max|λ|, max|R r₂|
  const Products gained_energy = inner<Products>(b.r1, b.d_nu, b.n) + inner<Products>(b.r2, b.d_lambda, b.m), total = energy_of(b);

  Progress now;
  now.motion = largest_magnitude(b.d_nu, b.n);
  now.force = largest_magnitude(b.d_lambda, b.m);
  now.energy = relative(std::sqrt(magnitude(gained_energy)), std::sqrt(magnitude(total)));
  now.size = larger(relative(now.force, largest), now.energy);
  const double rho = larger(larger(contraction(now.motion, before.motion), contraction(now.force, before.force)),
                            contraction(now.energy, before.energy));
  const double gained = larger(relative(at_stake, largest), now.size <= 4 * unit_roundoff<T> ? 0 : now.size);
  now.expected = gained == 0 ? 0 : gained * rho / (1 - rho);  // of this and all further corrections
  if (!invertible_.ok() && now.size > 4 * unit_roundoff<T>) now.expected = larger(now.expected, now.size);  // ρ is no more than a guess
  now.patient = now.size == 0 ? 0 : now.size * larger(1, rho / (1 - rho));
  return now;
}

template <class T> int Refinement<T>::scale(const T* from, T* to, Index n) {
  int exponent = 0;
  if constexpr (!ScalarTraits<T>::exact) static_cast<void>(std::frexp(largest_magnitude(from, n), &exponent));
  const auto scaled = [&](const T& x, int e) { return T(x * T(std::ldexp(1.0, e))); };
  const int half = exponent / 2;  // 2^(−e) itself may be beyond the scalar
  for (Index k = 0; k < n; ++k) to[k] = exponent == 0 ? from[k] : scaled(scaled(from[k], -half), half - exponent);
  return exponent;
}

// r₂ᵀR r₂, of r₂ as scaled
template <class T> std::optional<T> Refinement<T>::soft_rows(Buffers& b) const {
  weights_.multiply(b.d_lambda, b.scratch);
  return dot(b.d_lambda, b.scratch, b.m);
}

// B relative to the energy norm e of the solution, of which only s = νᵀr₁⁰ + λᵀr₂⁰ of the iterate is known: e (e + B) ≥ s.
template <class T>
typename Refinement<T>::Certificate Refinement<T>::bound(const Buffers& b, const Square& motion, const Square& rows) const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto root = [](const Square& x) { return std::ldexp(std::sqrt(magnitude(x.value)), x.exponent); };
  const double of_motion = root(motion), of_rows = root(rows);
  const double bound = invertible_.ok() ? std::hypot(of_motion, of_rows) : of_motion + of_rows;
  const double s = static_cast<double>(energy_of(b)), largest = largest_magnitude(b.f, b.m);
  if (bound > 0 && !(s > 0)) return {infinite, infinite};
  const double at_rows = invertible_.ok() ? largest_magnitude(b.r2, b.m) : 0;
  if ((of_motion == 0 && largest_magnitude(b.r1, b.n) > 0) || (of_rows == 0 && at_rows > 0))  // lost
    return {infinite, infinite};
  const double t = relative(bound, std::sqrt(s));
  return {t * (t + std::sqrt(t * t + 4)) / 2 + 2 * unit_roundoff<T>, invertible_.ok() ? relative(stiffest_ * bound, largest) : infinite};
}

template <class T> Index Refinement<T>::workspace(Index of_correction) const {
  return Buffers::size(*structure_) + std::max({mass_ == Mass::factored_here ? factor_M_.solve_workspace() : 0, residual_.workspace(), of_correction});
}

template <class T> Index Refinement<T>::bytes() const {
  return residual_.bytes() + plan_M_.bytes() + factor_M_.bytes() + weights_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class Refinement<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
