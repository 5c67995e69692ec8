#include "simulation/paths.h"

#include <algorithm>

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// A step ends with a status or with numbers.
template <class T> bool finite(const VectorX<T>& x) {
  using std::isfinite;
  for (Index k = 0; k < x.size(); ++k)
    if (!isfinite(x[k])) return false;
  return true;
}

}  // namespace

template <class T>
FreePath<T>::FreePath(std::shared_ptr<const Structure> structure)
    : structure_(std::move(structure)), plan_(make_plan(*structure_, Matrix::M)), work_(0) {
  require(structure_->rows == 0, "FreePath: the structure has rows");
  factor_.analyze(*structure_, plan_);
  work_ = Workspace<T>(factor_.solve_workspace());
}

template <class T> StepReport FreePath<T>::velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  StepReport out;
  out.path = name();
  impulses.resize(0);
  out.report = factor_.start(*now.problem);
  if (out.report.ok()) out.report = factor_.update_undamped();
  if (!out.report.ok()) return out;
  push_ = now.weight * *now.force;
  change.resize(push_.size());
  factor_.solve(static_cast<const T*>(nullptr), push_.data(), static_cast<T*>(nullptr), change.data(), work_.data());
  if (!finite(change)) out.report.status = Status::not_finite;
  return out;
}

template <class T>
EquationsPath<T>::EquationsPath(std::shared_ptr<const Structure> structure, Damping<T> damping, const std::string& op, double accuracy)
    : operator_(find_operator(op).template make<T>()), damping_(std::move(damping)), accuracy_(accuracy), work_(0), tree_(structure) {
  operator_->analyze(structure);
  work_ = Workspace<T>(operator_->kkt_workspace());
  push_ = nu_ = motion_ = MatrixX<T>::Constant(structure->dofs(), 1, T(0));
  wanted_ = rows_ = MatrixX<T>::Constant(structure->rows, 1, T(0));
  const bool hard = damping_.blocks.empty() && std::all_of(damping_.diagonal.begin(), damping_.diagonal.end(), [](const T& x) { return x == T(0); });
  accuracy_of_correction_ = hard ? Accuracy::fastest().error : std::max(accuracy_, of_correction);
}

template <class T> StepReport EquationsPath<T>::velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  StepReport out;
  out.path = name();
  out.rows = operator_->size();
  out.islands = 1;
  take(*now.problem);
  out.report = taken_;
  if (!out.report.ok()) return out;
  tree_.take(*now.problem);
  push_.col(0) = now.h * *now.force;
  nu_.col(0) = now.state->nu;
  tree_.J(nu_, wanted_);
  wanted_ = -wanted_;
  out.report = operator_->solve_kkt(push_, wanted_, motion_, rows_, Accuracy{accuracy_}, work_);
  change = motion_.col(0);
  impulses = rows_.col(0);
  if (out.report.status == Status::not_converged && is_rounding(out.report, change)) out.report.status = Status::ok;
  if (out.report.ok() && !finite(change)) out.report.status = Status::not_finite;
  return out;
}

// At rest forces cancel, and no digit of what is left can be had: a change with an error that is less, in the energy norm, than what M̂⁻¹ h f rounds.
template <class T> bool EquationsPath<T>::is_rounding(const Report& report, const VectorX<T>& change) {
  using std::sqrt;
  if (!(report.error_estimate >= 0)) return false;
  nu_.col(0) = change;
  tree_.M(nu_, motion_);
  const T size = sqrt(change.dot(motion_.col(0)));
  if (!tree_.M_inverse(push_, motion_).ok()) return false;
  return size + T(report.error_estimate) * size <= T(8 * unit_roundoff<T>) * sqrt(push_.col(0).dot(motion_.col(0)));
}

template <class T> Report EquationsPath<T>::correct(const VectorX<T>& gap, VectorX<T>& d) {
  if (!taken_.ok()) return taken_;
  push_.setConstant(T(0));
  wanted_.col(0) = -gap;
  if (!yields_) {
    const Report report = operator_->solve_kkt(push_, wanted_, motion_, rows_, Accuracy{accuracy_of_correction_}, work_);
    d = motion_.col(0);
    if (report.status != Status::inconsistent) return report;
    yields_ = true;
  }
  if (!yielding_is_current_) {
    if (!yielding_) yielding_ = std::make_unique<Yielding<T>>(numbers_->structure);
    const Report updated = yielding_->update(*numbers_, damping_);
    if (!updated.ok()) return updated;
    yielding_is_current_ = true;
  }
  const Report report = yielding_->solve(push_, wanted_, 1, Accuracy{accuracy_}, motion_, rows_);
  d = motion_.col(0);
  return report;
}

template <class T> bool EquationsPath<T>::yield() {
  if (yields_ || operator_->dependent_rows().empty()) return false;
  return yields_ = true;
}

template class FreePath<double>;
template class FreePath<Counted>;
template class EquationsPath<double>;
template class EquationsPath<Counted>;

}  // namespace delassus::simulation
