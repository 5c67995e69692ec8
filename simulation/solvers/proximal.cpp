#include "simulation/solvers/proximal.h"

namespace delassus::simulation {

template <class T> void ProximalNewton<T>::do_analyze(const ContactProblem<T>& p) {
  if (p.mechanism) newton_.analyze(p);
  for (VectorX<T>* const v : {&R_inverse_, &E_, &b_, &before_}) v->setZero(p.rows());
}

// E per cone, and R⁻¹ + E.
template <class T> void ProximalNewton<T>::shift(const ContactProblem<T>& p, double epsilon) {
  const VectorX<T>& d = this->op_.diagonal();
  const T mean = p.rows() > 0 && d.sum() > T(0) ? T(d.sum() / T(static_cast<double>(p.rows()))) : T(1);
  for (const ConeRows& c : p.groups) {
    const T gamma = d.segment(c.row, c.rows).mean();
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const T& given = p.R_inverse[static_cast<std::size_t>(r)];
      const T wanted = T(epsilon) * (gamma > T(0) ? gamma : mean);
      E_[r] = given < wanted ? wanted : T(0);
      R_inverse_[r] = given + E_[r];
    }
  }
}

template <class T> SolverReport ProximalNewton<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  SolverReport report;
  Report made = newton_.start(p);
  if (made.ok()) made = newton_.begin_at(lambda);
  double epsilon = least_epsilon, before = std::numeric_limits<double>::infinity();
  shift(p, epsilon);
  while (made.ok()) {
    const double reached = this->judged(p, lambda).natural;
    if (reached <= wanted.velocity) return report;
    if (report.iterations >= wanted.iterations) break;
    const double cancelled = unit_roundoff<T> * static_cast<double>(p.rows()) * static_cast<double>(b_.template lpNorm<Eigen::Infinity>()) / epsilon;
    if (reached >= before && reached <= cancelled && epsilon < 1) shift(p, epsilon = 10 * epsilon);
    before = reached;
    before_ = lambda;
    b_ = p.free_velocity - p.target - (E_.array() * before_.array()).matrix();
    if (p.law == FrictionLaw::exact)
      for (const ConeRows& c : p.groups)
        if (c.cone == Cone::coulomb && !p.is_off(c)) b_[c.row] += tangent_norm(this->u_.data() + c.row, p.friction.data() + c.row, c.rows);
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
