#include "algorithms/refinement.h"

#include <algorithm>
#include <limits>

namespace delassus {

template <class T> void Refinement<T>::analyze(std::shared_ptr<const Structure> structure) {
  structure_ = std::move(structure);
  residual_.analyze(structure_);
  plan_M_ = make_plan(*structure_, Matrix::M, Branches::all);
  factor_M_.analyze(*structure_, plan_M_);
  weights_.analyze(*structure_);
}

template <class T> Report Refinement<T>::update(const Problem<T>& problem) {
  residual_.update(problem);
  const Report started = factor_M_.start(problem);
  return started.ok() ? factor_M_.update_undamped() : started;
}

template <class T> void Refinement<T>::update_damping(const Damping<T>& damping) {
  residual_.update_damping(damping);
  invertible_ = weights_.assign_inverse(damping);
}

namespace {
template <class X> double magnitude(const X& x) { return std::abs(static_cast<double>(x)); }

// The larger one; a NaN is kept.
double larger(double a, double b) { return b <= a ? a : b; }

// By how much a correction is smaller than the one before it, at most 1.
double contraction(double now, double before) { return now < before ? now / before : now == 0 ? 0 : 1; }

double relative(double x, double to) { return x == 0 ? 0 : x / to; }
}  // namespace

// ν += δν, λ += δλ, and what they say about the error before and after.
template <class T> typename Refinement<T>::Progress Refinement<T>::advance(Buffers& b, const Progress& before) const {
  Progress now;
  T energy(0), total(0);  // r₁ᵀδν + r₂ᵀδλ and λᵀa
  for (Index c = 0; c < b.n; ++c) {
    b.nu[c] += W(b.d_nu[c]);
    energy += b.r1[c] * b.d_nu[c];
    now.motion = larger(now.motion, magnitude(b.d_nu[c]));
  }
  double largest = 0, at_stake = 0;  // max|λ|, max|R r₂|
  if (invertible_.ok()) weights_.multiply(b.r2, b.scratch);
  else std::copy(b.d_lambda, b.d_lambda + b.m, b.scratch);
  for (Index r = 0; r < b.m; ++r) {
    b.lambda[r] += W(b.d_lambda[r]);
    energy += b.r2[r] * b.d_lambda[r];
    total += narrow<T>(b.lambda[r]) * b.a[r];
    largest = larger(largest, magnitude(b.lambda[r]));
    now.force = larger(now.force, magnitude(b.d_lambda[r]));
    at_stake = larger(at_stake, magnitude(b.scratch[r]));
  }
  now.energy = relative(std::sqrt(magnitude(energy)), std::sqrt(magnitude(total)));
  now.size = larger(relative(now.force, largest), now.energy);
  const double rho = larger(larger(contraction(now.motion, before.motion), contraction(now.force, before.force)),
                            contraction(now.energy, before.energy));
  const double gained = larger(relative(at_stake, largest), now.size <= 4 * unit_roundoff<T> ? 0 : now.size);
  now.expected = gained == 0 ? 0 : gained * rho / (1 - rho);  // of this and all further corrections
  now.patient = now.size == 0 ? 0 : now.size * larger(1, rho / (1 - rho));
  return now;
}

// B relative to ‖λ‖_A = √(λᵀa) of the solution, of which only s = λᵀa of the iterate is known: ‖λ‖_A (‖λ‖_A + B) ≥ s.
template <class T> double Refinement<T>::certify(Buffers& b) const {
  if (!invertible_.ok()) return -1;
  weights_.multiply(b.r2, b.scratch);
  T squared(0), total(0);
  for (Index r = 0; r < b.m; ++r) {
    squared += b.r2[r] * b.scratch[r];
    total += narrow<T>(b.lambda[r]) * b.a[r];
    b.scratch[r] = T(0);
  }
  squared += factor_M_.solve(b.scratch, b.r1, nullptr, nullptr, b.rest);
  const double bound = std::sqrt(magnitude(squared)), s = static_cast<double>(total);
  if (bound > 0 && !(s > 0)) return std::numeric_limits<double>::infinity();
  const double t = relative(bound, std::sqrt(s));
  return t * (t + std::sqrt(t * t + 4)) / 2 + 2 * unit_roundoff<T>;
}

template <class T> Index Refinement<T>::workspace(Index of_correction) const {
  return Buffers::size(*structure_) + std::max({factor_M_.workspace(), residual_.workspace(), of_correction});
}

template <class T> Index Refinement<T>::bytes() const {
  return residual_.bytes() + plan_M_.bytes() + factor_M_.bytes() + weights_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class Refinement<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
