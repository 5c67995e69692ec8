#include "simulation/solvers/pgs.h"

namespace delassus::simulation {

template <class T> void Pgs<T>::do_analyze(const ContactProblem<T>& p) {
  A_.resize(p.rows(), p.rows());
  gamma_.assign(p.groups.size(), T(0));
}

template <class T> void Pgs<T>::move(Index r, const T& step, VectorX<T>& lambda) {
  if (step == T(0)) return;
  lambda[r] += step;
  this->u_ += step * A_.col(r);
}

template <class T> void Pgs<T>::row(const ContactProblem<T>& p, const ConeRows& c, Index r, VectorX<T>& lambda) {
  const T& d = A_(r, r);
  if (!(d > T(0))) return;
  T next = lambda[r] - this->u_[r] / d;
  project(p, {c.cone, r, 1}, &next);
  move(r, next - lambda[r], lambda);
}

template <class T> void Pgs<T>::contact(const ContactProblem<T>& p, const ConeRows& c, VectorX<T>& lambda) {
  const T& gamma = gamma_[static_cast<std::size_t>(&c - p.groups.data())];
  if (!(gamma > T(0))) return;
  const T* const mu = p.friction.data() + c.row;
  const T* const u = this->u_.data() + c.row;
  T next[max_cone_rows];
  for (Index k = 0; k < c.rows; ++k) next[k] = lambda[c.row + k] - u[k] / gamma;
  if (p.law == FrictionLaw::exact) next[0] -= tangent_norm(u, mu, c.rows) / gamma;
  ConeProjection<T>::project(next, mu, c.rows);
  for (Index k = 0; k < c.rows; ++k) move(c.row + k, next[k] - lambda[c.row + k], lambda);
}

template <class T> SolverReport Pgs<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  A_ = this->op_.matrix();
  for (const ConeRows& c : p.groups)
    if (!p.is_off(c))
      for (Index r = c.row; r < c.row + c.rows; ++r) A_(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  for (std::size_t e = 0; e < p.groups.size(); ++e)
    gamma_[e] = A_.block(p.groups[e].row, p.groups[e].row, p.groups[e].rows, p.groups[e].rows).cwiseAbs().rowwise().sum().maxCoeff();
  this->op_.velocity(lambda.data(), this->u_.data());
  SolverReport report;
  for (;; ++report.iterations) {
    if (residuals(p, lambda.data(), this->u_.data(), this->op_.diagonal().data()).natural <= wanted.velocity) {
      this->op_.velocity(lambda.data(), this->u_.data());  // what the sweeps have added up, afresh
      if (residuals(p, lambda.data(), this->u_.data(), this->op_.diagonal().data()).natural <= wanted.velocity) return report;
    }
    if (report.iterations == wanted.iterations) break;
    for (const ConeRows& c : p.groups) {
      if (p.is_off(c)) continue;
      if (c.cone == Cone::coulomb) contact(p, c, lambda);
      else
        for (Index r = c.row; r < c.row + c.rows; ++r) row(p, c, r, lambda);
    }
  }
  report.status = Status::not_converged;
  return report;
}

template class Pgs<double>;

}  // namespace delassus::simulation
