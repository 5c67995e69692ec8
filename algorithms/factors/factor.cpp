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
  const std::size_t columns = static_cast<std::size_t>(plan.first_column.back());
  const std::size_t steps = static_cast<std::size_t>(plan.steps), active = static_cast<std::size_t>(plan.active());
  s_.assign(columns, Six<T>::zero());
  d_inverse_.assign(columns, T(0));
  armature_ = shift_ = d_inverse_;
  w_.assign(static_cast<std::size_t>(plan.first_w.back()), Six<T>::zero());
  vector_of_.assign(steps, -1);
  int vectors = 0, largest = 0;
  for (int i = 0; i < plan.steps; ++i) {
    if (plan.first_column[i + 1] - plan.first_column[i] > 1) vector_of_[i] = 6 * std::exchange(vectors, vectors + 1);
    largest = std::max(largest, plan.first_w[i + 1] - plan.first_w[i]);
  }
  e_.assign(static_cast<std::size_t>(6 * vectors), Six<T>::zero());
  s0_ = e_;
  own_.assign(plan.matrix == Matrix::M_R ? active : 0, SixBySix<T>::zero());
  inertia_.assign(steps, SixBySix<T>::zero());
  block_.assign(static_cast<std::size_t>(plan.blocks), SixBySix<T>::zero());
  unscaled_.assign(static_cast<std::size_t>(largest), Six<T>::zero());
  links_.analyze(s, plan);
  joint_k0_.assign(static_cast<std::size_t>(s.joint_K_size), T(0));
  joint_k_ = joint_k0_;
  find_sources();

  joint_rows_.clear();
  joint_weight_of_.assign(active, -1);
  int weights = 0;
  Index constraint = static_cast<Index>(s.link_constraints.size());
  for (const auto& j : s.joint_constraints) {
    const int i = plan.step[j.body], step = i - plan.first_active, n = plan.first_column[i + 1] - plan.first_column[i];
    joint_rows_.push_back({step, plan.first_column[i] - plan.first_column[plan.first_active], n, j.row, j.rows, j.first, constraint++});
    if (n > 1 && joint_weight_of_[step] < 0) joint_weight_of_[step] = std::exchange(weights, weights + n * n);
  }
  std::stable_sort(joint_rows_.begin(), joint_rows_.end(),
                   [](const JointRows& a, const JointRows& b) { return a.step < b.step; });
  first_joint_rows_.assign(active + 1, 0);
  for (const JointRows& j : joint_rows_) ++first_joint_rows_[j.step + 1];
  for (std::size_t i = 0; i < active; ++i) first_joint_rows_[i + 1] += first_joint_rows_[i];
  joint_weight_.assign(static_cast<std::size_t>(weights), T(0));
}

// Where H_ii comes from when step i runs: a simple step leaves its part with itself for the parent to take, any other adds to
// inertia_ of its members, which must have been filled before.
template <class T> void Factor<T>::find_sources() {
  const Plan& plan = *plan_;
  filled_.assign(static_cast<std::size_t>(plan.steps), 0);
  for (int i = 0; i < plan.steps; ++i) filled_[i] = !kept(i);
  if (plan.matrix == Matrix::M_R)
    for (const auto& e : structure_->link_constraints)
      for (const auto& link : e.links) filled_[plan.step[link.body]] = 1;
  const std::vector<char> filled_anyway = filled_;
  first_child_.assign(static_cast<std::size_t>(plan.steps) + 1, 0);
  early_.clear();
  copied_.clear();
  const auto handed = [&](int i) { return plan.simple(i) && (i < plan.first_active) == (plan.parent[i] < plan.first_active); };
  for (int i = 0; i < plan.steps; ++i) {
    if (!plan.simple(i))
      for (int k = plan.first_member[i]; k < plan.first_member[i + 1]; ++k) filled_[plan.members[k].step] = 1;
    else if (handed(i)) ++first_child_[plan.parent[i] + 1];
    else early_.push_back(i);
  }
  for (int i = 0; i < plan.steps; ++i) {
    first_child_[i + 1] += first_child_[i];
    if (filled_[i] && !filled_anyway[i]) copied_.push_back(i);
  }
  children_.assign(static_cast<std::size_t>(first_child_.back()), 0);
  std::vector<int> at(first_child_.begin(), first_child_.end() - 1);
  for (int i = 0; i < plan.steps; ++i)
    if (plan.simple(i) && handed(i)) children_[at[plan.parent[i]]++] = i;
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
  for (const int i : early_) add(given(plan_->parent[i]), inertia_[i]);
  return report;
}

template <class T> void Factor<T>::load_rows(const Problem<T>& problem) {
  links_.load(problem);
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k0_.begin());
  joint_k_ = joint_k0_;
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
  for (const int i : copied_) inertia_[i] = given(i);
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
  const auto sixes = s_.size() + s0_.size() + e_.size() + w_.size() + unscaled_.size();
  const auto blocks = own_.size() + inertia_.size() + block_.size();
  const auto scalars = d_inverse_.size() + armature_.size() + shift_.size() + joint_k0_.size() + joint_k_.size() + joint_weight_.size();
  const auto ints = vector_of_.size() + copied_.size() + first_child_.size() + children_.size() + early_.size() +
                    first_joint_rows_.size() + joint_weight_of_.size();
  return links_.bytes() + static_cast<Index>(sixes * sizeof(Six<T>) + blocks * sizeof(SixBySix<T>) + scalars * sizeof(T) +
                                             joint_rows_.size() * sizeof(JointRows) + filled_.size() + ints * sizeof(int));
}

#define DELASSUS_INSTANTIATE(T) template class Factor<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#endif

}  // namespace delassus
