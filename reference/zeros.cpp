#include "algorithms/kit/test_scalars.h"
#include "reference/zeros.h"

#include <algorithm>
#include <numeric>

namespace delassus::reference {

namespace {

/// Disjoint sets with path halving.
class Classes {
 public:
  explicit Classes(Index n) : parent_(static_cast<std::size_t>(n)) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index i, Index j) { parent_[find(i)] = find(j); }

 private:
  std::vector<Index> parent_;
};

/// Joins degrees of freedom that M couples. Nodes: degrees of freedom 0…n−1, then one per component of each body; the
/// node (i, c) is in the class of every degree of freedom that moves body i along c, when H_i has a column c.
class Coupling {
 public:
  explicit Coupling(const Problem<double>& p)
      : p_(p), s_(*p.structure), classes_(nodes()), moved_(6 * s_.parent.size(), 0), heavy_(6 * s_.parent.size(), 0) {
    for (Index i = 0; i < s_.bodies(); ++i) add(i);
  }
  [[nodiscard]] Index nodes() const { return s_.dofs() + 6 * s_.bodies(); }
  Index find(Index node) { return classes_.find(node); }

  /// Calls visit for nodes whose classes hold every degree of freedom that moves body i along c, and no other class.
  template <class Visit> void movers(Index i, Index c, const Visit& visit) const {
    for (; i != ground && moved_[6 * i + c]; i = s_.parent[i]) {
      if (heavy_[6 * i + c]) return visit(node(i, c));
      own(i, c, visit);
    }
  }

 private:
  [[nodiscard]] Index node(Index i, Index c) const { return s_.dofs() + 6 * i + c; }
  template <class Visit> void own(Index i, Index c, const Visit& visit) const {
    for (Index k = s_.first_dof[i]; k < s_.first_dof[i + 1]; ++k)
      if (p_.S[k][c] != 0) visit(k);
  }
  void add(Index i) {
    for (Index c = 0; c < 6; ++c) {
      heavy_[6 * i + c] = !p_.H[i].col(c).isZero(0);
      const auto join = [&](Index other) {
        moved_[6 * i + c] = 1;
        if (heavy_[6 * i + c]) classes_.join(node(i, c), other);
      };
      own(i, c, join);
      if (s_.parent[i] != ground) movers(s_.parent[i], c, join);
    }
    for (Index c = 0; c < 6; ++c)
      for (Index r = 0; r < c; ++r)
        if (moved_[6 * i + c] && moved_[6 * i + r] && p_.H[i](r, c) != 0) classes_.join(node(i, c), node(i, r));
  }

  const Problem<double>& p_;
  const Structure& s_;
  Classes classes_;
  std::vector<char> moved_, heavy_;  // per node (i, c): something moves it; H_i has a column c
};

/// Per row, the classes of the degrees of freedom it touches.
std::vector<std::vector<Index>> touched_classes(const Problem<double>& p, Coupling& coupling) {
  const Structure& s = *p.structure;
  std::vector<std::vector<Index>> out(static_cast<std::size_t>(s.rows));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r)
        for (Index c = 0; c < 6; ++c)
          if (p.K[link.first + r][c] != 0)
            coupling.movers(link.body, c, [&](Index node) { out[e.row + r].push_back(coupling.find(node)); });
  for (const auto& j : s.joint_constraints) {
    const Index n = s.dofs(j.body);
    for (Index r = 0; r < j.rows; ++r)
      for (Index k = 0; k < n; ++k)
        if (p.joint_K[j.first + r * n + k] != 0) out[j.row + r].push_back(coupling.find(s.first_dof[j.body] + k));
  }
  for (auto& row : out) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return out;
}

}  // namespace

Zeros::Zeros(const Problem<double>& problem, const Damping<double>& damping) {
  const Index m = problem.structure->rows;
  Coupling coupling(problem);
  dof_classes_ = coupling.nodes();
  touched_ = touched_classes(problem, coupling);
  damping_.resize(static_cast<std::size_t>(m));
  for (Index r = 0; r < m; ++r)
    if (damping.diagonal[r] != 0) damping_[r].push_back(r);
  for (const auto& block : damping.blocks)
    for (Index j = 0; j < block.R_inverse.cols(); ++j)
      for (Index i = 0; i < block.R_inverse.rows(); ++i)
        if (block.R_inverse(i, j) != 0) damping_[block.row + i].push_back(block.row + j);
  Classes all(dof_classes_ + m);
  for (Index r = 0; r < m; ++r) {
    for (const Index k : touched_[r]) all.join(dof_classes_ + r, k);
    for (const Index j : damping_[r]) all.join(dof_classes_ + r, dof_classes_ + j);
  }
  for (Index r = 0; r < m; ++r) row_class_.push_back(all.find(dof_classes_ + r));
}

void Zeros::clear_apply(const MatrixX<double>& f, MatrixX<Quad>& a) const {
  const Index m = f.rows();
  for (Index c = 0; c < f.cols(); ++c) {
    std::vector<char> moved(static_cast<std::size_t>(dof_classes_), 0);
    for (Index r = 0; r < m; ++r)
      if (f(r, c) != 0)
        for (const Index k : touched_[r]) moved[k] = 1;
    for (Index r = 0; r < m; ++r) {
      const bool reached = std::any_of(touched_[r].begin(), touched_[r].end(), [&](Index k) { return moved[k] != 0; }) ||
                           std::any_of(damping_[r].begin(), damping_[r].end(), [&](Index j) { return f(j, c) != 0; });
      if (!reached) a(r, c) = Quad(0);
    }
  }
}

void Zeros::clear_solve(const MatrixX<double>& a, MatrixX<Quad>& f) const {
  const Index m = a.rows();
  for (Index c = 0; c < a.cols(); ++c) {
    std::vector<char> loaded(static_cast<std::size_t>(dof_classes_ + m), 0);
    for (Index r = 0; r < m; ++r)
      if (a(r, c) != 0) loaded[row_class_[r]] = 1;
    for (Index r = 0; r < m; ++r)
      if (!loaded[row_class_[r]]) f(r, c) = Quad(0);
  }
}

}  // namespace delassus::reference
