#include "reference/contact_residual.h"

#include <cmath>

namespace delassus::reference {
namespace {

using simulation::Cone;
using simulation::ConeRows;
using simulation::ContactProblem;
using simulation::FrictionLaw;

bool off(const ContactProblem<double>& p, const ConeRows& c) { return std::isinf(p.R_inverse[static_cast<std::size_t>(c.row)]); }

template <class T> T larger(const T& a, const T& b) { return a < b ? b : a; }

template <class T> T length(const std::vector<T>& x, std::size_t from) {
  using std::sqrt;
  T square(0);
  for (std::size_t k = from; k < x.size(); ++k) square += x[k] * x[k];
  return sqrt(square);
}

// A contact in the plane of its normal and one direction, all coefficients equal to mu: the ray (1, mu) and its polar.
template <class T> std::vector<T> nearest_round(std::vector<T> x, const T& mu) {
  using std::sqrt;
  const T t = length(x, 1), n = x[0];
  if (t <= mu * n) return x;
  const T along = n + mu * t;  // times the length of the ray
  if (along <= T(0)) return std::vector<T>(x.size(), T(0));
  const T normal = along / (T(1) + mu * mu);
  for (std::size_t k = 1; k < x.size(); ++k) x[k] = t > T(0) ? x[k] / t * (mu * normal) : T(0);
  x[0] = normal;
  return x;
}

// Least distance to {λ_n = ν} for a given ν is that to an ellipse; the multiplier of both at once by bisection on s in λ_i = x_i/(1 + s/μ_i²).
template <class T> std::vector<T> nearest_elliptic(const std::vector<T>& x, const std::vector<T>& mu) {
  std::vector<T> scaled(x.size()), y(x.size());
  T inside(0), polar(0);
  using std::sqrt;
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (!(mu[k] > T(0))) continue;
    inside += (x[k] / mu[k]) * (x[k] / mu[k]);
    polar += x[k] * mu[k] * x[k] * mu[k];
  }
  if (sqrt(inside) <= x[0]) {
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = k == 0 || mu[k] > T(0) ? x[k] : T(0);
    return y;
  }
  if (sqrt(polar) <= -x[0]) return std::vector<T>(x.size(), T(0));
  const auto at = [&](const T& s) {
    T square(0);
    for (std::size_t k = 1; k < x.size(); ++k) {
      y[k] = mu[k] > T(0) ? x[k] / (T(1) + s / (mu[k] * mu[k])) : T(0);
      if (mu[k] > T(0)) square += (y[k] / mu[k]) * (y[k] / mu[k]);
    }
    y[0] = sqrt(square);               // on the cone
    return x[0] - (T(1) - s) * y[0];   // and the normal's own condition, increasing in s
  };
  T low(0), high(1);
  while (at(high) < T(0)) high = high * T(2);
  for (int k = 0; k < 240; ++k) {
    const T middle = low + (high - low) / T(2);
    (at(middle) < T(0) ? low : high) = middle;
  }
  static_cast<void>(at(high));
  return y;
}

template <class T> std::vector<T> nearest(const std::vector<T>& x, const std::vector<T>& mu) {
  for (std::size_t k = 2; k < x.size(); ++k)
    if (!(mu[k] == mu[1])) return nearest_elliptic(x, mu);
  return nearest_round(x, mu[1]);
}

template <class T> struct Parts {
  T natural{}, approach{}, cone{}, work{}, shift{};
};

template <class T> Parts<T> of_contact(std::vector<T> u, const std::vector<T>& lambda, const std::vector<T>& mu, const T& gamma, FrictionLaw law) {
  using std::abs;
  std::vector<T> weighed(u.size(), T(0)), moved, apart;
  for (std::size_t k = 1; k < u.size(); ++k) weighed[k] = mu[k] * u[k];
  const T gap = length(weighed, 1);
  Parts<T> r;
  if (lambda[0] > T(0)) r.shift = gap;
  if (law == FrictionLaw::exact) u[0] += gap;
  r.approach = larger(T(0), T(gap - u[0]));
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (k == 0 || mu[k] > T(0)) r.work += lambda[k] * u[k];
    moved.push_back(gamma > T(0) ? T(lambda[k] - u[k] / gamma) : lambda[k]);
  }
  r.work = abs(r.work);
  const auto point = nearest(moved, mu);
  for (std::size_t k = 0; k < u.size(); ++k) apart.push_back(lambda[k] - point[k]);
  r.natural = gamma > T(0) ? T(gamma * length(apart, 0)) : r.approach;
  // outside K: below the plane, beyond the ellipse along its own ray, off the tangents that have no friction
  T slope(0), reach(0), none(0);
  for (std::size_t k = 1; k < u.size(); ++k) {
    (mu[k] > T(0) ? reach : none) += lambda[k] * lambda[k];
    if (mu[k] > T(0)) slope += lambda[k] * lambda[k] / (mu[k] * mu[k]);
  }
  using std::sqrt;
  const T normal = larger(T(0), lambda[0]);
  r.cone = larger(T(-lambda[0]), sqrt(none));
  if (slope > normal * normal) r.cone = larger(r.cone, T(sqrt(reach) - sqrt(reach) * normal / sqrt(slope)));
  r.cone = larger(T(0), r.cone);
  return r;
}

template <class T> Parts<T> of_row(const T& u, const T& lambda, double low, double high, const T& gamma) {
  using std::abs;
  Parts<T> r;
  const auto clamped = [&](const T& x) {
    if (std::isfinite(low) && x < T(low)) return T(low);
    if (std::isfinite(high) && T(high) < x) return T(high);
    return x;
  };
  r.cone = abs(T(lambda - clamped(lambda)));
  const double bound = u > T(0) ? low : high;  // an impulse there is what this velocity asks for
  if (!(u == T(0))) {
    if (std::isfinite(bound)) r.work = abs(u) * abs(T(lambda - T(bound)));
    else r.approach = abs(u);
  }
  r.natural = gamma > T(0) ? T(gamma * abs(T(lambda - clamped(T(lambda - u / gamma))))) : r.approach;
  return r;
}

}  // namespace

template <class T> DenseContact<T>::DenseContact(const ContactProblem<double>& p) {
  if (!p.mechanism) {
    G.resize(p.G.rows(), p.G.cols());
    for (Index k = 0; k < p.G.size(); ++k) G.data()[k] = T(p.G.data()[k]);
    return;
  }
  const auto d = dense<T>(p.mechanism->cast<T>(), Damping<T>::uniform(p.rows(), T(0)));
  G = d.A0;
  M = d.M;
  J = d.J;
}

template <class T> VectorX<T> contact_velocity(const ContactProblem<double>& p, const DenseContact<T>& numbers, const VectorX<double>& lambda) {
  VectorX<T> u = VectorX<T>::Constant(p.rows(), T(0));
  for (const ConeRows& c : p.groups) {
    if (off(p, c)) continue;
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      T sum = T(p.free_velocity[r]) - T(p.target[r]) + T(p.R_inverse[static_cast<std::size_t>(r)]) * T(lambda[r]);
      for (const ConeRows& other : p.groups)
        if (!off(p, other))
          for (Index s = other.row; s < other.row + other.rows; ++s) sum += numbers.G(r, s) * T(lambda[s]);
      u[r] = sum;
    }
  }
  return u;
}

template <class T>
ContactResidual contact_residual(const ContactProblem<double>& p, const DenseContact<T>& numbers, const VectorX<double>& lambda, FrictionLaw law) {
  const VectorX<T> u = contact_velocity(p, numbers, lambda);
  ContactResidual all;
  const auto keep = [](double& largest, const T& x) {
    const auto value = static_cast<double>(x);
    if (!(value <= largest)) largest = value;
  };
  const auto take = [&](const Parts<T>& r) {
    keep(all.natural, r.natural);
    keep(all.approach, r.approach);
    keep(all.cone, r.cone);
    keep(all.work, r.work);
    keep(all.shift, r.shift);
  };
  const double none = std::numeric_limits<double>::infinity();
  for (const ConeRows& c : p.groups) {
    if (off(p, c)) continue;
    std::vector<T> cu, cl, cm;
    T gamma(0);
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const auto k = static_cast<std::size_t>(r);
      const T d = numbers.G(r, r) + T(p.R_inverse[k]);
      if (c.cone == Cone::free) take(of_row(u[r], T(lambda[r]), -none, none, d));
      else if (c.cone == Cone::half_line) take(of_row(u[r], T(lambda[r]), 0.0, none, d));
      else if (c.cone == Cone::box) take(of_row(u[r], T(lambda[r]), p.low[k], p.high[k], d));
      gamma += d / T(static_cast<double>(c.rows));
      cu.push_back(u[r]);
      cl.push_back(T(lambda[r]));
      cm.push_back(r == c.row ? T(0) : T(p.friction[k]));
    }
    if (c.cone == Cone::coulomb) take(of_contact(cu, cl, cm, gamma, law));
  }
  return all;
}

template <class T> double contact_momentum(const DenseContact<T>& numbers, const VectorX<double>& dv, const VectorX<double>& lambda) {
  double largest = 0;
  using std::abs;
  for (Index i = 0; i < dv.size(); ++i) {
    T sum(0);
    for (Index j = 0; j < dv.size(); ++j) sum += numbers.M(i, j) * T(dv[j]);
    for (Index r = 0; r < lambda.size(); ++r) sum -= numbers.J(r, i) * T(lambda[r]);
    largest = std::max(largest, static_cast<double>(abs(sum)));
  }
  return largest;
}

#define DELASSUS_INSTANTIATE(T)                                                                                            \
  template struct DenseContact<T>;                                                                                         \
  template ContactResidual contact_residual(const ContactProblem<double>&, const DenseContact<T>&, const VectorX<double>&, FrictionLaw); \
  template VectorX<T> contact_velocity(const ContactProblem<double>&, const DenseContact<T>&, const VectorX<double>&);       \
  template double contact_momentum(const DenseContact<T>&, const VectorX<double>&, const VectorX<double>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(Quad)

}  // namespace delassus::reference
