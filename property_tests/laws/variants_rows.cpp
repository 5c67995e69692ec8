#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/variants_rows.h"

#include <algorithm>
#include <utility>

#include "generators/random.h"

namespace delassus::laws {
namespace {

template <class T> void scale(typename Parts<T>::Constraint& c, const T& factor) {
  for (T& r : c.diagonal) r *= factor;
  for (auto& b : c.blocks) b.R_inverse *= factor;
}

template <class T> typename Parts<T>::Constraint& chosen(Parts<T>& parts, std::uint64_t seed) {
  return parts.constraints[seed % parts.constraints.size()];
}

template <class T> bool splits(const typename Parts<T>::Constraint& c) { return c.rows() > 1 && c.blocks.empty(); }

/// Row r of a constraint whose R⁻¹ has no block.
template <class T> typename Parts<T>::Constraint single_row(const typename Parts<T>::Constraint& c, Index r) {
  typename Parts<T>::Constraint one;
  one.from = {c.from[static_cast<std::size_t>(r)]};
  one.diagonal = {c.diagonal[static_cast<std::size_t>(r)]};
  for (const auto& l : c.links) one.links.push_back({l.body, l.K.row(r)});
  one.joint = c.joint;
  if (c.joint != ground) one.joint_K = c.joint_K.row(r);
  return one;
}

template <class T> std::vector<Index> bodies_of(const typename Parts<T>::Constraint& c) {
  std::vector<Index> bodies;
  for (const auto& l : c.links) bodies.push_back(l.body);
  std::sort(bodies.begin(), bodies.end());
  return bodies;
}

template <class T> bool alike(const typename Parts<T>::Constraint& a, const typename Parts<T>::Constraint& b) {
  return a.joint == b.joint && bodies_of<T>(a) == bodies_of<T>(b);
}

/// Constraint j as rows below those of constraint i < j.
template <class T> void stack(Parts<T>& parts, std::size_t i, std::size_t j) {
  auto& c = parts.constraints[i];
  const auto below = std::move(parts.constraints[j]);
  parts.constraints.erase(parts.constraints.begin() + static_cast<std::ptrdiff_t>(j));
  const Index above = c.rows(), rows = above + below.rows();
  for (auto& l : c.links) {
    MatrixX<T> K = MatrixX<T>::Constant(rows, 6, T(0));
    K.topRows(above) = l.K;
    l.K = std::move(K);
  }
  for (const auto& l : below.links) {
    MatrixX<T> K = MatrixX<T>::Constant(rows, 6, T(0));
    K.bottomRows(below.rows()) = l.K;
    parts.add_link(c, l.body, K);
  }
  MatrixX<T> joint_K(rows, c.joint_K.cols());
  if (c.joint != ground) joint_K << c.joint_K, below.joint_K;
  c.joint_K = std::move(joint_K);
  c.from.insert(c.from.end(), below.from.begin(), below.from.end());
  c.diagonal.insert(c.diagonal.end(), below.diagonal.begin(), below.diagonal.end());
  for (auto block : below.blocks) {
    block.row += above;
    c.blocks.push_back(std::move(block));
  }
}

template <class T> MatrixX<T> without_row(const MatrixX<T>& x, Index row) {
  MatrixX<T> y(x.rows() - 1, x.cols());
  y.topRows(row) = x.topRows(row);
  y.bottomRows(y.rows() - row) = x.bottomRows(y.rows() - row);
  return y;
}

/// Row k of a constraint left out, and its row and column of a block.
template <class T> void leave_out(typename Parts<T>::Constraint& c, Index k) {
  c.from.erase(c.from.begin() + k);
  c.diagonal.erase(c.diagonal.begin() + k);
  for (auto& l : c.links) l.K = without_row<T>(l.K, k);
  if (c.joint != ground) c.joint_K = without_row<T>(c.joint_K, k);
  for (auto& b : c.blocks) {
    const Index at = k - b.row;
    if (at < 0) --b.row;
    else if (at < b.R_inverse.rows()) b.R_inverse = without_row<T>(without_row<T>(b.R_inverse, at).transpose(), at);
  }
  std::erase_if(c.blocks, [](const auto& b) { return b.R_inverse.rows() == 0; });
}

}  // namespace

Index constraint_count(const Structure& s) {
  return static_cast<Index>(s.link_constraints.size() + s.joint_constraints.size());
}

template <class T> Second<T> one_left_out(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  parts.constraints.erase(parts.constraints.begin() + (&chosen(parts, seed) - parts.constraints.data()));
  return together(parts);
}

template <class T> Second<T> rows_left_out(const Problem<T>& p, const Damping<T>& d, const std::vector<Index>& rows) {
  Parts<T> parts = apart(p, d);
  for (auto& c : parts.constraints)
    for (Index k = c.rows(); k-- > 0;)
      if (std::find(rows.begin(), rows.end(), c.from[static_cast<std::size_t>(k)]) != rows.end()) leave_out<T>(c, k);
  std::erase_if(parts.constraints, [](const auto& c) { return c.rows() == 0; });
  return together(parts);
}

template <class T> Second<T> reordered(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  generators::Random random(seed + 17);
  auto& all = parts.constraints;
  for (std::size_t k = all.size(); k > 1; --k)
    std::swap(all[k - 1], all[static_cast<std::size_t>(random.integer(0, static_cast<int>(k) - 1))]);
  return together(parts);
}

template <class T> Second<T> with_idle_links(const Problem<T>& p, const Damping<T>& d) {
  Parts<T> parts = apart(p, d);
  for (auto& c : parts.constraints) {
    const std::size_t links = c.links.size();
    for (Index i = 0; links > 0 && c.links.size() == links && i < parts.count(); ++i)
      parts.add_link(c, i, MatrixX<T>::Constant(c.rows(), 6, T(0)));
  }
  return together(parts);
}

template <class T> Second<T> doubled(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  auto copy = chosen(parts, seed);
  scale<T>(chosen(parts, seed), T(3));
  scale<T>(copy, T(1.5));
  parts.constraints.push_back(std::move(copy));
  return together(parts);
}

bool can_split_rows(const Problem<double>& p, const Damping<double>& d) {
  const auto all = apart(p, d).constraints;
  return std::any_of(all.begin(), all.end(), splits<double>);
}

template <class T> Second<T> rows_split(const Problem<T>& p, const Damping<T>& d) {
  Parts<T> parts = apart(p, d);
  const auto whole = std::exchange(parts.constraints, {});
  for (const auto& c : whole) {
    if (!splits<T>(c)) parts.constraints.push_back(c);
    else for (Index r = 0; r < c.rows(); ++r) parts.constraints.push_back(single_row<T>(c, r));
  }
  return together(parts);
}

bool can_stack(const Problem<double>& p, const Damping<double>& d) {
  return constraint_count(*rows_stacked(p, d, 0).numbers.problem.structure) < constraint_count(*p.structure);
}

template <class T> Second<T> rows_stacked(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  auto& all = parts.constraints;
  const std::size_t before = all.size();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size();) {
      if (alike<T>(all[i], all[j])) stack(parts, i, j);
      else ++j;
    }
  std::vector<std::size_t> on_bodies;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!all[i].links.empty()) on_bodies.push_back(i);
  if (all.size() == before && on_bodies.size() > 1) {
    const std::size_t k = seed % (on_bodies.size() - 1);
    stack(parts, on_bodies[k], on_bodies[k + 1]);
  }
  return together(parts);
}

template <class T> Units<T> other_units() {
  if constexpr (ScalarTraits<T>::exact) return {T(3), T(0.625), T(7)};
  else return {T(0x1p-10), T(0x1p-20), T(0x1p7)};
}

template <class T> Second<T> in_units(const Problem<T>& p, const Damping<T>& d, const Units<T>& u) {
  Parts<T> parts = apart(p, d);
  const T per_length = T(1) / u.length, damping = u.row * u.row / u.mass;
  for (auto& b : parts.bodies) {
    b.S.bottomRows(3) *= u.length;
    b.H *= u.mass;
    b.H.template bottomRows<3>() *= per_length;
    b.H.template rightCols<3>() *= per_length;
    for (T& a : b.armature) a *= u.mass;
  }
  for (auto& c : parts.constraints) {
    for (auto& l : c.links) {
      l.K *= u.row;
      l.K.rightCols(3) *= per_length;
    }
    c.joint_K *= u.row;
    scale<T>(c, damping);
  }
  return together(parts);
}

#define DELASSUS_VARIANTS(T)                                                             \
  template Second<T> one_left_out(const Problem<T>&, const Damping<T>&, std::uint64_t);  \
  template Second<T> rows_left_out(const Problem<T>&, const Damping<T>&, const std::vector<Index>&); \
  template Second<T> reordered(const Problem<T>&, const Damping<T>&, std::uint64_t);     \
  template Second<T> with_idle_links(const Problem<T>&, const Damping<T>&);              \
  template Second<T> doubled(const Problem<T>&, const Damping<T>&, std::uint64_t);       \
  template Second<T> rows_split(const Problem<T>&, const Damping<T>&);                   \
  template Second<T> rows_stacked(const Problem<T>&, const Damping<T>&, std::uint64_t);  \
  template Units<T> other_units<T>();                                                    \
  template Second<T> in_units(const Problem<T>&, const Damping<T>&, const Units<T>&);
DELASSUS_VARIANTS(double)
DELASSUS_VARIANTS(Rational)
#undef DELASSUS_VARIANTS

}  // namespace delassus::laws
