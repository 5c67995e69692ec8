#include "reference/zeros.h"

#include <algorithm>
#include <numeric>

#include "reference/definition.h"

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

/// Degrees of freedom 0…n−1 and, while joining, one node per component of each body.
Classes coupled_dofs(const Problem<double>& p) {
  const Structure& s = *p.structure;
  const Index n = s.dofs();
  Classes classes(n + 6 * s.bodies());
  for (Index i = 0; i < s.bodies(); ++i) {
    const Index node = n + 6 * i;
    for (Index c = 0; c < 6; ++c)
      for (Index r = 0; r < 6; ++r)
        if (p.H[i](r, c) != 0) classes.join(node + r, node + c);
    for (const Index k : path_dofs(s, i))
      for (Index c = 0; c < 6; ++c)
        if (p.S[k][c] != 0 && !p.H[i].col(c).isZero(0)) classes.join(k, node + c);
  }
  return classes;
}

/// Per row, the degrees of freedom it touches.
std::vector<std::vector<Index>> touched_dofs(const Problem<double>& p) {
  const Structure& s = *p.structure;
  std::vector<std::vector<Index>> out(static_cast<std::size_t>(s.rows));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (const Index k : path_dofs(s, link.body))
        for (Index r = 0; r < e.rows; ++r)
          if (!p.K[link.first + r].cwiseProduct(p.S[k]).isZero(0)) out[e.row + r].push_back(k);
  for (const auto& j : s.joint_constraints) {
    const Index n = s.dofs(j.body);
    for (Index r = 0; r < j.rows; ++r)
      for (Index k = 0; k < n; ++k)
        if (p.joint_K[j.first + r * n + k] != 0) out[j.row + r].push_back(s.first_dof[j.body] + k);
  }
  return out;
}

}  // namespace

Zeros::Zeros(const Problem<double>& problem, const Damping<double>& damping) : touched_(touched_dofs(problem)) {
  const Index m = problem.structure->rows;
  Classes dofs = coupled_dofs(problem);
  dof_classes_ = problem.structure->dofs() + 6 * problem.structure->bodies();
  for (auto& row : touched_) {
    for (Index& k : row) k = dofs.find(k);
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
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
