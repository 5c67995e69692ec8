#include "simulation/yielding.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T>
Yielding<T>::Yielding(const std::shared_ptr<const Structure>& structure) : blocks_(structure), operator_(find_operator("lcaba_qr").template make<T>()), work_(0) {
  operator_->analyze(structure);
  work_ = Workspace<T>(operator_->kkt_workspace());
  push_ = motion_ = MatrixX<T>::Constant(structure->dofs(), 1, T(0));
  wanted_ = rows_ = MatrixX<T>::Constant(structure->rows, 1, T(0));
}

template <class T> Report Yielding<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  Report report = blocks_.update(problem);
  if (report.ok()) report = blocks_.diagonal(diagonal_);
  if (!report.ok()) return report;
  E_ = damping;
  const T mean = diagonal_.sum() / T(static_cast<double>(diagonal_.size()));  // for rows that nothing moves, but for rounding
  for (Index r = 0; r < diagonal_.size(); ++r) {
    const T least = T(epsilon) * std::max(diagonal_[r], mean);
    T& own = E_.diagonal[static_cast<std::size_t>(r)];
    if (own < least) own = least;
  }
  return operator_->update(problem, E_);
}

template <class T> Report Yielding<T>::displacement(const VectorX<T>& gap, VectorX<T>& d) {
  wanted_.col(0) = -gap;
  const Report report = operator_->solve_kkt(push_, wanted_, motion_, rows_, Accuracy{1e-6}, work_);
  d = motion_.col(0);
  return report;
}

template class Yielding<double>;
template class Yielding<Counted>;

}  // namespace delassus::simulation
