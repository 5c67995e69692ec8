#include "simulation/constrained.h"

#include "algorithms/kit/counted.h"
#include "algorithms/mechanism/loop_closing.h"
#include "simulation/rotations.h"

namespace delassus::simulation {

template <class T>
Constrained<T>::Constrained(const Model& model, Mechanism<T>& mechanism, const std::string& op, double accuracy)
    : model_(&model), mechanism_(&mechanism), advance_(model), motion_(mechanism), operator_(find_operator(op).template make<T>()),
      hard_(Damping<T>::uniform(mechanism.structure()->rows, T(0))), accuracy_(accuracy), work_(0), tree_(mechanism.structure()) {
  operator_->analyze(mechanism.structure());
  work_ = Workspace<T>(operator_->kkt_workspace());
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].joint.type == JointType::floating) floating_.push_back(model.first_dof[i]);
  push_ = change_ = nu_ = MatrixX<T>::Constant(model.dofs(), 1, T(0));
  wanted_ = lambda_ = gap_ = gap_then_ = MatrixX<T>::Constant(mechanism.structure()->rows, 1, T(0));
}

/// Of the problem of the last update of the operator; rows that contradict each other give way.
template <class T> Report Constrained<T>::solve(const Problem<T>& problem, const MatrixX<T>& push, const MatrixX<T>& wanted) {
  const Report report = operator_->solve_kkt(push, wanted, change_, lambda_, Accuracy{accuracy_}, work_);
  return report.status == Status::inconsistent ? solve_yielding(problem, push, wanted) : report;
}

/// At once with all points.
template <class T> Report Constrained<T>::solve_yielding(const Problem<T>& problem, const MatrixX<T>& push, const MatrixX<T>& wanted) {
  if (!yielding_) yielding_ = std::make_unique<Yielding<T>>(problem.structure);
  const Report report = yielding_->update(problem, hard_);
  return report.ok() ? yielding_->solve(push, wanted, yielding_points, Accuracy{accuracy_}, change_, lambda_) : report;
}

template <class T> Report Constrained<T>::accelerations(Moment<T>& now, VectorX<T>& out, VectorX<T>& lambda) {
  Report report = operator_->update(*now.problem, hard_);
  if (!report.ok()) return report;
  const VectorX<T>& nu = now.state->nu;
  motion_.update(nu);
  motion_.bias_rows(bias_);
  wanted_.col(0) = -bias_;
  if (!floating_.empty()) {
    nu_.setConstant(T(0));
    for (const Index k : floating_) nu_.col(0).template segment<3>(k + 3) = three_of(nu.data() + k).cross(three_of(nu.data() + k + 3));
    tree_.take(*now.problem);
    tree_.J(nu_, gap_);
    wanted_ += gap_;
  }
  push_.col(0) = now.weight * *now.force;
  report = solve(*now.problem, push_, wanted_);
  out = change_.col(0);
  lambda = lambda_.col(0);
  using std::isfinite;
  for (Index k = 0; report.ok() && k < out.size(); ++k)
    if (!isfinite(out[k])) report.status = Status::not_finite;
  return report;
}

/// Largest |φ| at q; leaves φ in `gap`.
template <class T> T Constrained<T>::gap_at(const VectorX<T>& q, MatrixX<T>& gap) {
  using std::abs;
  mechanism_->update(q);
  mechanism_->poses(poses_);
  T largest(0);
  Index row = 0;
  for (const Constraint& c : model_->constraints) row += closure_error(*model_, c, poses_, gap.data() + row);
  for (Index k = 0; k < row; ++k)
    if (abs(gap(k, 0)) > largest) largest = abs(gap(k, 0));
  return largest;
}

template <class T> Report Constrained<T>::project(Moment<T>& now, State<T>& next) {
  Problem<T>& problem = *now.problem;
  Report report = operator_->update(problem, hard_);
  T open = gap_at(next.q, gap_);
  now.drift = static_cast<double>(open);
  push_.setConstant(T(0));
  bool yields = false;
  for (int k = 0; report.ok() && k < 6 && open > T(closed); ++k) {
    wanted_ = -gap_;
    if (!yields) report = operator_->solve_kkt(push_, wanted_, change_, lambda_, Accuracy::fastest(), work_);
    yields = yields || report.status == Status::inconsistent;
    if (yields) report = solve_yielding(problem, push_, wanted_);
    if (!report.ok()) break;
    q_ = next.q;
    d_ = change_.col(0);
    advance_.displace(d_, q_);
    const T then = gap_at(q_, gap_then_);
    const bool halved = then + then < open;
    if (then < open) {
      next.q = q_;
      gap_.swap(gap_then_);
      open = then;
    }
    if (halved) continue;
    if (yields || operator_->dependent_rows().empty()) break;
    yields = true;
  }
  now.left = static_cast<double>(open);
  if (!report.ok()) return report;
  const auto armature = problem.armature;  // of inertia terms
  mechanism_->update(next.q);
  mechanism_->fill(problem);
  problem.armature = armature;
  report = operator_->update(problem, hard_);
  if (!report.ok()) return report;
  tree_.take(problem);
  nu_.col(0) = next.nu;
  tree_.J(nu_, wanted_);
  wanted_ = -wanted_;
  report = solve(problem, push_, wanted_);
  next.nu += change_.col(0);
  return report;
}

template class Constrained<double>;
template class Constrained<Counted>;

}  // namespace delassus::simulation
