#include "simulation/solver.h"

#include <cmath>

namespace delassus::simulation {

template <class T> Index first_group(const ContactProblem<T>& p, Cone cone) {
  for (std::size_t e = 0; e < p.groups.size(); ++e)
    if (p.groups[e].cone == cone && !p.is_off(p.groups[e])) return static_cast<Index>(e);
  return -1;
}

template <class T> void ContactSolver<T>::analyze(const ContactProblem<T>& p) {
  p.validate();
  op_.analyze(p);
  u_.resize(p.rows());
  judged_.resize(p.rows());
  do_analyze(p);
}

template <class T> SolverReport ContactSolver<T>::solve(const ContactProblem<T>& p, Wanted wanted, VectorX<T>& lambda, TreeOperators<T>* tree) {
  require(op_.fits(p), "ContactSolver::solve: call analyze with a problem of this structure first");
  if (lambda.size() != p.rows()) lambda.resize(p.rows());
  lambda.setZero();
  SolverReport report;
  if (!supports(p)) {
    report.status = Status::not_supported;
    report.residuals.natural = std::numeric_limits<double>::infinity();
    return report;
  }
  const Report updated = op_.update(p, tree);
  if (!updated.ok()) {
    lambda.setConstant(ScalarTraits<T>::nan());
    report.status = updated.status;
    report.where = static_cast<Index>(updated.where);
    report.residuals.natural = std::numeric_limits<double>::quiet_NaN();
    return report;
  }
  if (p.warm_start.size() == p.rows()) lambda = p.warm_start;
  project_all(p, lambda.data());
  judged_.setConstant(ScalarTraits<T>::nan());  // of other numbers
  report = do_solve(p, wanted, lambda);
  report.residuals = judged_ == lambda ? residuals_ : judged(p, lambda);
  const double reached = report.residuals.natural;
  if (reached <= wanted.velocity) report.status = Status::ok;
  else if (!std::isfinite(reached)) report.status = Status::not_finite;
  else if (report.ok()) report.status = Status::not_converged;
  return report;
}

template Index first_group(const ContactProblem<double>&, Cone);
template class ContactSolver<double>;

}  // namespace delassus::simulation
