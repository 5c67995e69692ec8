// Elimination of SquareRootFactor; its solve is in square_root_solve.cpp.
#include "algorithms/square_root_factor.h"

#include <algorithm>

namespace delassus {
namespace {

template <class T> constexpr double least_share = 30 * unit_roundoff<T>;

// Rows of Lᵀ with H = L Lᵀ, by diagonal pivots, the largest relative to its own entry of H first. Returns the rank.
template <class T> int factor_inertia(Matrix6<T> H, Six<T>* rows) {
  using std::sqrt;
  T diagonal[6];
  for (int c = 0; c < 6; ++c) diagonal[c] = H(c, c);
  const auto share = [&](int c) { return diagonal[c] > T(0) ? T(H(c, c) / diagonal[c]) : T(0); };
  int order[6] = {0, 1, 2, 3, 4, 5};
  for (int k = 0; k < 6; ++k) {
    for (int c = k + 1; c < 6; ++c)
      if (share(order[c]) > share(order[k])) std::swap(order[c], order[k]);
    const int p = order[k];
    if (!(share(p) > T((k + 1) * least_share<T>))) return k;
    const T root = sqrt(T(H(p, p)));
    rows[k] = Six<T>::zero();
    rows[k].v[p] = root;
    for (int c = k + 1; c < 6; ++c) rows[k].v[order[c]] = H(p, order[c]) / root;
    for (int c = k + 1; c < 6; ++c)
      for (int r = k + 1; r < 6; ++r) H(order[r], order[c]) -= T(rows[k][order[r]]) * T(rows[k][order[c]]);
  }
  return 6;
}

}  // namespace

template <class T> void SquareRootFactor<T>::analyze(const Structure& s) {
  structure_ = &s;
  plan_ = make_plan(s, Matrix::M_R);
  fronts_ = make_front_plan(s, plan_);
  const auto sixes = [](Index size) { return std::vector<Six<T>>(static_cast<std::size_t>(size), Six<T>::zero()); };
  const auto numbers = [](Index size) { return std::vector<T>(static_cast<std::size_t>(size), T(0)); };
  s_ = t_ = sixes(s.dofs());
  k_ = sixes(s.K_rows);
  joint_k_ = sixes(fronts_.joint_rows);
  inertia_ = sixes(6 * plan_.steps);
  c_ = sixes(fronts_.c);
  handed_rows_ = sixes(fronts_.handed_size);
  front_ = sixes(fronts_.largest);
  armature_ = t_inverse_ = numbers(s.dofs());
  v_ = numbers(fronts_.v);
  beta_ = numbers(fronts_.rows);
  pivot_.assign(beta_.size(), 0);
  taken_.assign(static_cast<std::size_t>(fronts_.tallest), 0);
  lane_.assign(s_.size(), 0);
  inertia_rows_.assign(static_cast<std::size_t>(plan_.steps), 0);
  rows_ = reflections_ = inertia_rows_;
  handed_count_.assign(plan_.members.size(), 0);
  root_.analyze(s);
}

template <class T> Report SquareRootFactor<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  using std::sqrt;
  for (int i = 0; i < plan_.steps; ++i) {
    const int body = plan_.body[i];
    inertia_rows_[i] = factor_inertia<T>(problem.H[body], inertia_.data() + 6 * i);
    Index dof = structure_->first_dof[body];
    for (int c = plan_.first_column[i]; c < plan_.first_column[i + 1]; ++c, ++dof) {
      s_[c] = load(problem.S[dof]);
      armature_[c] = sqrt(problem.armature[dof]);
    }
  }
  for (std::size_t r = 0; r < k_.size(); ++r) k_[r] = load(problem.K[r]);
  for (const auto& c : fronts_.constraints) {
    if (c.links != 0) continue;
    const auto& joint = structure_->joint_constraints[c.id - static_cast<Index>(structure_->link_constraints.size())];
    const Index n = structure_->dofs(joint.body);
    for (Index r = 0; r < c.rows; ++r)
      for (Index k = 0; k < n; ++k) joint_k_[c.first_joint_row + r].v[k] = problem.joint_K[joint.first + r * n + k];
  }
  undamped_ = eliminate(0, plan_.first_active);
  return update_weights(damping);
}

template <class T> Report SquareRootFactor<T>::update_weights(const Damping<T>& damping) {
  if (!undamped_.ok()) return undamped_;
  const Report weighted = root_.assign(damping);
  return weighted.ok() ? eliminate(plan_.first_active, plan_.steps) : weighted;
}

template <class T> Report SquareRootFactor<T>::eliminate(int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const int lost = eliminate(i);
    if (lost >= 0) return {Status::lost_pivot, structure_->first_dof[plan_.body[i]] + lost};
  }
  return {};
}

// Reduces the columns of ν_i; keeps the pivots' rows and hands on the others. A row is zero once it is taken out.
template <class T> int SquareRootFactor<T>::eliminate(int i) {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  T least_squared[6];
  const int rows = rows_[i] = assemble(i, least_squared);
  const Strip<T> front{front_.data(), f.capacity, f.members + 1, rows};
  std::fill_n(taken_.begin(), rows, char{0});
  int* const lane = lane_.data() + first;
  const int reduced = triangularise(front, 0, f.dofs, least_squared, reflections(f), 0, lane, [&](int k, int row) {
    t_[first + k] = front.block(0)[row];
    t_inverse_[first + k] = T(1) / t_[first + k][lane[k]];
    for (int b = 0; b < f.members; ++b) c_[f.c + b * f.dofs + k] = front.block(1 + b)[row];
    take(front, 0, row);
  });
  if (reduced < f.dofs) return lane[reduced];
  reflections_[i] = hand_on(f, front);
  return -1;
}

template <class T> void SquareRootFactor<T>::take(const Strip<T>& front, int b, int row) {
  taken_[row] = 1;
  for (; b < front.blocks; ++b) front.block(b)[row] = Six<T>::zero();
}

// The rows of front i, a_i substituted; returns their number. least_squared: see triangularise.
template <class T> int SquareRootFactor<T>::assemble(int i, T* least_squared) {
  const Front& f = fronts_.fronts[i];
  std::fill_n(front_.begin(), static_cast<Index>(f.capacity) * (f.members + 1), Six<T>::zero());
  int row = 0;
  for (int c = f.first_constraint; c < f.first_constraint + f.constraints; ++c) {
    assemble_constraint(f, fronts_.constraints[c], row);
    row += static_cast<int>(fronts_.constraints[c].rows);
  }
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    assemble_handed(f, fronts_.given[g], row);
    row += handed_count_[fronts_.given[g]];
  }
  std::copy_n(inertia_.begin() + 6 * i, inertia_rows_[i], front_.begin() + row);
  row += inertia_rows_[i];
  T magnitude[6];
  substitute(i, f.joint_rows, row, magnitude);
  for (int k = 0; k < f.dofs; ++k)  // armature
    if (armature_[plan_.first_column[i] + k] > T(0)) {
      front_[row].v[k] = armature_[plan_.first_column[i] + k];
      ++row;
    }
  const Six<T> norms = squared_norms(front_.data(), row);
  const T share = T(least_share<T>);
  for (int k = 0; k < f.dofs; ++k) least_squared[k] = share * share * (magnitude[k] * magnitude[k] + T(norms[k]));
  return row;
}

// W_e (K_e^i …), or W_e 𝒦_i, which stands in the columns of ν_i.
template <class T>
void SquareRootFactor<T>::assemble_constraint(const Front& f, const FrontPlan::Constraint& c, int row) {
  if (c.links == 0) {
    std::copy_n(joint_k_.begin() + c.first_joint_row, c.rows, front_.begin() + row);
    root_.multiply_rows(static_cast<std::size_t>(c.id), front_.data() + row);
  }
  for (int l = c.first_link; l < c.first_link + c.links; ++l) {
    Six<T>* const rows = front_.data() + fronts_.links[l].block * f.capacity + row;
    std::copy_n(k_.begin() + fronts_.links[l].first, c.rows, rows);
    root_.multiply_rows(static_cast<std::size_t>(c.id), rows);
  }
}

template <class T> void SquareRootFactor<T>::assemble_handed(const Front& f, int member, int row) {
  const FrontPlan::Handed& h = fronts_.handed[member];
  for (int b = 0; b < h.blocks; ++b)
    std::copy_n(handed_rows_.begin() + h.first + b * h.capacity, handed_count_[member],
                front_.begin() + fronts_.handed_block[h.first_block + b] * f.capacity + row);
}

// a_i = a_π + S_i ν_i in rows begin … end; magnitude[k] = Σ_c ‖column c of a_i‖ |S_ck|.
template <class T> void SquareRootFactor<T>::substitute(int i, int begin, int end, T* magnitude) {
  using std::abs;
  using std::sqrt;
  const Front& f = fronts_.fronts[i];
  const Six<T>* const s = s_.data() + plan_.first_column[i];
  Six<T>* const own = front_.data();
  const Six<T> norms = squared_norms(own + begin, end - begin);
  T norm[6];
  for (int c = 0; c < 6; ++c) norm[c] = sqrt(T(norms[c]));
  for (int k = 0; k < f.dofs; ++k) {
    magnitude[k] = T(0);
    for (int c = 0; c < 6; ++c) magnitude[k] += norm[c] * T(abs(T(s[k][c])));
  }
  Six<T>* const parent = own + f.parent_block * f.capacity;
  for (int r = begin; r < end; ++r) {
    const Six<T> a = own[r];
    if (f.parent_block > 0) add(parent[r], a);
    own[r] = Six<T>::zero();
    for (int k = 0; k < f.dofs; ++k) own[r].v[k] = dot(s[k], a);
  }
}

// Hands the remaining rows on, member by member. Returns the number of reflections of the front.
template <class T> int SquareRootFactor<T>::hand_on(const Front& f, const Strip<T>& front) {
  const T nothing[6] = {T(0), T(0), T(0), T(0), T(0), T(0)};
  const Reflections<T> kept = reflections(f);
  int top = f.dofs, reflected = f.dofs;
  for (int b = 1; b <= f.members; ++b) {
    const int member = f.first_member + b - 1;
    const bool all = front.rows - top <= FrontPlan::handed_limit;
    const int count = handed_count_[member] = all ? front.rows - top : 6;
    const auto hand = [&](int k, int row) {
      const FrontPlan::Handed& h = fronts_.handed[member];
      for (int c = b; c < front.blocks; ++c) handed_rows_[h.first + (c - b) * h.capacity + k] = front.block(c)[row];
      kept.pivot[top + k] = row;
      take(front, b, row);
    };
    int done = 0;
    if (!all) {
      int lane[6];
      const int reduced = done = triangularise(front, b, 6, nothing, kept, top, lane, hand);
      Six<T>* const handed = handed_rows_.data() + fronts_.handed[member].first;
      for (int k = 1; k < reduced; ++k)  // what reflections have left of columns reduced before
        for (int j = 0; j < k; ++j) handed[k].v[lane[j]] = T(0);
    }
    for (int row = 0; done < count; ++row)  // as they are, for nothing is left in this block, or few rows
      if (taken_[row] == 0) {
        if (!all) {
          kept.beta[top + done] = T(0);
          std::fill_n(kept.vector(top + done), f.stride, T(0));
        }
        hand(done++, row);
      }
    top += count;
    if (!all) reflected = top;
  }
  return reflected;
}

template <class T> Index SquareRootFactor<T>::bytes() const {
  const auto sixes = s_.size() + k_.size() + joint_k_.size() + inertia_.size() + t_.size() + c_.size() +
                     handed_rows_.size() + front_.size();
  const auto numbers = armature_.size() + t_inverse_.size() + v_.size() + beta_.size();
  const auto integers = inertia_rows_.size() + lane_.size() + rows_.size() + reflections_.size() + pivot_.size() +
                        handed_count_.size() + taken_.size() / sizeof(int);
  return static_cast<Index>(sixes * sizeof(Six<T>) + numbers * sizeof(T) + integers * sizeof(int)) + plan_.bytes() +
         fronts_.bytes() + root_.bytes();
}

template class SquareRootFactor<double>;
template class SquareRootFactor<float>;
template class SquareRootFactor<Quad>;
template class SquareRootFactor<Counted>;

}  // namespace delassus
