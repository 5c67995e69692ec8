#include "algorithms/dynamics/delassus_blocks.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/scalars.h"

namespace delassus {

template <class T> struct DelassusBlocks<T>::Numbers {
  using Rows = Eigen::Map<Eigen::Matrix<T, 6, Eigen::Dynamic>>;  // κᵀ: a force per column
  struct Reached {  // a body, and the numbers of its κᵀ
    Index body;
    T* rows;
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
  Problem<T> problem;
  std::vector<Matrix6<T>> inertia, mobility;
  std::vector<Vector6<T>> U;
  std::vector<T> inverse;        // 1/D
  std::vector<T> kappa, G;       // scratch
  std::vector<Reached> reached;  // bodies, farthest from the roots last
  Index used = 0;                // of kappa
  Report factored;
  bool updated = false;

  explicit Numbers(std::shared_ptr<const Structure> s) : structure(std::move(s)) {
    require(structure != nullptr, "DelassusBlocks: no structure");
    structure->validate();
    Index rows = 0, bodies = 0;
    for (const auto& e : structure->link_constraints) constraints.push_back({&e, nullptr});
    for (const auto& e : structure->joint_constraints) constraints.push_back({nullptr, &e});
    for (const Constraint& e : constraints) rows = std::max(rows, 2 * e.rows()), bodies = std::max(bodies, 2 * e.bodies());
    problem = Problem<T>(structure);
    inertia.assign(static_cast<std::size_t>(structure->bodies()), Matrix6<T>::Zero());
    mobility = inertia;
    U.assign(static_cast<std::size_t>(structure->dofs()), Vector6<T>::Zero());
    inverse.assign(U.size(), T(0));
    kappa.assign(static_cast<std::size_t>(6 * rows * bodies), T(0));
    G.assign(static_cast<std::size_t>(rows), T(0));
    reached.reserve(static_cast<std::size_t>(bodies));
  }

  Report inwards() {
    const Structure& s = *structure;
    inertia = problem.H;
    for (Index i = s.bodies(); i-- > 0;) {
      Matrix6<T>& H = inertia[i];
      for (Index k = s.first_dof[i + 1]; k-- > s.first_dof[i];) {
        U[k] = H * problem.S[k];
        const T pivot = problem.S[k].dot(U[k]) + problem.armature[k];
        if (!ScalarTraits<T>::usable_pivot(pivot)) return {Status::lost_pivot, s.first_dof[i]};
        inverse[k] = T(1) / pivot;
        const Vector6<T> scaled = U[k] * inverse[k];
        H -= scaled * U[k].transpose();
      }
      if (s.parent[i] != ground) inertia[s.parent[i]] += H;
    }
    return {};
  }

  void outwards() {
    const Structure& s = *structure;
    for (Index i = 0; i < s.bodies(); ++i) {
      Matrix6<T>& Omega = mobility[i];
      if (s.parent[i] == ground) Omega.setZero();
      else Omega = mobility[s.parent[i]];
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {  // P Ω Pᵀ + S D⁻¹ Sᵀ
        const Vector6<T> S = problem.S[k] * inverse[k], OU = Omega * U[k];
        const T both = U[k].dot(OU) + T(1) / inverse[k];
        Omega += S * S.transpose() * both - S * OU.transpose() - OU * S.transpose();
      }
    }
  }

  /// Where a body stands among those reached, or would.
  auto place_of(Index body) {
    return std::lower_bound(reached.begin(), reached.end(), body, [](const Reached& x, Index b) { return x.body < b; });
  }

  /// κᵀ of a body; zeros where it was not reached before.
  Rows reach(Index body, Index rows) {
    const auto at = place_of(body);
    if (at != reached.end() && at->body == body) return Rows(at->rows, 6, rows);
    T* const free = kappa.data() + 6 * rows * used++;
    std::fill(free, free + 6 * rows, T(0));
    reached.insert(at, {body, free});
    return Rows(free, 6, rows);
  }

  void begin(const Constraint& e, Index offset, Index rows) {
    if (e.joint != nullptr) reach(e.joint->body, rows);
    else
      for (const auto& link : e.link->links) {
        Rows x = reach(link.body, rows);
        for (Index r = 0; r < e.rows(); ++r) x.col(offset + r) += problem.K[link.first + r];
      }
  }

  void add_joint_rows(const Constraint& e, Index offset, Index body, Index k) {
    if (e.joint == nullptr || e.joint->body != body) return;
    const Index n = structure->dofs(body), c = k - structure->first_dof[body];
    for (Index r = 0; r < e.rows(); ++r) G[offset + r] += problem.joint_K[e.joint->first + r * n + c];
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
      const Rows x(last.rows, 6, rows);
      const bool joint_rows = (e.joint != nullptr && e.joint->body == last.body) || (f.joint != nullptr && f.joint->body == last.body);
      if (reached.size() == 1 && !joint_rows) {
        for (Index c = 0; c < f.rows(); ++c) {
          const Vector6<T> moved = mobility[last.body] * x.col(own + c);
          for (Index r = few ? c : 0; r < (few ? c + 1 : e.rows()); ++r) add(r, c, T(x.col(r).dot(moved)));
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
    const Structure& s = *structure;
    Rows x(at.rows, 6, rows);
    for (Index k = s.first_dof[at.body + 1]; k-- > s.first_dof[at.body];) {
      for (Index r = 0; r < rows; ++r) G[r] = x.col(r).dot(problem.S[k]);
      add_joint_rows(e, 0, at.body, k);
      if (own > 0) add_joint_rows(f, own, at.body, k);
      for (Index c = 0; c < f.rows(); ++c)
        for (Index r = few ? c : 0; r < (few ? c + 1 : e.rows()); ++r) add(r, c, T(G[r] * inverse[k] * G[own + c]));
      for (Index r = 0; r < rows; ++r) x.col(r) -= U[k] * T(G[r] * inverse[k]);
    }
    const Index parent = s.parent[at.body];
    if (parent == ground) return;
    const auto place = place_of(parent);
    if (place != reached.end() && place->body == parent) Rows(place->rows, 6, rows) += x;
    else reached.insert(place, {parent, at.rows});
  }
};

template <class T> DelassusBlocks<T>::DelassusBlocks(std::shared_ptr<const Structure> structure) : own_(std::make_unique<Numbers>(std::move(structure))) {}
template <class T> DelassusBlocks<T>::DelassusBlocks(DelassusBlocks&&) noexcept = default;
template <class T> DelassusBlocks<T>::~DelassusBlocks() = default;

template <class T> Report DelassusBlocks<T>::update(const Problem<T>& problem) {
  Numbers& own = *own_;
  require(problem.structure == own.structure, "DelassusBlocks::update: the problem has another structure");
  problem.check_sizes();
  own.problem = problem;
  own.updated = true;
  own.factored = own.inwards();
  if (own.factored.ok()) own.outwards();
  return own.factored;
}

template <class T> Report DelassusBlocks<T>::diagonal(VectorX<T>& d) {
  Numbers& own = *own_;
  require(own.updated, "DelassusBlocks: call update first");
  d.setConstant(own.structure->rows, own.factored.ok() ? T(0) : ScalarTraits<T>::nan());
  if (own.factored.ok())
    for (const auto& e : own.constraints)
      own.sum(e, e, true, [&](Index r, Index, const T& value) { d[e.row() + r] += value; });
  return own.factored;
}

template <class T> Report DelassusBlocks<T>::block(Index e, Index f, MatrixX<T>& out) {
  Numbers& own = *own_;
  require(own.updated, "DelassusBlocks: call update first");
  const auto count = static_cast<Index>(own.constraints.size());
  require(e >= 0 && e < count && f >= 0 && f < count, "DelassusBlocks::block: there is no such constraint");
  out.setConstant(own.constraints[e].rows(), own.constraints[f].rows(), own.factored.ok() ? T(0) : ScalarTraits<T>::nan());
  if (own.factored.ok()) own.sum(own.constraints[e], own.constraints[f], false, [&](Index r, Index c, const T& value) { out(r, c) += value; });
  return own.factored;
}

#define DELASSUS_INSTANTIATE(T) template class DelassusBlocks<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
