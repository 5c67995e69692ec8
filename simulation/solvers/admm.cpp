#include "simulation/solvers/admm.h"

namespace delassus::simulation {

template <class T> void Admm<T>::do_analyze(const ContactProblem<T>& p) {
  for (VectorX<T>* const v : {&gamma_, &P_, &x_, &y_, &b_, &before_, &right_}) v->setZero(p.rows());
}

// γ per cone, so that the metric P is the Euclidean one within each. Cones that move nothing take the mean of the others.
template <class T> void Admm<T>::scale(const ContactProblem<T>& p) {
  const VectorX<T>& d = this->op_.diagonal();
  const T mean = p.rows() > 0 && d.sum() > T(0) ? T(d.sum() / T(static_cast<double>(p.rows()))) : T(1);
  for (const ConeRows& c : p.groups) {
    auto rows = gamma_.segment(c.row, c.rows);
    if (c.cone == Cone::coulomb) rows.setConstant(d.segment(c.row, c.rows).mean());
    else rows = d.segment(c.row, c.rows);
    for (T& g : rows)
      if (!(g > T(0))) g = mean;
  }
}

// Of D^(-½) A D^(-½), D = diag γ: similar to D⁻¹A.
template <class T> double Admm<T>::largest_eigenvalue() {
  VectorX<T>&x = x_, &y = before_;
  for (Index r = 0; r < x.size(); ++r) x[r] = T(1) + T(static_cast<double>((r * 7919) % 101) / 101);
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    this->op_.multiply(x.data(), y.data());
    y.array() /= gamma_.array();
    const double size = static_cast<double>(std::sqrt((y.array().square() * gamma_.array()).sum() / (x.array().square() * gamma_.array()).sum()));
    if (!(size > 0) || !std::isfinite(size)) break;
    largest = size;
    x = y / T(y.template lpNorm<Eigen::Infinity>());
  }
  return largest;
}

template <class T> Report Admm<T>::factored(double rho) {
  P_ = T(rho) * gamma_;
  return this->op_.factor(P_.data());
}

template <class T> Report Admm<T>::step(const ContactProblem<T>& p, VectorX<T>& z, Differences& d) {
  right_ = (P_.array() * z.array()).matrix() - y_ - b_;
  if (p.law == FrictionLaw::exact)
    for (const ConeRows& c : p.groups)
      if (c.cone == Cone::coulomb) right_[c.row] -= tangent_norm(y_.data() + c.row, p.friction.data() + c.row, c.rows);
  const Report solved = this->op_.solve(right_.data(), x_.data());
  before_ = z;
  z = x_ + (y_.array() / P_.array()).matrix();
  project_all(p, z.data());
  for (const ConeRows& c : p.groups)
    if (p.is_off(c)) x_.segment(c.row, c.rows).setZero();
  y_ += (P_.array() * (x_ - z).array()).matrix();
  d.primal = static_cast<double>((gamma_.array() * (x_ - z).array()).abs().maxCoeff());
  d.dual = static_cast<double>((P_.array() * (z - before_).array()).abs().maxCoeff());
  return solved;
}

template <class T> SolverReport Admm<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  SolverReport report;
  if (p.rows() == 0 || this->judged(p, lambda).natural <= wanted.velocity) return report;
  y_ = -this->u_;  // that of the warm start
  scale(p);
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    if (p.is_off(c)) y_.segment(c.row, c.rows).setZero();
    else if (c.cone == Cone::coulomb && p.law == FrictionLaw::exact) y_[c.row] -= tangent_norm(this->u_.data() + c.row, p.friction.data() + c.row, c.rows);
  }
  b_ = p.free_velocity - p.target;
  const double L = largest_eigenvalue(), kappa = 1e6;
  double power = 0.2, inner = wanted.velocity;
  const auto rho = [&] { return std::max(L, 1e-12) / std::sqrt(kappa) * std::pow(kappa, power); };
  Report made = factored(rho());
  Differences d;
  for (int since = 0; report.iterations < wanted.iterations; ++since) {
    if (made.status == Status::lost_pivot || made.status == Status::zero_damping) {
      report.status = made.status;
      report.where = static_cast<Index>(made.where);
      return report;
    }
    ++report.iterations;
    made = step(p, lambda, d);
    if (!std::isfinite(d.primal)) break;
    if (d.primal <= inner && d.dual <= inner) {
      if (this->judged(p, lambda).natural <= wanted.velocity) return report;
      inner = 0.3 * inner;
    }
    const double shift = d.primal > 10 * d.dual ? 0.05 : d.dual > 10 * d.primal ? -0.05 : 0;
    if (shift == 0 || since < 10) continue;
    since = 0;
    power = std::clamp(power + shift, 0.0, 1.2);
    made = factored(rho());
  }
  report.status = Status::not_converged;
  return report;
}

template class Admm<double>;

}  // namespace delassus::simulation
