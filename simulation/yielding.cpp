#include "simulation/yielding.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T>
Yielding<T>::Yielding(const std::shared_ptr<const Structure>& structure) : blocks_(structure), operator_(find_operator("lcaba_qr").template make<T>()), work_(0) {
  operator_->analyze(structure);
  work_ = Workspace<T>(operator_->kkt_workspace());
  added_ = VectorX<T>::Constant(structure->rows, T(0));
}

template <class T> Report Yielding<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  Report report = blocks_.update(problem);
  if (report.ok()) report = blocks_.diagonal(diagonal_);
  if (!report.ok()) return report;
  Damping<T> E = damping;
  const T mean = diagonal_.sum() / T(static_cast<double>(diagonal_.size()));  // for rows that nothing moves, but for rounding
  for (Index r = 0; r < diagonal_.size(); ++r) {
    const T least = T(epsilon) * std::max(diagonal_[r], mean);
    T& own = E.diagonal[static_cast<std::size_t>(r)];
    added_[r] = own < least ? T(least - own) : T(0);
    own += added_[r];
  }
  return operator_->update(problem, E);
}

template <class T> Report Yielding<T>::solve(const MatrixX<T>& r1, const MatrixX<T>& r2, int points, Accuracy accuracy, MatrixX<T>& nu, MatrixX<T>& lambda) {
  Report report;
  r2_ = r2;
  for (int k = 0; k < points && report.ok(); ++k) {
    report = operator_->solve_kkt(r1, r2_, nu, lambda, accuracy, work_);
    r2_.col(0) = r2.col(0) + added_.cwiseProduct(lambda.col(0));
  }
  return report;
}

template class Yielding<double>;
template class Yielding<Counted>;

}  // namespace delassus::simulation
