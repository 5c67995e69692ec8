#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>
#include <utility>

namespace delassus {

template <class T> void Factor<T>::analyze(const Structure& s, const Plan& plan) {
  structure_ = &s;
  plan_ = &plan;
  const std::size_t columns = static_cast<std::size_t>(plan.first_column.back());
  const std::size_t active = static_cast<std::size_t>(plan.active());
  s_.assign(columns, Six<T>::zero());
  d_inverse_.assign(columns, T(0));
  armature_.assign(columns, T(0));
  w_.assign(static_cast<std::size_t>(plan.first_w.back()), Six<T>::zero());
  e_of_.assign(static_cast<std::size_t>(plan.steps), -1);
  int vectors = 0;
  for (int i = 0; i < plan.steps; ++i)
    if (plan.first_column[i + 1] - plan.first_column[i] > 1) e_of_[i] = 6 * std::exchange(vectors, vectors + 1);
  e_.assign(static_cast<std::size_t>(6 * vectors), Six<T>::zero());
  inertia_.assign(static_cast<std::size_t>(plan.steps), SixBySix<T>::zero());
  inertia0_.assign(active, SixBySix<T>::zero());
  s0_.assign(static_cast<std::size_t>(plan.active_columns()), Six<T>::zero());
  block_.assign(static_cast<std::size_t>(plan.blocks), SixBySix<T>::zero());
  k_.assign(static_cast<std::size_t>(s.K_rows), Six<T>::zero());
  joint_k0_.assign(static_cast<std::size_t>(s.joint_K_size), T(0));
  joint_k_ = joint_k0_;

  attachments_.clear();
  Index largest = 0;
  for (const auto& e : s.link_constraints) {
    for (const auto& link : e.links)
      attachments_.push_back({plan.step[link.body] - plan.first_active, e.row, e.rows, link.first});
    largest = std::max(largest, e.rows * static_cast<Index>(e.links.size()));
  }
  weighted_.assign(static_cast<std::size_t>(largest), Six<T>::zero());

  joint_rows_.clear();
  joint_weight_of_.assign(active, -1);
  int weights = 0;
  Index constraint = static_cast<Index>(s.link_constraints.size());
  for (const auto& j : s.joint_constraints) {
    const int i = plan.step[j.body];
    const int step = i - plan.first_active;
    joint_rows_.push_back({step, plan.first_column[i] - plan.first_column[plan.first_active],
                           plan.first_column[i + 1] - plan.first_column[i], j.row, j.rows, j.first, constraint++});
    if (joint_weight_of_[step] < 0) joint_weight_of_[step] = weights++;
  }
  std::stable_sort(joint_rows_.begin(), joint_rows_.end(),
                   [](const JointRows& a, const JointRows& b) { return a.step < b.step; });
  first_joint_rows_.assign(active + 1, 0);
  for (const JointRows& j : joint_rows_) ++first_joint_rows_[j.step + 1];
  for (std::size_t i = 0; i < active; ++i) first_joint_rows_[i + 1] += first_joint_rows_[i];
  joint_weight_.assign(static_cast<std::size_t>(weights), Matrix6<T>::Zero());
}

template <class T> Report Factor<T>::start(const Problem<T>& problem) {
  for (int i = 0; i < plan_->steps; ++i) {
    const int body = plan_->body[i];
    inertia_[i] = load(problem.H[body]);
    Index dof = structure_->first_dof[body];
    for (int c = plan_->first_column[i]; c < plan_->first_column[i + 1]; ++c, ++dof) {
      s_[c] = load(problem.S[dof]);
      armature_[c] = problem.armature[dof];
    }
  }
  for (std::size_t r = 0; r < k_.size(); ++r) k_[r] = load(problem.K[r]);
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k0_.begin());
  joint_k_ = joint_k0_;
  started_ = true;
  return eliminate(0, plan_->first_active);
}

template <class T> Report Factor<T>::update_weights(const BlockDiagonal<T>& weights) {
  const auto inertia = inertia_.begin() + plan_->first_active;
  const auto s = s_.begin() + plan_->first_column[plan_->first_active];
  if (started_) {  // the first weights after start: keep what other ones will need
    std::copy(inertia, inertia_.end(), inertia0_.begin());
    std::copy(s, s_.end(), s0_.begin());
  } else {
    std::copy(inertia0_.begin(), inertia0_.end(), inertia);
    std::copy(s0_.begin(), s0_.end(), s);
    joint_k_ = joint_k0_;
  }
  started_ = false;
  add_weights(weights);
  return eliminate(plan_->first_active, plan_->steps);
}

// Alg. 4, lines 2–11: constraint inertias, couplings, joint weights.
template <class T> void Factor<T>::add_weights(const BlockDiagonal<T>& weights) {
  std::fill(block_.begin(), block_.end(), SixBySix<T>::zero());
  for (std::size_t e = 0; e < structure_->link_constraints.size(); ++e)
    add_link_weights(weights, static_cast<Index>(e), structure_->link_constraints[e]);
  add_joint_weights(weights);
}

template <class T>
void Factor<T>::add_link_weights(const BlockDiagonal<T>& weights, Index e, const Structure::LinkConstraint& c) {
  const T* const R = weights.dense(e);
  const Index m = c.rows;
  Six<T>* weighted = weighted_.data();
  for (const auto& link : c.links)  // R_e K_e^j
    for (Index r = 0; r < m; ++r, ++weighted) {
      if (R == nullptr) {
        *weighted = k_[link.first + r];
        scale(*weighted, weights.diagonal(c.row + r));
      } else {
        *weighted = Six<T>::zero();
        for (Index q = 0; q < m; ++q) add_scaled(*weighted, k_[link.first + q], R[q * m + r]);
      }
    }
  const int* pair = plan_->constraint_pairs.data() + plan_->first_constraint_pair[e];
  for (std::size_t a = 0; a < c.links.size(); ++a) {
    const int i = plan_->step[c.links[a].body];
    const Six<T>* const wa = weighted_.data() + a * m;
    for (Index r = 0; r < m; ++r) add_outer(inertia_[i], k_[c.links[a].first + r], wa[r]);  // H_ii += K_iᵀ R K_i
    for (std::size_t b = a + 1; b < c.links.size(); ++b, ++pair) {                          // H_ij += K_jᵀ R K_i
      const bool a_first = i < plan_->step[c.links[b].body];
      const Six<T>* const columns = a_first ? wa : weighted_.data() + b * m;
      const Six<T>* const rows = k_.data() + (a_first ? c.links[b].first : c.links[a].first);
      for (Index r = 0; r < m; ++r) add_outer(block_[*pair], rows[r], columns[r]);
    }
  }
}

// 𝒦ᵢᵀ R 𝒦ᵢ, summed over the constraints on one joint.
template <class T> void Factor<T>::add_joint_weights(const BlockDiagonal<T>& weights) {
  for (auto& w : joint_weight_) w.setZero();
  for (const JointRows& j : joint_rows_) {
    Matrix6<T>& w = joint_weight_[joint_weight_of_[j.step]];
    const T* const k = joint_k0_.data() + j.first;
    const T* const R = weights.dense(j.constraint);
    for (Index r = 0; r < j.rows; ++r)
      for (Index q = 0; q < j.rows; ++q) {
        if (R == nullptr && q != r) continue;
        const T weight = R == nullptr ? weights.diagonal(j.row + r) : R[q * j.rows + r];
        for (int c = 0; c < j.dofs; ++c)
          for (int d = 0; d < j.dofs; ++d) w(c, d) += k[r * j.dofs + c] * weight * k[q * j.dofs + d];
      }
  }
}

template <class T> Report Factor<T>::eliminate(int begin, int end) {
  for (int i = begin; i < end; ++i)
    if (!eliminate(i)) return {Status::lost_pivot, structure_->first_dof[plan_->body[i]]};
  return {};
}

// Alg. 4, lines 14–32, in the basis in which D_i is diagonal.
template <class T> bool Factor<T>::eliminate(int i) {
  const int n = plan_->first_column[i + 1] - plan_->first_column[i];
  if (n == 1 && plan_->simple(i)) return eliminate_simple(i);
  const Six<T>* const s = s_.data() + plan_->first_column[i];
  Six<T>* w = w_.data() + plan_->first_w[i];
  for (int k = plan_->first_member[i]; k < plan_->first_member[i + 1]; ++k)  // W_j = H_ji S_i
    for (int c = 0; c < n; ++c, ++w) {
      const int block = plan_->members[k].block;
      *w = block >= 0 ? multiply(block_[block], s[c]) : Six<T>::zero();
    }
  if (!diagonalise(i)) return false;
  update_members(i);
  return true;
}

// The plain articulated-body step of one degree of freedom: H_ππ += H_ii − U D⁻¹Uᵀ.
template <class T> bool Factor<T>::eliminate_simple(int i) {
  const int c = plan_->first_column[i], step = i - plan_->first_active;
  SixBySix<T>& H = inertia_[i];
  const Six<T> U = multiply(H, s_[c]);
  T D = dot(s_[c], U) + armature_[c];
  if (step >= 0 && joint_weight_of_[step] >= 0) D += joint_weight_[joint_weight_of_[step]](0, 0);
  if (!ScalarTraits<T>::usable_pivot(D)) return false;
  d_inverse_[c] = T(1) / D;
  Six<T> w = U;
  scale(w, d_inverse_[c]);
  subtract_outer(H, U, w);
  add(inertia_[plan_->parent[i]], H);
  w_[plan_->first_w[i]] = w;
  return true;
}

// U = H S, D = A + 𝒦ᵀR𝒦 + SᵀU = L D Lᵀ; S, W_j and 𝒦 take the basis E = L⁻ᵀ.
template <class T> bool Factor<T>::diagonalise(int i) {
  const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
  const int q = plan_->first_member[i + 1] - plan_->first_member[i];
  Six<T>* const s = s_.data() + first;
  Six<T>* const w = w_.data() + plan_->first_w[i];
  Six<T> U[6];
  T D[6][6];
  for (int c = 0; c < n; ++c) {
    U[c] = multiply(inertia_[i], s[c]);
    for (int d = 0; d <= c; ++d) D[c][d] = dot(s[d], U[c]);
    D[c][c] += armature_[first + c];
  }
  const int step = i - plan_->first_active;
  const int weight = step >= 0 ? joint_weight_of_[step] : -1;
  if (weight >= 0)
    for (int c = 0; c < n; ++c)
      for (int d = 0; d <= c; ++d) D[c][d] += joint_weight_[weight](c, d);

  for (int k = 0; k < q; ++k)  // W_π += U
    if (plan_->members[plan_->first_member[i] + k].step == plan_->parent[i])
      for (int c = 0; c < n; ++c) add(w[k * n + c], U[c]);

  Six<T>* const e = e_.data() + std::max(0, e_of_[i]);
  for (int c = 0; n > 1 && c < n; ++c) e[c] = unit_vector<T>(c);
  for (int c = 0; c < n; ++c) {
    if (!ScalarTraits<T>::usable_pivot(D[c][c])) return false;
    d_inverse_[first + c] = T(1) / D[c][c];
    for (int d = c + 1; d < n; ++d) {
      const T l = D[d][c] * d_inverse_[first + c];
      for (int f = d; f < n; ++f) D[f][d] -= D[f][c] * l;
      subtract_scaled(e[d], e[c], l);
      subtract_scaled(s[d], s[c], l);
      for (int k = 0; k < q; ++k) subtract_scaled(w[k * n + d], w[k * n + c], l);
      if (weight >= 0)
        for (int j = first_joint_rows_[step]; j < first_joint_rows_[step + 1]; ++j)
          for (Index r = 0; r < joint_rows_[j].rows; ++r) {
            T* const row = joint_k_.data() + joint_rows_[j].first + r * n;
            row[d] -= row[c] * l;
          }
    }
  }
  return true;
}

// Schur complement over Q_i and merging of body i into its parent; then W ← W D⁻¹.
template <class T> void Factor<T>::update_members(int i) {
  const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
  const int q = plan_->first_member[i + 1] - plan_->first_member[i];
  const Plan::Member* const member = plan_->members.data() + plan_->first_member[i];
  const int parent = plan_->parent[i];
  Six<T>* const w = w_.data() + plan_->first_w[i];
  const int* pair = plan_->pairs.data() + plan_->first_pair[i];

  // Σ_c x_c d_c⁻¹ y_cᵀ taken from a block whose columns belong to y's node.
  const auto subtract_schur = [&](SixBySix<T>& block, const Six<T>* x, const Six<T>* y) {
    for (int c = 0; c < n; ++c) {
      Six<T> yd = y[c];
      scale(yd, d_inverse_[first + c]);
      subtract_outer(block, x[c], yd);
    }
  };

  for (int k = 0; k < q; ++k) {
    const Six<T>* const wk = w + k * n;
    const int j = member[k].step;
    if (j == parent) {  // H_ππ += H_ii + H_iπ + H_πi − W_π D⁻¹ W_πᵀ, the difference first
      SixBySix<T>& difference = inertia_[i];
      if (member[k].block >= 0) {
        add(difference, block_[member[k].block]);
        add(difference, transposed(block_[member[k].block]));
      }
      subtract_schur(difference, wk, wk);
      add(inertia_[j], difference);
    } else {
      subtract_schur(inertia_[j], wk, wk);
    }
    for (int l = k + 1; l < q; ++l, ++pair) {
      const Six<T>* const wl = w + l * n;
      SixBySix<T>& target = block_[*pair];
      if (j == parent) {  // H_πl += H_il − W_l D⁻¹ W_πᵀ
        SixBySix<T>& difference = block_[member[l].block];
        subtract_schur(difference, wl, wk);
        add(target, difference);
      } else if (member[l].step == parent) {  // the same, with columns of k: (H_ik − W_k D⁻¹ W_πᵀ)ᵀ
        SixBySix<T>& difference = block_[member[k].block];
        subtract_schur(difference, wk, wl);
        add(target, transposed(difference));
      } else {
        subtract_schur(target, wl, wk);
      }
    }
  }
  for (int k = 0; k < q; ++k)
    for (int c = 0; c < n; ++c) scale(w[k * n + c], d_inverse_[first + c]);
}

template <class T> Index Factor<T>::workspace() const { return 8 * plan_->active() + (plan_->active_columns() + 7) / 8 * 8; }

template <class T> Index Factor<T>::bytes() const {
  const auto sixes = s_.size() + e_.size() + w_.size() + s0_.size() + k_.size() + weighted_.size();
  const auto blocks = inertia_.size() + inertia0_.size() + block_.size();
  const auto scalars = d_inverse_.size() + armature_.size() + joint_k0_.size() + joint_k_.size() + 36 * joint_weight_.size();
  return static_cast<Index>(sixes * sizeof(Six<T>) + blocks * sizeof(SixBySix<T>) + scalars * sizeof(T) +
                            attachments_.size() * sizeof(Attachment) + joint_rows_.size() * sizeof(JointRows) +
                            (first_joint_rows_.size() + joint_weight_of_.size() + e_of_.size()) * sizeof(int));
}

#define DELASSUS_INSTANTIATE(T) template class Factor<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#endif

}  // namespace delassus
