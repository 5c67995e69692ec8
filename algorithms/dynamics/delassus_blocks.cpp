#include "algorithms/dynamics/delassus_blocks.h"

#include <algorithm>

#include "algorithms/factors/mobility.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> struct DelassusBlocks<T>::Numbers {
  struct Reached {  // a step, and the first of its κ
    int step;
    Six<T>* rows;
  };
  struct Constraint {
    const Structure::LinkConstraint* link;
    const Structure::JointConstraint* joint;
    [[nodiscard]] Index row() const { return link != nullptr ? link->row : joint->row; }
    [[nodiscard]] Index rows() const { return link != nullptr ? link->rows : joint->rows; }
    [[nodiscard]] Index bodies() const { return link != nullptr ? static_cast<Index>(link->links.size()) : 1; }
  };

  std::shared_ptr<const Structure> structure;
  std::vector<Constraint> constraints;
  std::unique_ptr<TreeOperators<T>> owned;
  TreeOperators<T>* tree = nullptr;
  const Factor<T>* factor = nullptr;
  std::vector<SixBySix<T>> mobility;  // per step
  std::vector<Six<T>> kappa;          // scratch
  std::vector<T> G;                   // scratch: a joint's columns of G, one row behind the other
  std::vector<Reached> reached;       // steps, farthest from the roots last
  Index used = 0;                     // of kappa
  Report factored;

  explicit Numbers(std::shared_ptr<const Structure> s) : structure(std::move(s)) {
    require(structure != nullptr, "DelassusBlocks: no structure");
    structure->validate();
    Index rows = 0, bodies = 0;
    for (const auto& e : structure->link_constraints) constraints.push_back({&e, nullptr});
    for (const auto& e : structure->joint_constraints) constraints.push_back({nullptr, &e});
    for (const Constraint& e : constraints) rows = std::max(rows, 2 * e.rows()), bodies = std::max(bodies, 2 * e.bodies());
    mobility.assign(static_cast<std::size_t>(structure->bodies()), SixBySix<T>::zero());
    kappa.assign(static_cast<std::size_t>(rows * bodies), Six<T>::zero());
    G.assign(static_cast<std::size_t>(6 * rows), T(0));
    reached.reserve(static_cast<std::size_t>(bodies));
  }

  Report take(TreeOperators<T>& of) {
    tree = &of;
    const auto [its, report] = of.factor();
    factor = its;
    factored = report;
    const Plan& plan = of.plan();
    for (int i = plan.steps; factored.ok() && i-- > plan.first_active;)
      mobility[i] = delassus::mobility<T>(factor->joint(i), plan.parent[i] < 0 ? nullptr : &mobility[plan.parent[i]]);
    return factored;
  }

  /// Where a step stands among those reached, or would: parents have later steps.
  auto place_of(int step) {
    return std::lower_bound(reached.begin(), reached.end(), step, [](const Reached& x, int i) { return x.step > i; });
  }

  /// κ of a body; zeros where it was not reached before.
  Six<T>* reach(Index body, Index rows) {
    const int step = tree->plan().step[body];
    const auto at = place_of(step);
    if (at != reached.end() && at->step == step) return at->rows;
    Six<T>* const free = kappa.data() + rows * used++;
    std::fill(free, free + rows, Six<T>::zero());
    reached.insert(at, {step, free});
    return free;
  }

  void begin(const Constraint& e, Index offset, Index rows) {
    if (e.joint != nullptr) (void)reach(e.joint->body, rows);
    else
      for (const auto& link : e.link->links) {
        Six<T>* const x = reach(link.body, rows) + offset;
        for (Index r = 0; r < e.rows(); ++r) add(x[r], load(tree->problem().K[link.first + r]));
      }
  }

  [[nodiscard]] bool on_joint(const Constraint& e, int step) const { return e.joint != nullptr && tree->plan().step[e.joint->body] == step; }

  void add_joint_rows(const Constraint& e, Index offset, int step, int dofs) {
    if (!on_joint(e, step)) return;
    factor->for_joint_rows(step, [&](int row, const T* k) {
      const Index r = row - e.row();
      for (int c = 0; r >= 0 && r < e.rows() && c < dofs; ++c) G[6 * (offset + r) + c] += k[c];
    });
  }

  /// Calls add(r, c, value) for the parts of entry (r, c) of the block of e and f, e == f or not; the diagonal alone for few of them.
  template <class Add> void sum(const Constraint& e, const Constraint& f, bool few, const Add& add) {
    const bool same = e.row() == f.row();
    const Index own = same ? 0 : e.rows(), rows = own + f.rows();  // f's stand behind e's
    used = 0;
    reached.clear();
    begin(e, 0, rows);
    if (!same) begin(f, own, rows);
    while (!reached.empty()) {
      const Reached last = reached.back();
      if (reached.size() == 1 && !on_joint(e, last.step) && !on_joint(f, last.step)) {
        for (Index c = 0; c < f.rows(); ++c) {
          const Six<T> moved = multiply(mobility[last.step], last.rows[own + c]);
          for (Index r = few ? c : 0; r < (few ? c + 1 : e.rows()); ++r) add(r, c, dot(last.rows[r], moved));
        }
        return;
      }
      reached.pop_back();
      pass(e, f, own, last, rows, few, add);
    }
  }

  /// The joint of a body, and what comes to its parent.
  template <class Add>
  void pass(const Constraint& e, const Constraint& f, Index own, const Reached& at, Index rows, bool few, const Add& add) {
    const typename Factor<T>::Joint j = factor->joint(at.step);
    for (Index r = 0; r < rows; ++r)
      for (int c = 0; c < j.dofs; ++c) G[6 * r + c] = dot(j.s[c], at.rows[r]);
    add_joint_rows(e, 0, at.step, j.dofs);
    if (own > 0) add_joint_rows(f, own, at.step, j.dofs);
    for (Index c = 0; c < f.rows(); ++c)
      for (Index r = few ? c : 0; r < (few ? c + 1 : e.rows()); ++r)
        for (int k = 0; k < j.dofs; ++k) add(r, c, T(G[6 * r + k] * j.d_inverse[k] * G[6 * (own + c) + k]));
    const int parent = tree->plan().parent[at.step];
    if (parent < 0) return;
    for (Index r = 0; r < rows; ++r)
      for (int c = 0; c < j.dofs; ++c) subtract_scaled(at.rows[r], j.w[c], G[6 * r + c]);
    const auto place = place_of(parent);
    if (place == reached.end() || place->step != parent) reached.insert(place, {parent, at.rows});
    else
      for (Index r = 0; r < rows; ++r) delassus::add(place->rows[r], at.rows[r]);
  }
};

template <class T> DelassusBlocks<T>::DelassusBlocks(std::shared_ptr<const Structure> structure) : own_(std::make_unique<Numbers>(std::move(structure))) {}
template <class T> DelassusBlocks<T>::DelassusBlocks(DelassusBlocks&&) noexcept = default;
template <class T> DelassusBlocks<T>::~DelassusBlocks() = default;

template <class T> Report DelassusBlocks<T>::update(const Problem<T>& problem) {
  if (!own_->owned) own_->owned = std::make_unique<TreeOperators<T>>(own_->structure);
  (void)own_->owned->update(problem);
  return own_->take(*own_->owned);
}

template <class T> Report DelassusBlocks<T>::update(TreeOperators<T>& tree) {
  require(tree.problem().structure == own_->structure, "DelassusBlocks::update: the problem has another structure");
  return own_->take(tree);
}

template <class T> Report DelassusBlocks<T>::diagonal(VectorX<T>& d) {
  Numbers& own = *own_;
  require(own.tree != nullptr, "DelassusBlocks: call update first");
  d.setConstant(own.structure->rows, own.factored.ok() ? T(0) : ScalarTraits<T>::nan());
  if (own.factored.ok())
    for (const auto& e : own.constraints)
      own.sum(e, e, true, [&](Index r, Index, const T& value) { d[e.row() + r] += value; });
  return own.factored;
}

template <class T> Report DelassusBlocks<T>::block(Index e, Index f, MatrixX<T>& out) {
  Numbers& own = *own_;
  require(own.tree != nullptr, "DelassusBlocks: call update first");
  const auto count = static_cast<Index>(own.constraints.size());
  require(e >= 0 && e < count && f >= 0 && f < count, "DelassusBlocks::block: there is no such constraint");
  out.setConstant(own.constraints[e].rows(), own.constraints[f].rows(), own.factored.ok() ? T(0) : ScalarTraits<T>::nan());
  if (own.factored.ok()) own.sum(own.constraints[e], own.constraints[f], false, [&](Index r, Index c, const T& value) { out(r, c) += value; });
  return own.factored;
}

#define DELASSUS_INSTANTIATE(T) template class DelassusBlocks<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
