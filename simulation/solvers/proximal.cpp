#include "simulation/solvers/proximal.h"

namespace delassus::simulation {

template <class T> void ProximalNewton<T>::do_analyze(const ContactProblem<T>& p) {
  if (p.mechanism) newton_.analyze(p);
  for (VectorX<T>* const v : {&R_inverse_, &b_, &before_}) v->setZero(p.rows());
}

// b = (G λ + g − target + Γ e_n) − E λ of the last λ: its velocity u + Γ e_n − (R⁻¹ + E) λ.
template <class T> void ProximalNewton<T>::expand(const ContactProblem<T>& p, const VectorX<T>& lambda) {
  for (const ConeRows& c : p.groups) {
    if (p.is_off(c)) {
      b_.segment(c.row, c.rows).setZero();
      continue;
    }
    for (Index r = c.row; r < c.row + c.rows; ++r) b_[r] = this->u_[r] - R_inverse_[r] * lambda[r];
    if (c.cone == Cone::coulomb && p.law == FrictionLaw::exact) b_[c.row] += tangent_norm(this->u_.data() + c.row, p.friction.data() + c.row, c.rows);
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

template <class T> SolverReport ProximalNewton<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  SolverReport report;
  Report made = newton_.start(p);
  double epsilon = first_epsilon, before = std::numeric_limits<double>::infinity();
  shift(p, epsilon);
  while (made.ok()) {
    const double reached = this->judged(p, lambda).natural;
    if (reached <= wanted.velocity) return report;
    if (report.iterations >= wanted.iterations) break;
    if (reached >= before && epsilon < first_epsilon) shift(p, epsilon = 10 * epsilon);
    else if (reached < before && 2 * reached > before && epsilon > least_epsilon) shift(p, epsilon = epsilon / 10);
    before = reached;
    before_ = lambda;
    expand(p, lambda);
    newton_.begin_from(lambda);
    const auto out = newton_.minimise(R_inverse_, b_, 0, wanted.iterations - report.iterations, lambda);
    report.iterations += std::max(out.iterations, 1);
    made = out.report;
    if (made.status == Status::lost_pivot && epsilon < 1) {
      lambda = before_;
      made = {};
      shift(p, epsilon = 10 * epsilon);
    }
  }
  report.status = made.ok() ? Status::not_converged : made.status;
  report.where = static_cast<Index>(made.where);
  return report;
}

template class ProximalNewton<double>;

}  // namespace delassus::simulation
