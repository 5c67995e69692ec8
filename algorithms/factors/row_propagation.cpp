#include "algorithms/factors/row_propagation.h"

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void RowPropagation<T>::analyze(const Structure& s, const Plan& plan, Tree tree) {
  plan_ = &plan;
  rows_ = make_row_plan(s, plan, tree);
  sums_.analyze(std::max<Index>(s.rows, rows_.most_entries), rows_.most_columns);
  k_.assign(static_cast<std::size_t>(s.K_rows), Six<T>::zero());
  kappa_.assign(static_cast<std::size_t>(rows_.slots), Six<T>::zero());
  omega_.assign(tree == Tree::contracted ? static_cast<std::size_t>(plan.active()) : 0, MobilityRoot<T>{});
  stride_ = rows_.most_entries;
  x_.assign(static_cast<std::size_t>(6 * stride_ + 7), T(0));
  g_.assign(static_cast<std::size_t>(rows_.values + 7), T(0));
  d_.assign(static_cast<std::size_t>(rows_.columns), T(0));
}

template <class T> void RowPropagation<T>::load(const Problem<T>& problem) {
  for (std::size_t k = 0; k < k_.size(); ++k) k_[k] = delassus::load(problem.K[k]);
}

template <class T> void RowPropagation<T>::form(const Factor<T>& factor, MatrixX<T>& F) {
  std::copy(k_.begin(), k_.end(), kappa_.begin());
  std::fill(kappa_.begin() + static_cast<std::ptrdiff_t>(k_.size()), kappa_.end(), Six<T>::zero());
  sums_.start(F);
  find_mobilities(factor);
  for (auto node = rows_.nodes.begin(); node + 1 < rows_.nodes.end(); ++node) {
    if (!node->plain) meet(*node);
    for (int k = node->first_merge; k < node[1].first_merge; ++k) add(kappa_[rows_.merges[k].into], kappa_[rows_.merges[k].from]);
    if (node->plain) joint(factor, *node);
    else if (node->first_joint_row < node[1].first_joint_row) leave_joint_with_rows(factor, *node);
    else leave(factor, *node);
  }
  sums_.finish();
}

// Ω of the bodies on simple joints, from the roots outwards; where the parent's joint is not simple it stands still.
template <class T> void RowPropagation<T>::find_mobilities(const Factor<T>& factor) {
  if (omega_.empty()) return;
  const int a = plan_->first_active;
  for (int i = plan_->steps; i-- > a;)
    if (plan_->simple(i)) carry_outwards<T>(factor.joint(i), plan_->simple(plan_->parent[i]) ? &omega_[plan_->parent[i] - a] : nullptr, omega_[i - a]);
}

template <class T> void RowPropagation<T>::push_joint(const typename Factor<T>::Joint& j, const RowPlan::List& list, T* x, Index stride) {
  Index e = 0;
  for (const auto& entry : entries(list)) {
    for (int c = 0; c < j.dofs; ++c) x[c * stride + e] = dot(j.s[c], kappa_[entry.slot]);
    ++e;
  }
}

// F += G D⁻¹Gᵀ; κ_π += κ_i; κ_j −= G D⁻¹W_jᵀ
template <class T> void RowPropagation<T>::joint(const Factor<T>& factor, const Node& node) {
  const auto j = factor.joint(node.step);
  const RowPlan::Span& span = rows_.spans[static_cast<std::size_t>(node.span)];
  const Index q = node.leaving.entries;
  T *const first = g_.data() + span.first_value, *const g = first + node.column * q, *const d = d_.data() + span.first_column;
  push_joint(j, node.leaving, g, q);
  const RowPlan::JointRow* of_joint = rows_.joint_rows.data() + node.first_joint_row;
  factor.for_joint_rows(node.step, [&](int, const T* k) {
    for (int c = 0; c < j.dofs; ++c) g[c * q + of_joint->entry] += k[c];
    ++of_joint;
  });
  std::copy(j.d_inverse, j.d_inverse + j.dofs, d + node.column);
  if (node.last) {
    const typename PairSums<T>::Side side{first, q, rows_.of(node.leaving), 0, node.leaving.entries};
    sums_.add_own_pairs(side, side, d, span.columns);
  }
  const auto all = entries(node.leaving);
  const Six<T>* w = j.w;
  const int* slot = rows_.slots_of_members.data() + node.first_slot;
  for (int k = plan_->first_member[node.step]; k < plan_->first_member[node.step + 1]; ++k, w += j.dofs) {
    const bool inwards = plan_->members[k].step == plan_->parent[node.step];
    for (int e = 0; e < node.leaving.entries; ++e) {
      Six<T>& force = kappa_[inwards ? all[static_cast<std::size_t>(e)].slot : *slot + e];
      for (int c = 0; c < j.dofs; ++c) subtract_scaled(force, w[c], g[c * q + e]);
    }
    if (!inwards) ++slot;
  }
}

// F_rs += κ_r Ω κ_sᵀ = Σ_c (κ_r z_c) d_c (κ_s z_c) of rows from different children, or that act here
template <class T> void RowPropagation<T>::meet(const Node& node) {
  const MobilityRoot<T>& omega = omega_[node.step - plan_->first_active];
  const int first = node.first_group, last = (&node + 1)->first_group;
  if (first == last || (last == first + 1 && !rows_.groups[first].here)) return;
  Six<T> z[6];
  for (int c = 0; c < 6; ++c) z[c] = delassus::load(omega.z[c]);
  Index e = 0;
  for (int g = first; g < last; ++g)
    for (const auto& entry : entries(rows_.groups[g])) {
      for (int c = 0; c < 6; ++c) x_[c * stride_ + e] = dot(z[c], kappa_[entry.slot]);
      ++e;
    }
  const auto side = [&](int group, int entry) {
    return typename PairSums<T>::Side{x_.data(), stride_, rows_.of(rows_.groups[group]), entry, rows_.groups[group].entries};
  };
  for (int g = first, of_g = 0; g < last; of_g += rows_.groups[g++].entries) {
    for (int h = first, of_h = 0; h < g; of_h += rows_.groups[h++].entries) sums_.add_pairs(side(h, of_h), side(g, of_g), omega.d, 6);
    if (rows_.groups[g].here) sums_.add_own_pairs(side(g, of_g), side(g, of_g), omega.d, 6);
  }
}

// The rows of the joint, with each other and with those that come from below; then all go to the parent.
template <class T> void RowPropagation<T>::leave_joint_with_rows(const Factor<T>& factor, const Node& node) {
  const auto j = factor.joint(node.step);
  push_joint(j, node.leaving, x_.data(), stride_);
  const typename PairSums<T>::Side leaving{x_.data(), stride_, rows_.of(node.leaving), 0, node.leaving.entries};
  const RowPlan::JointRow* of_joint = rows_.joint_rows.data() + node.first_joint_row;
  factor.for_joint_rows(node.step, [&](int row, const T* k) {
    T z[6];
    Six<T>& force = kappa_[(of_joint++)->slot];
    for (int c = 0; c < j.dofs; ++c) {
      z[c] = k[c] * j.d_inverse[c];
      subtract_scaled(force, j.w[c], k[c]);
    }
    sums_.add(leaving, z, j.dofs, row);
    factor.for_joint_rows(node.step, [&](int other, const T* l) {
      if (other > row) return;
      T sum(0);
      for (int c = 0; c < j.dofs; ++c) sum += l[c] * z[c];
      if (other == row) sums_.add_own(row, sum);
      else sums_.add(other, row, sum);
    });
  });
  Index e = 0;
  for (const auto& entry : entries(node.leaving)) {
    for (int c = 0; c < j.dofs; ++c) subtract_scaled(kappa_[entry.slot], j.w[c], x_[c * stride_ + e]);
    ++e;
  }
}

template <class T> void RowPropagation<T>::leave(const Factor<T>& factor, const Node& node) {
  const auto carry = [&](Six<T>& force) {
    for (int i = node.step; i != node.to; i = plan_->parent[i]) carry_inwards(factor.joint(i), force);
  };
  if (!node.matrix) {
    for (const auto& entry : entries(node.leaving)) carry(kappa_[entry.slot]);
    return;
  }
  SixBySix<T> P;
  for (int c = 0; c < 6; ++c) carry(P.column[c] = unit_vector<T>(c));
  for (const auto& entry : entries(node.leaving)) kappa_[entry.slot] = multiply(P, kappa_[entry.slot]);
}

template <class T> Index RowPropagation<T>::bytes() const {
  return rows_.bytes() + sums_.bytes() + static_cast<Index>((k_.size() + kappa_.size()) * sizeof(Six<T>) + omega_.size() * sizeof(MobilityRoot<T>) + (x_.size() + g_.size() + d_.size()) * sizeof(T));
}

#define DELASSUS_INSTANTIATE(T) template class RowPropagation<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
