// Elimination of SquareRootFactor; its solve is in square_root_solve.cpp.
#include "algorithms/factors/square_root_factor.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>

namespace delassus {

template <class T> void SquareRootFactor<T>::analyze(const Structure& s) {
  structure_ = &s;
  plan_ = make_plan(s, Matrix::M_R);
  fronts_ = make_front_plan(s, plan_);
  mass_.analyze(s, plan_);
  root_.analyze(s);
  const auto sixes = [](Index size) { return std::vector<Six<T>>(static_cast<std::size_t>(size), Six<T>::zero()); };
  const auto numbers = [](Index size) { return std::vector<T>(static_cast<std::size_t>(size), T(0)); };
  k_ = weighted_k_ = sixes(s.K_rows);
  joint_k_ = weighted_joint_k_ = sixes(fronts_.joint_rows);
  t_ = sixes(s.dofs());
  c_ = sixes(fronts_.c);
  handed_rows_ = sixes(fronts_.handed_size);
  front_ = sixes(fronts_.largest);
  t_inverse_ = numbers(s.dofs());
  lane_.assign(t_.size(), 0);
  v_ = numbers(fronts_.v);
  beta_ = numbers(fronts_.reflections);
  pivot_.assign(beta_.size(), 0);
}

template <class T> Report SquareRootFactor<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = mass_.update(problem);
  if (!undamped_.ok()) return undamped_;
  for (std::size_t r = 0; r < k_.size(); ++r) k_[r] = load(problem.K[r]);
  for (const auto& c : fronts_.constraints) {
    if (c.links != 0) continue;
    const auto& joint = structure_->joint_constraints[c.id - static_cast<Index>(structure_->link_constraints.size())];
    const Index n = structure_->dofs(joint.body);
    const Six<T>* const basis = mass_.basis(plan_.step[joint.body]);
    for (Index r = 0; r < c.rows; ++r) {
      Six<T>& row = joint_k_[c.first_joint_row + r] = Six<T>::zero();
      for (Index k = 0; k < n; ++k)
        for (Index j = 0; j <= k; ++j) row.v[k] += problem.joint_K[joint.first + r * n + j] * T(basis[k][static_cast<int>(j)]);
    }
  }
  for (int i = 0; i < plan_.first_active; ++i) keep_root(i);
  return update_weights(damping);
}

template <class T> Report SquareRootFactor<T>::update_weights(const Damping<T>& damping) {
  if (!undamped_.ok()) return undamped_;
  const Report weighted = root_.assign(damping);
  if (!weighted.ok()) return weighted;
  weigh();
  for (int i = plan_.first_active; i < plan_.steps; ++i) {
    const int lost = eliminate(i);
    if (lost >= 0) return {Status::lost_pivot, structure_->first_dof[plan_.body[i]] + lost};
  }
  return {};
}

template <class T> void SquareRootFactor<T>::weigh() {
  std::copy(k_.begin(), k_.end(), weighted_k_.begin());
  std::copy(joint_k_.begin(), joint_k_.end(), weighted_joint_k_.begin());
  for (const auto& c : fronts_.constraints) {
    const auto e = static_cast<std::size_t>(c.id);
    if (c.links == 0) root_.multiply_rows(e, weighted_joint_k_.data() + c.first_joint_row);
    for (int l = c.first_link; l < c.first_link + c.links; ++l)
      root_.multiply_rows(e, weighted_k_.data() + fronts_.links[l].first);
  }
}

// A front without rows: M's own stay as they are.
template <class T> void SquareRootFactor<T>::keep_root(int i) {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  std::fill_n(c_.begin() + f.c, f.members * f.dofs, Six<T>::zero());
  for (int k = 0; k < f.dofs; ++k) {
    t_[first + k] = Six<T>::zero();
    t_inverse_[first + k] = T(1);
    lane_[first + k] = k;
    if (f.parent_block > 0) c_[f.c + (f.parent_block - 1) * f.dofs + k] = mass_.force(i)[k];
  }
}

// Reduces the columns of μ_i, with one row of M for each, and hands on the rows that are left.
template <class T> int SquareRootFactor<T>::eliminate(int i) {
  const Front& f = fronts_.fronts[i];
  if (f.rows == 0) return keep_root(i), -1;
  const Panel<T> panel = assemble(i);
  const int first = plan_.first_column[i], last = f.rows;
  int* const lane = lane_.data() + first;
  T squared[6];
  for (int c = 0; c < f.dofs; ++c) {
    lane[c] = c;
    squared[c] = f.dofs == 1 ? T(0) : inner(panel.column(c), panel.column(c), last);
  }
  for (int k = 0; k < f.dofs; ++k) {
    panel.bring_longest(k, squared, lane);
    panel.column(k)[last] = T(1);  // its row of M
    for (int b = 0; b < f.members; ++b)
      panel.block(b)[last] = b + 1 == f.parent_block ? mass_.force(i)[lane[k]] : Six<T>::zero();
    const Reflection<T> r = keep(f.reflection + k, panel.reduce(k, last + 1));
    if (r.beta == T(0)) return lane[k];
    t_inverse_[first + k] = T(1) / r.left;
    for (int c = k + 1; c < f.dofs; ++c) t_[first + k].v[lane[c]] = panel.take(c, last, squared[c]);
    for (int b = 0; b < f.members; ++b) c_[f.c + b * f.dofs + k] = panel.block(b)[last];
  }
  hand_on(f, panel);
  return -1;
}

template <class T> Reflection<T> SquareRootFactor<T>::keep(Index at, const Reflection<T>& r) {
  beta_[at] = r.beta;
  pivot_[at] = r.pivot;
  return r;
}

// Calls put(block, row, rows, count) for everything front i consists of: block 0 is a_i, block 1 + k member k.
template <class T> template <class Put> void SquareRootFactor<T>::for_pieces(const Front& f, Put&& put) const {
  int row = 0;
  for (int e = f.first_constraint; e < f.first_constraint + f.constraints; ++e) {
    const FrontPlan::Constraint& c = fronts_.constraints[e];
    for (int l = c.first_link; l < c.first_link + c.links; ++l)
      put(fronts_.links[l].block, row, weighted_k_.data() + fronts_.links[l].first, static_cast<int>(c.rows));
    row += static_cast<int>(c.rows);
  }
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    const FrontPlan::Handed& h = fronts_.handed[fronts_.given[g]];
    for (int b = 0; b < h.blocks; ++b)
      put(fronts_.handed_block[h.first_block + b], row, handed_rows_.data() + h.first + b * h.rows, h.rows);
    row += h.rows;
  }
}

// Front i with a_i = a_π + (S_i P_i) μ_i substituted: what stands on a_i stands on a_π too.
template <class T> Panel<T> SquareRootFactor<T>::assemble(int i) {
  const Front& f = fronts_.fronts[i];
  const Index height = f.rows + 1;
  const Panel<T> panel{v_.data() + f.v, f.stride, f.dofs, front_.data() + height, height, f.members};
  Six<T>* const own = front_.data() + f.parent_block * height;
  std::fill_n(own, f.joint_rows, Six<T>::zero());
  for_pieces(f, [&](int block, int row, const Six<T>* rows, int count) {
    if (block == 0) std::copy_n(rows, count, own + row);
  });
  fill_columns(i, panel, own);
  for (int b = 1; b <= f.members; ++b)
    if (b != f.parent_block) std::fill_n(front_.data() + b * height, f.rows, Six<T>::zero());
  for_pieces(f, [&](int block, int row, const Six<T>* rows, int count) {
    Six<T>* const to = front_.data() + block * height + row;
    for (int r = 0; block > 0 && r < count; ++r) add(to[r], rows[r]);
  });
  return panel;
}

template <class T> void SquareRootFactor<T>::fill_columns(int i, const Panel<T>& panel, const Six<T>* own) {
  const Front& f = fronts_.fronts[i];
  multiply(own, f.rows, mass_.motion(i), f.dofs, panel.columns, f.stride);
  int row = 0;
  for (int e = f.first_constraint; row < f.joint_rows; ++e)
    for (Index r = 0; r < fronts_.constraints[e].rows; ++r, ++row)
      for (int k = 0; k < f.dofs; ++k) panel.column(k)[row] = weighted_joint_k_[fronts_.constraints[e].first_joint_row + r][k];
}

template <class T> void SquareRootFactor<T>::hand_on(const Front& f, const Panel<T>& panel) {
  int reduced = f.dofs;
  for (int b = 0, rest = f.rows; b < f.members && rest > 0; ++b) {
    const FrontPlan::Handed& h = fronts_.handed[f.first_member + b];
    if (h.reduced) {
      reduce_member(f, panel, b, reduced);
      reduced += 6;
    }
    for (int c = b; c < f.members; ++c)
      std::copy_n(panel.block(c) + h.row, h.rows, handed_rows_.data() + h.first + (c - b) * h.rows);
    rest = h.row;
  }
}

// Reflections t, t + 1, … on the columns of block b: six rows are completed; those before have nothing left there.
template <class T> void SquareRootFactor<T>::reduce_member(const Front& f, const Panel<T>& panel, int b, int t) {
  const Panel<T> member{panel.column(t), f.stride, 6, panel.block(b + 1), panel.height, panel.blocks - b - 1};
  const int rows = f.last(t) + 1;
  Six<T>* const own = panel.block(b);
  transpose(own, rows, member.columns, f.stride);
  int lane[6];
  T squared[6];
  for (int c = 0; c < 6; ++c) {
    lane[c] = c;
    squared[c] = inner(member.column(c), member.column(c), rows);
  }
  for (int k = 0; k < 6; ++k, ++t) {
    const int last = f.last(t);
    member.bring_longest(k, squared, lane);
    const Reflection<T> r = keep(f.reflection + t, member.reduce(k, last + 1));
    own[last] = Six<T>::zero();
    own[last].v[lane[k]] = r.left;
    for (int c = k + 1; c < 6; ++c) own[last].v[lane[c]] = member.take(c, last, squared[c]);
  }
}

template <class T> Index SquareRootFactor<T>::bytes() const {
  const auto sixes = 2 * (k_.size() + joint_k_.size()) + t_.size() + c_.size() + handed_rows_.size() + front_.size();
  const auto numbers = t_inverse_.size() + v_.size() + beta_.size();
  return static_cast<Index>(sixes * sizeof(Six<T>) + numbers * sizeof(T) + (lane_.size() + pivot_.size()) * sizeof(int)) +
         plan_.bytes() + fronts_.bytes() + mass_.bytes() + root_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class SquareRootFactor<T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
