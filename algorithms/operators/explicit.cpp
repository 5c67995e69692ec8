#include "algorithms/operators/explicit.h"

#include <algorithm>

#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Explicit<T>::do_analyze() {
  const Index m = this->size();
  A0_.setZero(m, m);
  const Fill tiles = coupled_rows(*this->structure(), SymmetricTiles<T>::width);
  A_.analyze(m, tiles);
  factor_.analyze(m, tiles);
  damping_.analyze(*this->structure());
  analyze_form();
}

template <class T> Report Explicit<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  factored_M_ = factor_M(problem);
  return do_update_rows(problem, damping);
}

template <class T> Report Explicit<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  if (!factored_M_.ok()) return factored_M_;
  A_.clear(A0_);
  form(problem, A0_);
  return do_update_damping(damping);
}

template <class T> Report Explicit<T>::do_update_damping(const Damping<T>& damping) {
  if (!factored_M_.ok()) return factored_M_;
  const Structure& s = *this->structure();
  damping_.assign(damping);
  A_.assign(A0_);  // A = J M⁻¹ Jᵀ + R⁻¹
  Index e = 0;
  const auto add_damping = [&](Index row, Index rows) {
    const T* const block = damping_.dense(e++);
    for (Index c = 0; c < rows; ++c)
      if (block == nullptr) A_.add(row + c, row + c, damping_.diagonal(row + c));
      else
        for (Index r = c; r < rows; ++r) A_.add(row + r, row + c, block[c * rows + r]);
  };
  for (const auto& c : s.link_constraints) add_damping(c.row, c.rows);
  for (const auto& c : s.joint_constraints) add_damping(c.row, c.rows);
  A_.cut(damping_.off());
  factor_ = A_;
  for (const Index r : damping_.off()) factor_.add(r, r, T(1));  // λ_r = 0 of a right-hand side 0
  const Index lost = factor_.factor();
  factored_A_ = lost < 0 ? Report{} : Report{.status = Status::lost_pivot, .where = lost, .of_A = true};
  return {};  // apply is defined all the same; solve reports the lost pivot
}

template <class T> Report Explicit<T>::do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const {
  if (!factored_M_.ok()) return factored_M_;
  T *const x = workspace, *const y = x + padded(this->size());
  for (Index c = 0; c < f.cols(); ++c) {
    A_.load(f.data() + c * f.outerStride(), x);
    A_.multiply(x, y);
    A_.store(y, a.data() + c * a.outerStride());
  }
  return {};
}

template <class T> void Explicit<T>::solve_multipliers(const T* right, T* lambda, T* work) const {
  factor_.load(right, work);
  damping_.switch_off(work);
  factor_.solve(work);
  factor_.store(work, lambda);
}

template <class T> Report Explicit<T>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  if (!factored_M_.ok()) return factored_M_;
  if (!factored_A_.ok()) return factored_A_;
  for (Index c = 0; c < f.cols(); ++c) solve_multipliers(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(), workspace);
  return {};
}

template <class T>
Report Explicit<T>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy, Start, T* workspace) const {
  if (!factored_M_.ok()) return factored_M_;
  if (!factored_A_.ok()) return factored_A_;
  const Index m = this->size();
  T* const work = workspace + padded(m);
  std::copy(r2, r2 + m, lambda);
  subtract_rates(r1, lambda, work);
  solve_multipliers(lambda, lambda, workspace);
  motion(r1, lambda, nu, work);
  return {};
}

template <class T> Index Explicit<T>::do_bytes() const {
  return static_cast<Index>(sizeof(T)) * A0_.size() + A_.bytes() + factor_.bytes() + damping_.bytes() + form_bytes();
}

template <class T> void ExplicitBySweeps<T>::analyze_form() {
  plan_ = make_plan(*this->structure(), Matrix::M);
  factor_M_.analyze(*this->structure(), plan_);
}

template <class T> Report ExplicitBySweeps<T>::factor_M(const Problem<T>& problem) {
  const Report started = factor_M_.start(problem);
  return started.ok() ? factor_M_.update_undamped() : started;
}

// Two more vectors behind the sweep's: no forces and the rates; `motion` needs no rates but has them all the same.
template <class T> void ExplicitBySweeps<T>::subtract_rates(const T* r1, T* x, T* work) const {
  const Index m = this->size();
  T *const rates = work + padded(factor_M_.solve_workspace()), *const forces = rates + padded(m), *const nu = forces + padded(m);
  std::fill(forces, forces + m, T(0));
  factor_M_.solve(forces, r1, rates, nu, work);
  for (Index r = 0; r < m; ++r) x[r] -= rates[r];
}

template <class T> void ExplicitBySweeps<T>::motion(const T* r1, const T* lambda, T* nu, T* work) const {
  factor_M_.solve(lambda, r1, work + padded(factor_M_.solve_workspace()), nu, work);
}

template <class T> Index ExplicitBySweeps<T>::pair_workspace() const {
  return padded(factor_M_.solve_workspace()) + 2 * padded(this->size()) + padded(this->structure()->dofs());
}

template <class T> Index ExplicitBySweeps<T>::form_bytes() const { return plan_.bytes() + factor_M_.bytes(); }

#define DELASSUS_INSTANTIATE(T) template class Explicit<T>; template class ExplicitBySweeps<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
