#include "algorithms/factors/branch_rows.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {
namespace {

/// A constraint, in the order of rows.
struct Part {
  Index row, rows;
  std::vector<Index> bodies;
  const Structure::LinkConstraint* link;
  const Structure::JointConstraint* joint;
};

std::vector<Part> parts_of(const Structure& s) {
  std::vector<Part> parts;
  for (const auto& e : s.link_constraints) {
    parts.push_back({e.row, e.rows, {}, &e, nullptr});
    for (const auto& link : e.links) parts.back().bodies.push_back(link.body);
  }
  for (const auto& e : s.joint_constraints) parts.push_back({e.row, e.rows, {e.body}, nullptr, &e});
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.row < b.row; });
  return parts;
}

}  // namespace

template <class T> void BranchRows<T>::analyze(const Structure& structure, const BranchFactor<T>& factor) {
  factor_ = &factor;
  groups_.clear(), dofs_.clear(), above_.clear(), on_links_.clear(), on_joints_.clear();
  Index size = 0;
  const std::vector<Part> parts = parts_of(structure);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Part& part = parts[k];
    if (k == 0 || part.bodies != parts[k - 1].bodies) {
      groups_.push_back({part.row, 0, static_cast<Index>(dofs_.size()), 0, 0});
      find_support(groups_.back(), part.bodies);
    }
    Group& g = groups_.back();
    const Index group = static_cast<Index>(groups_.size()) - 1, offset = part.row - g.row;
    g.rows += part.rows;
    if (part.joint != nullptr && structure.dofs(part.joint->body) > 0)
      on_joints_.push_back({group, offset, part.rows, part.joint->first, place_of(g, structure.first_dof[part.joint->body]), structure.dofs(part.joint->body)});
    if (part.link != nullptr)
      for (const auto& link : part.link->links)
        if (factor.last_dof(link.body) >= 0) on_links_.push_back({group, offset, part.rows, link.first, place_of(g, factor.last_dof(link.body))});
  }
  for (Group& g : groups_) {
    g.values = size;
    size += g.rows * g.count;
  }
  values_.assign(static_cast<std::size_t>(size + 7), T(0));  // add_thin_product reads beyond
}

template <class T> void BranchRows<T>::find_support(Group& g, const std::vector<Index>& bodies) {
  std::vector<Index> support;
  for (const Index body : bodies)
    for (Index k = factor_->last_dof(body); k >= 0; k = factor_->above(k)) support.push_back(k);
  std::sort(support.begin(), support.end());
  support.erase(std::unique(support.begin(), support.end()), support.end());
  g.count = static_cast<Index>(support.size());
  dofs_.insert(dofs_.end(), support.begin(), support.end());
  for (const Index k : support) above_.push_back(factor_->above(k) < 0 ? -1 : place_of(g, factor_->above(k)));
}

template <class T> Index BranchRows<T>::place_of(const Group& g, Index dof) const {
  const auto begin = dofs_.begin() + g.first;
  return std::lower_bound(begin, begin + g.count, dof) - begin;
}

template <class T> void BranchRows<T>::assemble(const Problem<T>& problem) {
  std::fill(values_.begin(), values_.end(), T(0));
  for (const OnLink& k : on_links_) {
    const Group& g = groups_[k.group];
    for (Index p = k.place; p >= 0; p = above(g, p)) {
      T* const y = column(g, p) + k.offset;
      for (Index r = 0; r < k.rows; ++r) y[r] += problem.K[k.first + r].dot(problem.S[dof(g, p)]);
    }
  }
  for (const OnJoint& k : on_joints_) {
    const Group& g = groups_[k.group];
    for (Index c = 0; c < k.dofs; ++c)
      for (Index r = 0; r < k.rows; ++r) column(g, k.place + c)[k.offset + r] += problem.joint_K[k.first + r * k.dofs + c];
  }
}

template <class T> void BranchRows<T>::add_transposed(const T* x, T* z) const {
  for (const Group& g : groups_)
    for (Index p = 0; p < g.count; ++p) {
      T& sum = z[dof(g, p)];
      for (Index r = 0; r < g.rows; ++r) sum += column(g, p)[r] * x[g.row + r];
    }
}

template <class T> void BranchRows<T>::subtract_scaled(const T* z, T* x) const {
  for (const Group& g : groups_)
    for (Index p = 0; p < g.count; ++p) {
      const T scaled = z[dof(g, p)] * factor_->inverse_pivot(dof(g, p));
      for (Index r = 0; r < g.rows; ++r) x[g.row + r] -= column(g, p)[r] * scaled;
    }
}

template <class T> Index BranchRows<T>::bytes() const {
  return static_cast<Index>(sizeof(T) * values_.size() + sizeof(Group) * groups_.size() + sizeof(Index) * (dofs_.size() + above_.size()) +
                            sizeof(OnLink) * on_links_.size() + sizeof(OnJoint) * on_joints_.size());
}

#define DELASSUS_INSTANTIATE(T) template class BranchRows<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
