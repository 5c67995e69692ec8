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

template <class T> void Factor<T>::analyze(const Structure& s, const Plan& plan) {
  structure_ = &s;
  plan_ = &plan;
  const auto size = [](Index n) { return static_cast<std::size_t>(n); };
  const std::size_t steps = size(plan.steps), active = size(plan.active()), columns = size(plan.first_column.back());
  lists_.divide(-1, {{&vector_of_, steps}, {&first_child_, steps}, {&next_child_, steps}, {&first_joint_rows_, active + 1}, {&joint_weight_of_, active}});
  fills_.divide(never, {{&filled_, steps}});
  int vectors = 0, largest = 0;
  for (int i = 0; i < plan.steps; ++i) {
    if (plan.first_column[i + 1] - plan.first_column[i] > 1) vector_of_[i] = 6 * std::exchange(vectors, vectors + 1);
    largest = std::max(largest, plan.first_w[i + 1] - plan.first_w[i]);
  }
  find_sources();
  links_.analyze(s, plan);
  const std::size_t joint_k = size(s.joint_K_size), joint_weights = size(analyze_joint_rows());
  scalars_.divide(T(0), {{&d_inverse_, columns}, {&armature_, columns}, {&shift_, columns}, {&joint_k0_, joint_k}, {&joint_k_, joint_k}, {&joint_weight_, joint_weights}});
  sixes_.divide(Six<T>::zero(), {{&s_, columns}, {&w_, size(plan.first_w.back())}, {&s0_, size(6 * vectors)}, {&e_, size(6 * vectors)}, {&unscaled_, size(largest)}});
  matrices_.divide(SixBySix<T>::zero(), {{&own_, plan.matrix == Matrix::M_R ? active : 0}, {&inertia_, steps}, {&block_, size(plan.blocks)}});
}

// The sum of n_i² of the joints of several degrees of freedom with rows.
template <class T> int Factor<T>::analyze_joint_rows() {
  const Plan& plan = *plan_;
  joint_rows_.clear();
  joint_rows_.reserve(structure_->joint_constraints.size());
  int weights = 0;
  Index constraint = static_cast<Index>(structure_->link_constraints.size());
  for (const auto& j : structure_->joint_constraints) {
    const int i = plan.step[j.body], step = i - plan.first_active, n = plan.first_column[i + 1] - plan.first_column[i];
    joint_rows_.push_back({step, plan.first_column[i] - plan.first_column[plan.first_active], n, j.row, j.rows, j.first, constraint++});
    if (n > 1 && joint_weight_of_[step] < 0) joint_weight_of_[step] = std::exchange(weights, weights + n * n);
  }
  std::stable_sort(joint_rows_.begin(), joint_rows_.end(),
                   [](const JointRows& a, const JointRows& b) { return a.step < b.step; });
  std::fill(first_joint_rows_.begin(), first_joint_rows_.end(), 0);
  for (const JointRows& j : joint_rows_) ++first_joint_rows_[j.step + 1];
  for (std::size_t i = 1; i < first_joint_rows_.size(); ++i) first_joint_rows_[i] += first_joint_rows_[i - 1];
  return weights;
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
  load_rows(problem);
  const Report report = eliminate(0, plan_->first_active);
  for (int i = 0; i < plan_->first_active; ++i)
    if (plan_->simple(i) && !waits(i)) add(given(plan_->parent[i]), inertia_[i]);
  return report;
}

template <class T> void Factor<T>::load_rows(const Problem<T>& problem) {
  links_.load(problem);
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k0_.begin());
  std::copy(joint_k0_.begin(), joint_k0_.end(), joint_k_.begin());
}

template <class T> void Factor<T>::move_rows(const Problem<T>& problem) {
  load_rows(problem);
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
  return links_.bytes() + sixes_.bytes() + scalars_.bytes() + matrices_.bytes() + lists_.bytes() + fills_.bytes() +
         static_cast<Index>(joint_rows_.size() * sizeof(JointRows));
}

#define DELASSUS_INSTANTIATE(T) template class Factor<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#endif

}  // namespace delassus
