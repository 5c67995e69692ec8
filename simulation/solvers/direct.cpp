#include "simulation/solvers/direct.h"

#include "algorithms/kit/ldlt_pivoted.h"

namespace delassus::simulation {

template <class T> std::string Direct<T>::refusal(const ContactProblem<T>& p) const {
  for (std::size_t e = 0; e < p.groups.size(); ++e)
    if (p.groups[e].cone != Cone::free && !p.is_off(p.groups[e]))
      return "group " + std::to_string(e) + " is of the cone " + std::string(name(p.groups[e].cone)) + "; direct takes equality rows only";
  return "";
}

template <class T> void Direct<T>::do_analyze(const ContactProblem<T>& p) {
  right_.resize(p.rows());
  ladder_.reset();
  damping_.diagonal = p.R_inverse;
  order_.assign(static_cast<std::size_t>(p.rows()), 0);
  if (!p.mechanism) {
    A_.resize(p.rows(), p.rows());
    return;
  }
  ladder_ = find_operator("ladder").make<T>();
  ladder_->analyze(p.mechanism->structure);
  work_ = std::make_unique<Workspace<T>>(ladder_->workspace());
}

template <class T> void Direct<T>::by_matrix(const ContactProblem<T>& p, VectorX<T>& lambda) {
  const Index m = p.rows();
  A_ = this->op_.matrix();
  for (Index r = 0; r < m; ++r)
    if (!ScalarTraits<T>::is_infinite(p.R_inverse[static_cast<std::size_t>(r)])) A_(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  const T least = T(30 * unit_roundoff<T> * static_cast<double>(m)) * (m > 0 ? A_.diagonal().maxCoeff() : T(0));
  const Index rank = ldlt_pivoted(A_.data(), m, order_.data(), [&](Index, const T& pivot, Index) { return pivot > least; });
  for (Index k = 0; k < rank; ++k) this->u_[k] = right_[order_[static_cast<std::size_t>(k)]];
  ldlt_solve(A_.data(), rank, m, this->u_.data());
  lambda.setZero();
  for (Index k = 0; k < rank; ++k) lambda[order_[static_cast<std::size_t>(k)]] = this->u_[k];
}

template <class T> SolverReport Direct<T>::do_solve(const ContactProblem<T>& p, const Wanted&, VectorX<T>& lambda) {
  right_ = p.target - p.free_velocity;
  SolverReport report;
  report.iterations = 1;
  if (!p.mechanism) {
    by_matrix(p, lambda);
    return report;
  }
  std::copy(p.R_inverse.begin(), p.R_inverse.end(), damping_.diagonal.begin());
  Report solved = ladder_->update(*p.mechanism, damping_);
  if (solved.ok() || solved.status != Status::bad_damping) solved = ladder_->solve(right_, lambda, Accuracy::full(), *work_);
  report.status = solved.status;
  report.where = static_cast<Index>(solved.where);
  return report;
}

template class Direct<double>;

}  // namespace delassus::simulation
