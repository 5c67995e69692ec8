#include "simulation/solvers/projected_gradient.h"

namespace delassus::simulation {

template <class T> std::string ProjectedGradient<T>::refusal(const ContactProblem<T>& p) const {
  const Index contact = first_group(p, Cone::coulomb);
  if (p.law == FrictionLaw::exact && contact >= 0)
    return "group " + std::to_string(contact) + " asks for exact Coulomb friction; projected gradients solve the convex relaxation";
  return "";
}

template <class T> void ProjectedGradient<T>::do_analyze(const ContactProblem<T>& p) {
  for (VectorX<T>* const v : {&gamma_, &b_, &gradient_, &y_, &next_, &work_}) v->setZero(p.rows());
}

template <class T> T ProjectedGradient<T>::scale(const ContactProblem<T>& p) {
  const VectorX<T>& d = this->op_.diagonal();
  const T mean = d.sum() > T(0) ? T(d.sum() / T(static_cast<double>(p.rows()))) : T(1);
  for (const ConeRows& c : p.groups)
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      gamma_[r] = c.cone == Cone::coulomb ? d.segment(c.row, c.rows).mean() : d[r];
      if (!(gamma_[r] > T(0))) gamma_[r] = mean;
    }
  b_ = p.free_velocity - p.target;
  for (Index r = 0; r < p.rows(); ++r) y_[r] = T(1) + T(static_cast<double>((r * 7919) % 101) / 101);
  T largest(0);
  for (int k = 0; k < 30; ++k) {
    this->op_.multiply(y_.data(), work_.data());
    work_.array() /= gamma_.array();
    const T size = work_.template lpNorm<Eigen::Infinity>();
    if (!(size > T(0)) || !std::isfinite(size)) break;
    largest = std::sqrt((work_.array().square() * gamma_.array()).sum() / (y_.array().square() * gamma_.array()).sum());
    y_ = work_ / size;
  }
  return largest > T(0) ? largest : T(1);
}

template <class T> void ProjectedGradient<T>::step(const ContactProblem<T>& p, const VectorX<T>& from, const VectorX<T>& gradient, const T& length, VectorX<T>& to) {
  to = from - length * (gradient.array() / gamma_.array()).matrix();
  project_all(p, to.data());
}

template <class T> SolverReport Ccp<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  SolverReport report;
  const T omega = p.rows() > 0 ? T(1.5) / this->scale(p) : T(1);
  for (;; ++report.iterations) {
    if (this->judged(p, lambda).natural <= wanted.velocity) return report;
    if (report.iterations == wanted.iterations) break;
    this->step(p, lambda, this->u_, omega, this->next_);
    lambda = this->next_;
  }
  report.status = Status::not_converged;
  return report;
}

template <class T> SolverReport Apgd<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  auto &y = this->y_, &next = this->next_, &work = this->work_, &gradient = this->gradient_;
  const auto& gamma = this->gamma_;
  SolverReport report;
  if (this->judged(p, lambda).natural <= wanted.velocity) return report;
  T L = this->scale(p), theta(1);
  const T most = T(4) * L;
  y = lambda;
  while (report.iterations < wanted.iterations) {
    ++report.iterations;
    this->op_.velocity(y.data(), gradient.data());
    for (;; L = T(2) * L) {  // ½ δᵀAδ ≤ ½ L ‖δ‖²_γ
      this->step(p, y, gradient, T(1) / L, next);
      y -= next;  // −δ
      this->op_.multiply(y.data(), work.data());
      const bool enough = y.dot(work) <= L * (y.array().square() * gamma.array()).sum() || L > most;
      y += next;
      if (enough) break;
    }
    const bool uphill = gradient.dot(next - lambda) > T(0);
    const T before = theta;
    theta = (-before * before + before * std::sqrt(before * before + T(4))) / T(2);
    const T beta = uphill ? T(0) : before * (T(1) - before) / (before * before + theta);
    if (uphill) theta = T(1);
    y = next + beta * (next - lambda);
    lambda = next;
    L = T(0.9) * L;
    if (this->judged(p, lambda).natural <= wanted.velocity) return report;
  }
  report.status = Status::not_converged;
  return report;
}

template class ProjectedGradient<double>;
template class Apgd<double>;
template class Ccp<double>;

}  // namespace delassus::simulation
