#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <utility>

namespace delassus {
namespace {
// w += k weight qᵀ, n × n
template <class T> void add_square(T* w, const T* k, const T* q, const T& weight, int n) {
  for (int c = 0; c < n; ++c) {
    const T kc = k[c] * weight;
    for (int d = 0; d < n; ++d) *w++ += kc * q[d];
  }
}
}  // namespace

namespace {
std::size_t size(Index n) { return static_cast<std::size_t>(n); }
}  // namespace

template <class T> void Factor<T>::take_plan(const Structure& s, const Plan& plan) {
  structure_ = &s;
  plan_ = &plan;
  lists_.divide(Lists::Part{filled_, size(plan.steps)}, Lists::Part{first_child_, size(plan.steps)}, Lists::Part{next_child_, size(plan.steps)});
  std::fill(first_child_.begin(), first_child_.end(), -1);
  std::fill(next_child_.begin(), next_child_.end(), -1);
  find_sources();
}

template <class T> void Factor<T>::analyze(const Structure& s, const Plan& plan) {
  beside_ = nullptr;
  take_plan(s, plan);
  make_joint_rows();
  links_.analyze(s, plan);
  rows_ = &links_;
  const auto largest_w = [&] {
    int largest = 0;
    for (int i = 0; i < plan.steps; ++i) largest = std::max(largest, plan.first_w[i + 1] - plan.first_w[i]);
    return size(largest);
  };
  int vectors = 0, weights = 0;
  for (int i = 0; i < plan.steps; ++i) {
    const int n = plan.first_column[i + 1] - plan.first_column[i], step = i - plan.first_active;
    vector_of_[i] = n > 1 ? 6 * std::exchange(vectors, vectors + 1) : -1;
    if (step < 0) continue;
    const bool weighted = n > 1 && first_joint_rows_[step + 1] > first_joint_rows_[step];
    joint_weight_of_[step] = weighted ? std::exchange(weights, weights + n * n) : -1;
  }
  const std::size_t active = size(plan.active()), columns = size(plan.first_column.back()), joint_k = size(s.joint_K_size);
  scalars_.divide(T(0), {{&d_inverse_, columns}, {&armature_, columns}, {&shift_, columns}, {&joint_k0_, joint_k}, {&joint_k_, joint_k}, {&joint_weight_, size(weights)}});
  sixes_.divide(Six<T>::zero(), {{&s_, columns}, {&w_, size(plan.first_w.back())}, {&s0_, size(6 * vectors)}, {&e_, size(6 * vectors)}, {&unscaled_, largest_w()}});
  matrices_.divide(SixBySix<T>::zero(), {{&own_, plan.matrix == Matrix::M_R ? active : 0}, {&inertia_, size(plan.steps)}, {&block_, size(plan.blocks)}});
}

template <class T> void Factor<T>::analyze_beside(const Factor& of_M_R, const Plan& plan) {
  beside_ = &of_M_R;
  take_plan(*of_M_R.structure_, plan);
  rows_ = of_M_R.rows_;
  vector_of_ = of_M_R.vector_of_, first_joint_rows_ = of_M_R.first_joint_rows_, joint_weight_of_ = of_M_R.joint_weight_of_, joint_rows_ = of_M_R.joint_rows_;
  s0_ = of_M_R.s0_, armature_ = shift_ = of_M_R.armature_, joint_k0_ = of_M_R.joint_k0_;
  const std::size_t columns = size(plan.first_column.back());
  scalars_.divide(T(0), {{&d_inverse_, columns}, {&joint_k_, joint_k0_.size()}, {&joint_weight_, of_M_R.joint_weight_.size()}});
  sixes_.divide(Six<T>::zero(), {{&s_, columns}, {&w_, size(plan.first_w.back())}, {&e_, s0_.size()}, {&unscaled_, 6}});
  matrices_.divide(SixBySix<T>::zero(), {{&inertia_, size(plan.steps)}});
}

// By counting.
template <class T> void Factor<T>::make_joint_rows() {
  const Plan& plan = *plan_;
  const auto& constraints = structure_->joint_constraints;
  shared_.divide(Lists::Part{vector_of_, size(plan.steps)}, Lists::Part{first_joint_rows_, size(plan.active() + 1)}, Lists::Part{joint_weight_of_, size(plan.active())},
                 Lists::Part{joint_rows_, constraints.size()});
  const auto step_of = [&](const auto& j) { return plan.step[j.body] - plan.first_active; };
  for (const auto& j : constraints) ++first_joint_rows_[step_of(j) + 1];
  for (std::size_t i = 1; i < first_joint_rows_.size(); ++i) first_joint_rows_[i] += first_joint_rows_[i - 1];
  for (std::size_t e = constraints.size(); e-- > 0;) {  // from the last one of each step on
    const auto& j = constraints[e];
    const int step = step_of(j), i = step + plan.first_active, n = plan.first_column[i + 1] - plan.first_column[i];
    joint_rows_[--first_joint_rows_[step + 1]] = {step, plan.first_column[i] - plan.first_column[plan.first_active], n, j.row, j.rows, j.first,
                                                  static_cast<Index>(structure_->link_constraints.size() + e)};
  }
  // entry i + 1 is now where step i begins
  std::copy(first_joint_rows_.begin() + 1, first_joint_rows_.end(), first_joint_rows_.begin());
  first_joint_rows_.back() = static_cast<int>(constraints.size());
}

// Where H_ii comes from when step i runs: a simple step leaves its part with itself for the parent to take, any other adds to
// inertia_ of its members, which must have been filled before.
template <class T> void Factor<T>::find_sources() {
  const Plan& plan = *plan_;
  for (int i = 0; i < plan.steps; ++i)
    if (!kept(i)) filled_[i] = from_the_start;
  if (plan.matrix == Matrix::M_R)
    for (const auto& e : structure_->link_constraints)
      for (const auto& link : e.links) filled_[plan.step[link.body]] = with_rows;
  for (int i = plan.steps; i-- > 0;) {
    if (waits(i)) next_child_[i] = std::exchange(first_child_[plan.parent[i]], i);
    for (int k = plan.first_member[i]; !plan.simple(i) && k < plan.first_member[i + 1]; ++k)
      if (Filled& filled = filled_[plan.members[k].step]; filled == never) filled = by_a_copy;
  }
}

template <class T> Report Factor<T>::start(const Problem<T>& problem) {
  for (int i = 0; i < plan_->steps; ++i) {
    const int body = plan_->body[i];
    given(i) = load(problem.H[body]);
    Index dof = structure_->first_dof[body];
    Six<T>* s = vector_of_[i] < 0 ? s_.data() + plan_->first_column[i] : s0_.data() + vector_of_[i];
    for (int c = plan_->first_column[i]; c < plan_->first_column[i + 1]; ++c, ++dof, ++s) {
      *s = load(problem.S[dof]);
      shift_[c] = armature_[c] = problem.armature[dof];
    }
  }
  links_.load(problem);
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k0_.begin());
  std::copy(joint_k0_.begin(), joint_k0_.end(), joint_k_.begin());
  started_ = eliminate(0, plan_->first_active);
  for (int i = 0; i < plan_->first_active; ++i)
    if (plan_->simple(i) && !waits(i)) add(given(plan_->parent[i]), inertia_[i]);
  return started_;
}

template <class T> Report Factor<T>::start_beside() {
  const Factor& other = *beside_;
  const int first = plan_->first_active;
  std::copy(other.s_.begin(), other.s_.end(), s_.begin());  // of several degrees of freedom: right in phase A, later overwritten
  std::copy(other.e_.begin(), other.e_.end(), e_.begin());
  std::copy_n(other.d_inverse_.begin(), plan_->first_column[first], d_inverse_.begin());
  std::copy_n(other.w_.begin(), plan_->first_w[first], w_.begin());
  std::copy(other.own_.begin(), other.own_.end(), inertia_.begin() + first);
  std::copy(joint_k0_.begin(), joint_k0_.end(), joint_k_.begin());
  return other.started_;
}

template <class T> void Factor<T>::move_rows(const Problem<T>& problem) {
  links_.load(problem);
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k0_.begin());
  move_rows_beside();
}

template <class T> void Factor<T>::move_rows_beside() {
  std::copy(joint_k0_.begin(), joint_k0_.end(), joint_k_.begin());
  for (int step = 0; step < plan_->active(); ++step) into_basis(step);
}

template <class T> Report Factor<T>::update_weights(const BlockDiagonal<T>& weights) {
  add_weights(weights);
  return eliminate(plan_->first_active, plan_->steps);
}

// Alg. 4, lines 2–11: constraint inertias, couplings, joint weights.
template <class T> void Factor<T>::add_weights(const BlockDiagonal<T>& weights) {
  std::fill(block_.begin(), block_.end(), SixBySix<T>::zero());
  for (int i = plan_->first_active; i < plan_->steps; ++i)
    if (filled_[i] == by_a_copy) inertia_[i] = given(i);
  links_.add_weights(weights, own_.data(), inertia_.data() + plan_->first_active, block_.data());
  add_joint_weights(weights);
}

// 𝒦ᵢᵀ R 𝒦ᵢ, summed over the constraints on one joint; of a joint of one degree of freedom with its armature.
template <class T> void Factor<T>::add_joint_weights(const BlockDiagonal<T>& weights) {
  std::fill(joint_weight_.begin(), joint_weight_.end(), T(0));
  int before = -1;
  for (const JointRows& j : joint_rows_) {
    const int column = plan_->first_column[plan_->first_active] + j.column;
    if (j.dofs == 1 && j.step != before) shift_[column] = armature_[column];
    before = j.step;
    T* const w = j.dofs == 1 ? &shift_[column] : joint_weight_.data() + joint_weight_of_[j.step];
    const T* k = joint_k0_.data() + j.first;
    const T* const R = weights.dense(j.constraint);
    for (Index r = 0; r < j.rows; ++r, k += j.dofs) {
      if (R == nullptr) add_square(w, k, k, weights.diagonal(j.row + r), j.dofs);
      else
        for (Index q = 0; q < j.rows; ++q) add_square(w, k, joint_k0_.data() + j.first + q * j.dofs, R[q * j.rows + r], j.dofs);
    }
  }
}

// Every step runs, whatever the pivots are; the first that is lost is reported.
template <class T> Report Factor<T>::eliminate(int begin, int end) {
  int lost = end;
  for (int i = begin; i < end; ++i)
    if (!eliminate(i)) lost = std::min(lost, i);
  if (lost < end) return {Status::lost_pivot, structure_->first_dof[plan_->body[lost]]};
  return {};
}

template <class T> Index Factor<T>::workspace() const { return 8 * plan_->active() + (plan_->active_columns() + 7) / 8 * 8; }

template <class T> Index Factor<T>::solve_workspace() const { return 8 * plan_->steps + (plan_->first_column[plan_->steps] + 7) / 8 * 8; }

template <class T> Index Factor<T>::bytes() const {
  return links_.bytes() + sixes_.bytes() + scalars_.bytes() + matrices_.bytes() + lists_.bytes() + shared_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class Factor<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#endif

}  // namespace delassus
