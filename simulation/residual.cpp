#include "simulation/residual.h"

#include "algorithms/kit/quad.h"

namespace delassus::simulation {
namespace {

template <class T> struct Cell {
  T natural{}, penetration{}, cone{}, complementarity{};
};

// One row with bounds; ∓∞ where there is none.
template <class T> Cell<T> of_row(const T& lambda, const T& u, const T& low, const T& high, const T& gamma) {
  using std::abs;
  Cell<T> r;
  if (gamma > T(0)) r.natural = gamma * abs(lambda - std::min(std::max(T(lambda - u / gamma), low), high));
  else if (lambda > low && u > T(0)) r.natural = is_finite(low) ? T(0) : u;  // an impulse that moves nothing may be any
  else if (lambda < high && u < T(0)) r.natural = is_finite(high) ? T(0) : T(-u);
  r.cone = std::max(T(0), std::max(T(low - lambda), T(lambda - high)));
  const T beyond = u > T(0) ? T(lambda - low) : T(high - lambda);  // the way to the bound that this velocity asks for
  if (is_finite(u > T(0) ? low : high)) r.complementarity = abs(u) * abs(beyond);
  else r.penetration = abs(u);
  return r;
}

template <class T> Cell<T> of_contact(const ContactProblem<T>& p, const ConeRows& c, const T* lambda, const T* u, const T& gamma) {
  using std::abs;
  using std::sqrt;
  const T* const mu = p.friction.data() + c.row;
  T shifted[max_cone_rows], x[max_cone_rows], pairing(0), square(0);
  std::copy(u, u + c.rows, shifted);
  if (p.law == FrictionLaw::exact) shifted[0] += tangent_norm(u, mu, c.rows);
  for (Index k = 0; k < c.rows; ++k) {
    x[k] = lambda[k] - (gamma > T(0) ? T(shifted[k] / gamma) : T(0));
    if (k == 0 || mu[k] > T(0)) pairing += lambda[k] * shifted[k];
  }
  ConeProjection<T>::project(x, mu, c.rows);
  for (Index k = 0; k < c.rows; ++k) square += (lambda[k] - x[k]) * (lambda[k] - x[k]);
  const T defect = dual_defect(shifted, mu, c.rows);
  return {gamma > T(0) ? T(gamma * sqrt(square)) : defect, defect, cone_defect(lambda, mu, c.rows), abs(pairing)};
}

void keep(double& largest, double x) {
  if (!(x <= largest)) largest = x;  // NaN stays
}

template <class T> void take(Residuals& all, const Cell<T>& cell, Index group) {
  const auto natural = static_cast<double>(cell.natural);
  if (!(natural <= all.natural) && !(all.natural != all.natural)) {
    all.natural = natural;
    all.worst = group;
  }
  keep(all.penetration, static_cast<double>(cell.penetration));
  keep(all.cone, static_cast<double>(cell.cone));
  keep(all.complementarity, static_cast<double>(cell.complementarity));
}

}  // namespace

template <class T> Residuals residuals(const ContactProblem<T>& p, const T* lambda, const T* u, const T* diagonal) {
  const T infinity = ScalarTraits<T>::infinity();
  Residuals all;
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    if (p.is_off(c)) continue;
    const auto group = static_cast<Index>(e);
    if (c.cone == Cone::coulomb) {
      T gamma(0);
      for (Index k = 0; k < c.rows; ++k) gamma += diagonal[c.row + k] / T(static_cast<double>(c.rows));
      take(all, of_contact(p, c, lambda + c.row, u + c.row, gamma), group);
      continue;
    }
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const auto k = static_cast<std::size_t>(r);
      const T low = c.cone == Cone::box ? p.low[k] : c.cone == Cone::free ? T(-infinity) : T(0);
      take(all, of_row(lambda[r], u[r], low, c.cone == Cone::box ? p.high[k] : infinity, diagonal[r]), group);
    }
  }
  return all;
}

template Residuals residuals<double>(const ContactProblem<double>&, const double*, const double*, const double*);
template Residuals residuals<Quad>(const ContactProblem<Quad>&, const Quad*, const Quad*, const Quad*);

}  // namespace delassus::simulation
