#include "simulation/solvers/proximal.h"

#include <cmath>

namespace delassus::simulation {

template <class T> void ProximalNewton<T>::do_analyze(const ContactProblem<T>& p) {
  if (p.mechanism) newton_.analyze(p);
  gamma_.analyze(p);
  for (VectorX<T>* const v : {&R_inverse_, &b_, &x_, &before_}) v->setZero(p.rows());
}

// b = (G λ + g − target + Γ e_n) − E λ of the last λ: its velocity u + Γ e_n − (R⁻¹ + E) λ.
template <class T> void ProximalNewton<T>::expand(const ContactProblem<T>& p, const VectorX<T>& lambda) {
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    b_.segment(c.row, c.rows).setZero();
    x_.segment(c.row, c.rows).setZero();
    if (p.is_off(c)) continue;
    b_[c.row] = gamma_[e];
    const T gamma = this->op_.diagonal().segment(c.row, c.rows).mean();
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      b_[r] += this->u_[r];
      x_[r] = gamma > T(0) ? T(lambda[r] - b_[r] / gamma) : lambda[r];
      b_[r] -= R_inverse_[r] * lambda[r];
    }
  }
}

// R⁻¹ + E, E per cone.
template <class T> void ProximalNewton<T>::shift(const ContactProblem<T>& p, double epsilon) {
  const VectorX<T>& d = this->op_.diagonal();
  const T mean = p.rows() > 0 && d.sum() > T(0) ? T(d.sum() / T(static_cast<double>(p.rows()))) : T(1);
  for (const ConeRows& c : p.groups) {
    const T gamma = d.segment(c.row, c.rows).mean();
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const T& given = p.R_inverse[static_cast<std::size_t>(r)];
      const T wanted = T(epsilon) * (gamma > T(0) ? gamma : mean);
      R_inverse_[r] = given < wanted ? T(given + wanted) : given;
    }
  }
}

// The next ε: see the header.
template <class T> void ProximalNewton<T>::Weight::follow(double reached, int inner) {
  const bool grew = reached >= 1.25 * before_, stuck = reached >= 0.9 * before_, easy = inner <= 2, at_least = epsilon <= 2 * least_;
  if ((grew || (stuck && at_least)) && epsilon < first_epsilon) {
    epsilon = 10 * epsilon;
    if (++risen_ > 3) least_ = epsilon;
  } else if (!grew && (easy ? 50 : 2) * reached > before_) {
    if (stuck && at_least) least_ = possible_, risen_ = 0;
    if (epsilon > 2 * least_) epsilon = std::max(least_, epsilon / (easy ? 100 : 10));
  }
  before_ = reached;
}

// How Γ goes on: see the header.
template <class T> typename ProximalNewton<T>::Steps::Next ProximalNewton<T>::Steps::after(double reached, Index sliding, bool settled) {
  if (made_ > 0 && !(reached < before_)) {
    if (share == 1 && made_ < watched) return ++made_, Next::newton;
    share = std::max(least_share, share / 4);
    made_ = 0;
    return Next::back;
  }
  const double points = 1 + solve_of_a_point * static_cast<double>(sliding);  // that a step of Newton costs
  const double fell = reached / before_;
  const bool slow = made_ > 0 || (sliding > 0 && (fell > 0.5 || (settled && std::pow(fell, points) > gained)));
  if (made_ > 0) share = std::min(1.0, 2 * share);
  before_ = reached;
  made_ = slow ? 1 : 0;
  return slow ? Next::first : Next::plain;
}

template <class T> SolverReport ProximalNewton<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  using Next = typename Steps::Next;
  SolverReport report;
  Report made = newton_.start(p, this->op_.tree());
  Weight weight;
  Steps steps;
  typename PrimalNewton<T>::Outcome inner;
  while (made.ok()) {
    double reached = this->judged(p, lambda).natural;
    if (reached <= wanted.velocity) return report;
    if (report.iterations >= wanted.iterations) break;
    const Next next = p.law == FrictionLaw::exact ? steps.after(reached, gamma_.sliding(p, newton_), inner.iterations <= 2) : Next::plain;
    if (next == Next::plain || next == Next::first) weight.follow(reached, inner.iterations);
    if (next == Next::first) saved_ = lambda;
    if (next == Next::back) {
      lambda = saved_;
      reached = this->judged(p, lambda).natural;
    }
    const bool newton = next == Next::first || next == Next::newton;
    if (!newton || !gamma_.newton(p, newton_, R_inverse_, lambda, this->u_, steps.share).ok()) {
      gamma_.plain(p, this->u_);
      if (newton) steps.stop();
    }
    shift(p, weight.epsilon);
    before_ = lambda;
    expand(p, lambda);
    made = newton_.begin_from(lambda, x_, R_inverse_, b_);
    ++report.iterations;
    if (made.ok()) {
      inner = newton_.minimise(R_inverse_, b_, inexact * weight.epsilon * std::max(wanted.velocity, reached), wanted.iterations - report.iterations, lambda);
      report.iterations += inner.iterations;
      made = inner.report;
    }
    if (made.status == Status::lost_pivot && weight.epsilon < 1) {
      lambda = before_;
      made = {};
      steps.stop();
      weight.rise();
    }
  }
  report.status = made.ok() ? Status::not_converged : made.status;
  report.where = static_cast<Index>(made.where);
  return report;
}

template class ProximalNewton<double>;

}  // namespace delassus::simulation
