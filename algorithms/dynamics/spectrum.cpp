#include "algorithms/dynamics/spectrum.h"

#include <algorithm>
#include <cmath>

#include "algorithms/dynamics/delassus_blocks.h"
#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> struct Spectrum<T>::Numbers {
  std::shared_ptr<const Structure> structure;
  DelassusBlocks<T> blocks;
  Plan plan;
  Factor<T> factor;
  BlockDiagonal<T> weights;
  VectorX<T> diagonal;
  Report regular;
  bool updated = false;

  explicit Numbers(std::shared_ptr<const Structure> s) : structure(s), blocks(std::move(s)), plan(make_plan(*structure, Matrix::M_R)) {
    factor.analyze(*structure, plan);
    weights.analyze(*structure);
    diagonal.setZero(structure->rows);
  }

  /// −1: not to be told at this μ.
  Index negative_pivots(double mu) {
    weights.assign(T(-1) / scalar_cast<T>(mu));
    static_cast<void>(factor.update_weights(weights));  // pivots are meant to be lost
    Index negative = 0;
    for (Index c = 0; c < factor.columns(); ++c) {
      using std::isfinite;
      const T& inverse = factor.inverse_pivots()[c];
      if (inverse == T(0) || !isfinite(inverse)) return -1;
      negative += inverse < T(0) ? 1 : 0;
    }
    return negative;
  }

  /// A count at μ, or a little above it.
  Index count(double& mu) {
    for (int tried = 0; tried < 8; ++tried, mu *= 1 + 0x1p-40)
      if (const Index above = negative_pivots(mu); above >= 0) return above;
    return -1;
  }
};

template <class T> Spectrum<T>::Spectrum(std::shared_ptr<const Structure> structure) {
  require(structure != nullptr, "Spectrum: no structure");
  own_ = std::make_unique<Numbers>(std::move(structure));
}
template <class T> Spectrum<T>::Spectrum(Spectrum&&) noexcept = default;
template <class T> Spectrum<T>::~Spectrum() = default;

template <class T> Report Spectrum<T>::update(const Problem<T>& problem) {
  Numbers& own = *own_;
  own.regular = own.blocks.update(problem);
  if (own.regular.ok()) own.regular = own.blocks.diagonal(own.diagonal);
  if (own.regular.ok()) own.regular = own.factor.start(problem);
  own.updated = true;
  return own.regular;
}

template <class T> Report Spectrum<T>::count_above(double mu, Index& count) {
  Numbers& own = *own_;
  require(own.updated, "Spectrum: call update first");
  require(mu > 0 && std::isfinite(mu), "Spectrum::count_above: μ must be above 0");
  if (!own.regular.ok()) return own.regular;
  count = own.negative_pivots(mu);
  return count < 0 ? Report{Status::lost_pivot, 0} : Report{};
}

// Invariant: λ_k ≤ upper, and λ_k > lower or lower = 0.
template <class T> Report Spectrum<T>::eigenvalue(Index k, double width, Interval& interval) {
  Numbers& own = *own_;
  require(own.updated, "Spectrum: call update first");
  require(k >= 0 && k < own.structure->rows, "Spectrum::eigenvalue: there is no such eigenvalue");
  require(width > 0, "Spectrum::eigenvalue: the width must be above 0");
  interval = {};
  if (!own.regular.ok()) return own.regular;
  double trace = 0;
  for (Index r = 0; r < own.diagonal.size(); ++r) trace += static_cast<double>(own.diagonal[r]);
  const double floor = 0x1p-53 * trace;
  interval.upper = trace * (1 + 0x1p-40);  // of rounding
  double step = 16;                        // down from the trace, in ever larger steps, until λ_k is passed
  while (interval.lower == 0 && interval.upper > floor) {
    double mu = std::max(interval.upper / step, floor);
    const Index above = own.count(mu);
    if (above < 0) return {Status::lost_pivot, 0};
    if (above > k) interval.lower = mu;
    else interval.upper = mu;
    step *= step;
  }
  while (interval.lower > 0 && interval.upper > (1 + width) * interval.lower) {
    double mu = std::sqrt(interval.lower) * std::sqrt(interval.upper);
    if (!(interval.lower < mu && mu < interval.upper)) break;  // neighbours in double
    const Index above = own.count(mu);
    if (above < 0) return {Status::lost_pivot, 0};
    (above > k ? interval.lower : interval.upper) = mu;
  }
  return {};
}

template <class T> Report Spectrum<T>::smallest(double width, Interval& interval) { return eigenvalue(own_->structure->rows - 1, width, interval); }

#define DELASSUS_INSTANTIATE(T) template class Spectrum<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
