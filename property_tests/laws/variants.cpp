#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/variants.h"

#include <algorithm>
#include <type_traits>

#include "generators/random.h"

namespace delassus::laws {
namespace {

/// One constraint of either kind, in order of rows.
struct Entry {
  Index row, rows;
  const Structure::LinkConstraint* link = nullptr;
  const Structure::JointConstraint* joint = nullptr;
};

std::vector<Entry> constraints(const Structure& s) {
  std::vector<Entry> all;
  for (const auto& c : s.link_constraints) all.push_back({c.row, c.rows, &c, nullptr});
  for (const auto& c : s.joint_constraints) all.push_back({c.row, c.rows, nullptr, &c});
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.row < b.row; });
  return all;
}

/// X with G X = B, G symmetric positive definite and small. Shapes n×n, n×k.
template <class W> MatrixX<W> solve_small(MatrixX<W> G, MatrixX<W> B) {
  const Index n = G.rows();
  for (Index k = 0; k < n; ++k)
    for (Index i = 0; i < n; ++i) {
      if (i == k) continue;
      const W factor = G(i, k) / G(k, k);
      for (Index j = k; j < n; ++j) G(i, j) -= factor * G(k, j);
      for (Index j = 0; j < B.cols(); ++j) B(i, j) -= factor * B(k, j);
    }
  for (Index k = 0; k < n; ++k) B.row(k) /= G(k, k);
  return B;
}

/// 𝒦 S⁺ of one joint constraint: rows × 6.
template <class T> MatrixX<T> link_block(const Problem<T>& p, const Structure::JointConstraint& c) {
  using W = Wide<T>;
  const Structure& s = *p.structure;
  const Index n = s.dofs(c.body), first = s.first_dof[static_cast<std::size_t>(c.body)];
  MatrixX<W> S(6, n), calK(c.rows, n);
  for (Index k = 0; k < n; ++k)
    for (Index r = 0; r < 6; ++r) S(r, k) = scalar_cast<W>(p.S[static_cast<std::size_t>(first + k)][r]);
  for (Index r = 0; r < c.rows; ++r)
    for (Index k = 0; k < n; ++k) calK(r, k) = scalar_cast<W>(p.joint_K[static_cast<std::size_t>(c.first + r * n + k)]);
  const MatrixX<W> St = S.transpose();
  const MatrixX<W> pseudo_inverse = solve_small<W>(St.lazyProduct(S), St);
  const MatrixX<W> block = calK.lazyProduct(pseudo_inverse);
  MatrixX<T> out(c.rows, 6);
  for (Index r = 0; r < c.rows; ++r)
    for (Index k = 0; k < 6; ++k) out(r, k) = scalar_cast<T>(block(r, k));
  return out;
}

/// New names of the bodies: at every step a random one of those whose parent is placed already.
std::vector<Index> random_order(const Structure& s, std::uint64_t seed) {
  generators::Random random(seed);
  const auto n = static_cast<std::size_t>(s.bodies());
  std::vector<Index> order;
  std::vector<bool> placed(n, false);
  while (order.size() < n) {
    std::vector<Index> ready;
    for (std::size_t i = 0; i < n; ++i) {
      const Index up = s.parent[i];
      if (!placed[i] && (up < 0 || placed[static_cast<std::size_t>(up)])) ready.push_back(static_cast<Index>(i));
    }
    const Index chosen = ready[static_cast<std::size_t>(random.integer(0, static_cast<int>(ready.size()) - 1))];
    placed[static_cast<std::size_t>(chosen)] = true;
    order.push_back(chosen);
  }
  return order;
}

template <class T> void copy_body(const Problem<T>& from, Index i, Problem<T>& to, Index k) {
  const Structure &a = *from.structure, &b = *to.structure;
  to.H[static_cast<std::size_t>(k)] = from.H[static_cast<std::size_t>(i)];
  for (Index j = 0; j < a.dofs(i); ++j) {
    const auto source = static_cast<std::size_t>(a.first_dof[static_cast<std::size_t>(i)] + j);
    const auto target = static_cast<std::size_t>(b.first_dof[static_cast<std::size_t>(k)] + j);
    to.S[target] = from.S[source];
    to.armature[target] = from.armature[source];
  }
}

}  // namespace

template <class T> Variant<T> relabelled(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  const Structure& old = *p.structure;
  const std::vector<Index> order = random_order(old, seed);
  std::vector<Index> name(order.size());
  auto s = std::make_shared<Structure>();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto i = static_cast<std::size_t>(order[k]);
    name[i] = static_cast<Index>(k);
    s->add_body(old.parent[i] < 0 ? ground : name[static_cast<std::size_t>(old.parent[i])], old.dofs(order[k]));
  }
  const std::vector<Entry> all = constraints(old);
  for (const Entry& c : all) {
    std::vector<Index> bodies;
    if (c.link) {
      for (const auto& l : c.link->links) bodies.insert(bodies.begin(), name[static_cast<std::size_t>(l.body)]);
      s->add_link_constraint(c.rows, bodies);
    } else {
      s->add_joint_constraint(c.rows, name[static_cast<std::size_t>(c.joint->body)]);
    }
  }
  Variant<T> out{Problem<T>(s), d};
  for (std::size_t k = 0; k < order.size(); ++k) copy_body(p, order[k], out.problem, static_cast<Index>(k));
  std::size_t link = 0, joint = 0;
  for (const Entry& c : all) {
    if (c.joint) {
      const Index size = c.rows * old.dofs(c.joint->body);
      std::copy_n(p.joint_K.begin() + c.joint->first, size,
                  out.problem.joint_K.begin() + s->joint_constraints[joint++].first);
      continue;
    }
    const auto& target = s->link_constraints[link++].links;
    for (std::size_t k = 0; k < target.size(); ++k)
      std::copy_n(p.K.begin() + c.link->links[target.size() - 1 - k].first, c.rows, out.problem.K.begin() + target[k].first);
  }
  return out;
}

template <class T> Variant<T> joint_rows_as_links(const Problem<T>& p, const Damping<T>& d) {
  const Structure& old = *p.structure;
  auto s = std::make_shared<Structure>();
  for (Index i = 0; i < old.bodies(); ++i) s->add_body(old.parent[static_cast<std::size_t>(i)], old.dofs(i));
  const std::vector<Entry> all = constraints(old);
  for (const Entry& c : all) {
    std::vector<Index> bodies;
    if (c.link) {
      for (const auto& l : c.link->links) bodies.push_back(l.body);
    } else {
      bodies.push_back(c.joint->body);
      const Index up = old.parent[static_cast<std::size_t>(c.joint->body)];
      if (up >= 0) bodies.push_back(up);
    }
    s->add_link_constraint(c.rows, bodies);
  }
  Variant<T> out{Problem<T>(s), d};
  for (Index i = 0; i < old.bodies(); ++i) copy_body(p, i, out.problem, i);
  for (std::size_t e = 0; e < all.size(); ++e) {
    const auto& links = s->link_constraints[e].links;
    const MatrixX<T> block = all[e].joint ? link_block(p, *all[e].joint) : MatrixX<T>();
    for (std::size_t k = 0; k < links.size(); ++k)
      for (Index r = 0; r < all[e].rows; ++r) {
        Vector6<T>& target = out.problem.K[static_cast<std::size_t>(links[k].first + r)];
        if (all[e].link) target = p.K[static_cast<std::size_t>(all[e].link->links[k].first + r)];
        else for (Index j = 0; j < 6; ++j) target[j] = k == 0 ? block(r, j) : T(-block(r, j));
      }
  }
  return out;
}

template <class T> Variant<T> armature_as_rows(const Problem<T>& p, const Damping<T>& d) {
  auto s = std::make_shared<Structure>(*p.structure);
  const Index m = s->rows;
  std::vector<Index> bodies;
  for (Index i = 0; i < s->bodies(); ++i) {
    bool any = false;
    for (Index k = s->first_dof[static_cast<std::size_t>(i)]; k < s->first_dof[static_cast<std::size_t>(i) + 1]; ++k)
      any = any || !(p.armature[static_cast<std::size_t>(k)] == T(0));
    if (any) bodies.push_back(i);
  }
  for (const Index i : bodies) {
    Index rows = 0;
    for (Index k = 0; k < s->dofs(i); ++k)
      rows += p.armature[static_cast<std::size_t>(s->first_dof[static_cast<std::size_t>(i)] + k)] == T(0) ? 0 : 1;
    s->add_joint_constraint(rows, i);
  }
  Variant<T> out{Problem<T>(s), d};
  out.problem.S = p.S;
  out.problem.H = p.H;
  std::copy(p.K.begin(), p.K.end(), out.problem.K.begin());
  std::copy(p.joint_K.begin(), p.joint_K.end(), out.problem.joint_K.begin());
  out.damping.diagonal.resize(static_cast<std::size_t>(m));
  for (std::size_t e = p.structure->joint_constraints.size(); e < s->joint_constraints.size(); ++e) {
    const auto& c = s->joint_constraints[e];
    const Index n = s->dofs(c.body);
    for (Index k = 0, row = 0; k < n; ++k) {
      const T& A = p.armature[static_cast<std::size_t>(s->first_dof[static_cast<std::size_t>(c.body)] + k)];
      if (A == T(0)) continue;
      out.problem.joint_K[static_cast<std::size_t>(c.first + row++ * n + k)] = T(1);
      out.damping.diagonal.push_back(T(1) / A);
    }
  }
  return out;
}

template <class T> Variant<T> other_numbers(const Problem<T>& p, const Damping<T>& d) {
  Variant<T> out{p, d};
  for (auto& H : out.problem.H) H *= T(2);
  for (T& A : out.problem.armature) A *= T(2);
  for (auto& K : out.problem.K) K *= T(0.5);
  for (T& K : out.problem.joint_K) K *= T(0.5);
  for (T& r : out.damping.diagonal) r *= T(4);
  for (auto& block : out.damping.blocks) block.R_inverse *= T(4);
  return out;
}

namespace {
/// Multiplies R⁻¹ on the rows of a constraint.
template <class T> void scale_rows(Damping<T>& d, const Entry& c, const T& factor) {
  for (Index r = c.row; r < c.row + c.rows; ++r) d.diagonal[static_cast<std::size_t>(r)] *= factor;
  for (auto& block : d.blocks)
    if (block.row >= c.row && block.row < c.row + c.rows) block.R_inverse *= factor;
}
}  // namespace

template <class T> Damping<T> other_damping(const Structure& s, const Damping<T>& d) {
  Damping<T> out = d;
  int k = 0;
  for (const Entry& c : constraints(s)) scale_rows(out, c, T(2 << (k++ % 3)));
  return out;
}

template <class T> Damping<T> first_constraint_hard(const Structure& s, const Damping<T>& d) {
  Damping<T> out = d;
  if (s.rows > 0) scale_rows(out, constraints(s)[0], T(0));
  return out;
}

#define DELASSUS_VARIANTS(T)                                                                             \
  template Variant<T> relabelled(const Problem<T>&, const Damping<T>&, std::uint64_t);                   \
  template Variant<T> joint_rows_as_links(const Problem<T>&, const Damping<T>&);                         \
  template Variant<T> armature_as_rows(const Problem<T>&, const Damping<T>&);                            \
  template Variant<T> other_numbers(const Problem<T>&, const Damping<T>&);                               \
  template Damping<T> other_damping(const Structure&, const Damping<T>&);                                \
  template Damping<T> first_constraint_hard(const Structure&, const Damping<T>&);
DELASSUS_VARIANTS(double)
DELASSUS_VARIANTS(Rational)
DELASSUS_VARIANTS(PrimeField)
#undef DELASSUS_VARIANTS

}  // namespace delassus::laws
