#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/parts.h"

#include <algorithm>

#include "algorithms/kit/index.h"

namespace delassus::laws {
namespace {

/// `size` numbers of `from`, row-major, as a matrix.
template <class T> MatrixX<T> matrix(const T* from, Index rows, Index columns) {
  MatrixX<T> out(rows, columns);
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < columns; ++k) out(r, k) = from[r * columns + k];
  return out;
}

template <class T> typename Parts<T>::Constraint rows_of(Index row, Index rows, const Damping<T>& d) {
  typename Parts<T>::Constraint c;
  for (Index r = row; r < row + rows; ++r) {
    c.from.push_back(r);
    c.diagonal.push_back(d.diagonal[z(r)]);
  }
  for (auto block : d.blocks) {
    if (block.row < row || block.row >= row + rows) continue;
    block.row -= row;
    c.blocks.push_back(std::move(block));
  }
  return c;
}

/// Bodies so that parents come first, otherwise in their order.
template <class T> std::vector<Index> parents_first(const Parts<T>& parts) {
  std::vector<Index> order;
  std::vector<bool> placed(parts.bodies.size(), false);
  while (order.size() < parts.bodies.size()) {
    const std::size_t before = order.size();
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Index up = parts.bodies[i].parent;
      if (placed[i] || (up != ground && !placed[z(up)])) continue;
      placed[i] = true;
      order.push_back(static_cast<Index>(i));
    }
    require(order.size() > before, "together: the parents form a cycle");
  }
  return order;
}

template <class T>
std::shared_ptr<Structure> structure(const Parts<T>& parts, const std::vector<Index>& order, const std::vector<Index>& name) {
  auto s = std::make_shared<Structure>();
  for (const Index i : order) {
    const auto& b = parts.bodies[z(i)];
    s->add_body(b.parent == ground ? ground : name[z(b.parent)], b.S.cols());
  }
  for (const auto& c : parts.constraints) {
    std::vector<Index> bodies;
    for (const auto& l : c.links) bodies.push_back(name[z(l.body)]);
    if (c.links.empty()) s->add_joint_constraint(c.rows(), name[z(c.joint)]);
    else s->add_link_constraint(c.rows(), bodies);
  }
  return s;
}

template <class T> void fill_bodies(const Parts<T>& parts, const std::vector<Index>& order, Problem<T>& p) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& b = parts.bodies[z(order[i])];
    p.H[i] = b.H;
    for (Index j = 0; j < b.S.cols(); ++j, ++k) {
      p.S[k] = b.S.col(j);
      p.armature[k] = b.armature[z(j)];
    }
  }
}

template <class T> void fill_rows(const Parts<T>& parts, Second<T>& out) {
  Problem<T>& p = out.numbers.problem;
  std::size_t link = 0, joint = 0;  // rows of K and entries of 𝒦 filled so far
  for (const auto& c : parts.constraints) {
    const auto row = static_cast<Index>(out.from.size());
    for (const auto& l : c.links)
      for (Index r = 0; r < c.rows(); ++r) p.K[link++] = l.K.row(r).transpose();
    for (Index r = 0; r < c.joint_K.rows(); ++r)
      for (Index k = 0; k < c.joint_K.cols(); ++k) p.joint_K[joint++] = c.joint_K(r, k);
    out.from.insert(out.from.end(), c.from.begin(), c.from.end());
    auto& diagonal = out.numbers.damping.diagonal;
    diagonal.insert(diagonal.end(), c.diagonal.begin(), c.diagonal.end());
    for (auto block : c.blocks) {
      block.row += row;
      out.numbers.damping.blocks.push_back(std::move(block));
    }
  }
}

}  // namespace

template <class T> Index Parts<T>::add_body(Index parent, MatrixX<T> S) {
  std::vector<T> armature(z(S.cols()), T(0));
  bodies.push_back({parent, std::move(S), std::move(armature), Matrix6<T>::Constant(T(0))});
  return count() - 1;
}

template <class T> typename Parts<T>::Constraint& Parts<T>::add_hard(Index rows) {
  Constraint& c = constraints.emplace_back();
  c.from.assign(z(rows), added);
  c.diagonal.assign(z(rows), T(0));
  return c;
}

template <class T> void Parts<T>::add_link(Constraint& c, Index body, const MatrixX<T>& K) {
  if (body == ground) return;
  for (Link& l : c.links)
    if (l.body == body) {
      l.K += K;
      return;
    }
  c.links.push_back({body, K});
}

template <class T> Parts<T> apart(const Problem<T>& p, const Damping<T>& d) {
  const Structure& s = *p.structure;
  Parts<T> out;
  for (Index i = 0; i < s.bodies(); ++i) {
    const Index index = out.add_body(s.parent[z(i)], MatrixX<T>(6, s.dofs(i)));
    auto& b = out.body(index);
    b.H = p.H[z(i)];
    for (Index k = 0; k < s.dofs(i); ++k) {
      b.S.col(k) = p.S[z(s.first_dof[z(i)] + k)];
      b.armature[z(k)] = p.armature[z(s.first_dof[z(i)] + k)];
    }
  }
  for (const auto& e : s.link_constraints) {
    auto& c = out.constraints.emplace_back(rows_of(e.row, e.rows, d));
    for (const auto& l : e.links) {
      MatrixX<T> K(e.rows, 6);
      for (Index r = 0; r < e.rows; ++r) K.row(r) = p.K[z(l.first + r)].transpose();
      c.links.push_back({l.body, std::move(K)});
    }
  }
  for (const auto& e : s.joint_constraints) {
    auto& c = out.constraints.emplace_back(rows_of(e.row, e.rows, d));
    c.joint = e.body;
    c.joint_K = matrix(p.joint_K.data() + e.first, e.rows, s.dofs(e.body));
  }
  std::sort(out.constraints.begin(), out.constraints.end(),
            [](const auto& a, const auto& b) { return a.from.front() < b.from.front(); });
  return out;
}

template <class T> Second<T> together(const Parts<T>& parts) {
  const std::vector<Index> order = parents_first(parts);
  std::vector<Index> name(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) name[z(order[k])] = static_cast<Index>(k);
  Second<T> out{{Problem<T>(structure(parts, order, name)), {}}, {}};
  fill_bodies(parts, order, out.numbers.problem);
  fill_rows(parts, out);
  return out;
}

#define DELASSUS_PARTS(T)                                                        \
  template struct Parts<T>;                                                      \
  template Parts<T> apart(const Problem<T>&, const Damping<T>&);                 \
  template Second<T> together(const Parts<T>&);
DELASSUS_PARTS(double)
DELASSUS_PARTS(Rational)
#undef DELASSUS_PARTS

}  // namespace delassus::laws
