#include "simulation/islands.h"

#include <algorithm>
#include <numeric>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/index.h"

namespace delassus::simulation {
namespace {

Index first_of(std::vector<Index>& first, Index tree) {
  while (first[z(tree)] != tree) tree = first[z(tree)] = first[z(first[z(tree)])];
  return tree;
}

}  // namespace

void Islands::unite(std::vector<Index>& first, Index a, Index b) {
  a = first_of(first, a), b = first_of(first, b);
  first[z(std::max(a, b))] = std::min(a, b);
}

/// Every tree points at one before it, or at itself.
void Islands::flatten(std::vector<Index>& first) {
  for (Index& f : first) f = first[z(f)];
}

Islands::Islands(const Structure& s) {
  for (Index i = 0; i < s.bodies(); ++i) {
    if (s.parent[i] == ground) root_of_.push_back(i);
    tree_of_.push_back(s.parent[i] == ground ? static_cast<Index>(root_of_.size()) - 1 : tree_of_[z(s.parent[i])]);
  }
  loops_.resize(root_of_.size());
  std::iota(loops_.begin(), loops_.end(), Index{0});
  tree_of_row_.assign(z(s.rows), -1);
  for (const auto& c : s.link_constraints) {
    for (const auto& link : c.links) unite(loops_, tree_of(c.links[0].body), tree_of(link.body));
    if (!c.links.empty()) std::fill_n(tree_of_row_.begin() + c.row, c.rows, tree_of(c.links[0].body));
  }
  for (const auto& c : s.joint_constraints) std::fill_n(tree_of_row_.begin() + c.row, c.rows, tree_of(c.body));
  flatten(loops_);
  island_ = loops_;
  own_.resize(root_of_.size());
  for (Index i = 0; i < s.bodies(); ++i) own_[z(tree_of(i))].bodies.push_back(i);
  for (std::size_t k = 0; k < s.link_constraints.size(); ++k) {
    const auto& c = s.link_constraints[k];
    own_[c.links.empty() ? 0 : z(tree_of(c.links[0].body))].rows.push_back({c.row, true, k});
  }
  for (std::size_t k = 0; k < s.joint_constraints.size(); ++k) own_[z(tree_of(s.joint_constraints[k].body))].rows.push_back({s.joint_constraints[k].row, false, k});
}

template <class T> Part<T>::Part(const Structure& whole, const Islands& islands, const std::vector<Index>& trees) {
  std::vector<Islands::Own::Rows> constraints;  // of both kinds in the order of their rows
  for (const Index t : trees) {
    const Islands::Own& own_of = islands.of(t);
    bodies.insert(bodies.end(), own_of.bodies.begin(), own_of.bodies.end());
    constraints.insert(constraints.end(), own_of.rows.begin(), own_of.rows.end());
  }
  std::sort(bodies.begin(), bodies.end());
  std::sort(constraints.begin(), constraints.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  auto made = std::make_shared<Structure>();
  for (const Index i : bodies) {
    for (Index k = whole.first_dof[i]; k < whole.first_dof[i + 1]; ++k) dofs.push_back(k);
    made->add_body(whole.parent[i] == ground ? ground : own(whole.parent[i]), whole.dofs(i));
  }
  for (const auto& e : constraints) {
    if (e.link) {
      const auto& c = whole.link_constraints[e.which];
      std::vector<Index> on;
      for (const auto& l : c.links) on.push_back(own(l.body));
      const auto& to = made->link_constraints[z(made->add_link_constraint(c.rows, on))];
      for (std::size_t k = 0; k < c.links.size(); ++k) K_.push_back({to.links[k].first, c.links[k].first, c.rows});
      for (Index r = 0; r < c.rows; ++r) rows.push_back(c.row + r);
    } else {
      const auto& c = whole.joint_constraints[e.which];
      const auto& to = made->joint_constraints[z(made->add_joint_constraint(c.rows, own(c.body)))];
      joint_K_.push_back({to.first, c.first, c.rows * whole.dofs(c.body)});
      for (Index r = 0; r < c.rows; ++r) rows.push_back(c.row + r);
    }
  }
  structure = made;
  problem = Problem<T>(structure);
}

template <class T> Index Part<T>::own(Index body) const {
  return static_cast<Index>(std::lower_bound(bodies.begin(), bodies.end(), body) - bodies.begin());
}

template <class T> void Part<T>::take(const Problem<T>& whole) {
  for (std::size_t k = 0; k < dofs.size(); ++k) problem.S[k] = whole.S[z(dofs[k])], problem.armature[k] = whole.armature[z(dofs[k])];
  for (std::size_t i = 0; i < bodies.size(); ++i) problem.H[i] = whole.H[z(bodies[i])];
  for (const Copied& c : K_) std::copy_n(whole.K.begin() + c.from, c.size, problem.K.begin() + c.to);
  for (const Copied& c : joint_K_) std::copy_n(whole.joint_K.begin() + c.from, c.size, problem.joint_K.begin() + c.to);
}

template <class T> Damping<double> Part<T>::damping(const Damping<double>& whole) const {
  Damping<double> out;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    out.diagonal.push_back(whole.diagonal[z(rows[k])]);
    for (const auto& block : whole.blocks)
      if (block.row == rows[k]) out.blocks.push_back({static_cast<Index>(k), block.R_inverse});
  }
  return out;
}

template <class T> void Part<T>::gather(const VectorX<T>& whole, VectorX<T>& own) const {
  own.resize(static_cast<Index>(dofs.size()));
  for (std::size_t k = 0; k < dofs.size(); ++k) own[static_cast<Index>(k)] = whole[dofs[k]];
}

template <class T> void Part<T>::scatter(const VectorX<T>& own, VectorX<T>& whole) const {
  for (std::size_t k = 0; k < dofs.size(); ++k) whole[dofs[k]] = own[static_cast<Index>(k)];
}

template <class T> Index Part<T>::bytes() const {
  const std::size_t numbers = dofs.size() * (sizeof(Vector6<T>) + sizeof(T)) + bodies.size() * sizeof(Matrix6<T>) + problem.K.size() * sizeof(Vector6<T>) + problem.joint_K.size() * sizeof(T);
  return static_cast<Index>(numbers + (bodies.size() + dofs.size() + rows.size()) * sizeof(Index) + (K_.size() + joint_K_.size()) * sizeof(Copied));
}

template class Part<double>;
template class Part<Counted>;

}  // namespace delassus::simulation
