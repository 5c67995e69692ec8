#include "simulation/solvers/newton_convex.h"

namespace delassus::simulation {

template <class T> std::string NewtonConvex<T>::refusal(const ContactProblem<T>& p) const {
  if (const std::string why = PrimalNewton<T>::refusal(p); !why.empty()) return why;
  const Index contact = first_group(p, Cone::coulomb);
  if (p.law == FrictionLaw::exact && contact >= 0)
    return "group " + std::to_string(contact) + " asks for exact Coulomb friction; newton_convex solves the convex relaxation";
  for (std::size_t r = 0; r < p.R_inverse.size(); ++r)
    if (!(p.R_inverse[r] > T(0))) return "row " + std::to_string(r) + " is hard (R⁻¹ = 0); newton_convex needs R⁻¹ > 0, proximal does not";
  return "";
}

template <class T> void NewtonConvex<T>::do_analyze(const ContactProblem<T>& p) {
  if (p.mechanism) newton_.analyze(p);
  R_inverse_.setZero(p.rows());
  b_.setZero(p.rows());
}

template <class T> SolverReport NewtonConvex<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  SolverReport report;
  Report made = newton_.start(p, this->op_.tree());
  if (made.ok()) made = newton_.begin_at(lambda);
  if (made.ok()) {
    std::copy(p.R_inverse.begin(), p.R_inverse.end(), R_inverse_.data());
    b_ = p.free_velocity - p.target;
    const auto out = newton_.minimise(R_inverse_, b_, 0, wanted.iterations, lambda);
    made = out.report;
    report.iterations = out.iterations;
    if (made.ok()) report.gap = newton_.gap(lambda);
  }
  report.status = made.status;
  report.where = static_cast<Index>(made.where);
  return report;
}

template class NewtonConvex<double>;

}  // namespace delassus::simulation
