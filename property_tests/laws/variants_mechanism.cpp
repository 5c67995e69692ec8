#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/variants_mechanism.h"

#include <algorithm>
#include <map>
#include <type_traits>

#include "algorithms/kit/index.h"
#include "generators/random.h"
#include "property_tests/laws/variants.h"

namespace delassus::laws {
namespace {

template <class To, class From> MatrixX<To> as(const MatrixX<From>& x) {
  MatrixX<To> y(x.rows(), x.cols());
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r) y(r, c) = scalar_cast<To>(x(r, c));
  return y;
}

std::vector<bool> with_joint_rows(const Structure& s) {
  std::vector<bool> has(z(s.bodies()), false);
  for (const auto& c : s.joint_constraints) has[z(c.body)] = true;
  return has;
}

bool has_armature(const Problem<double>& p, Index i) {
  const auto& first = p.structure->first_dof;
  return std::any_of(p.armature.begin() + first[z(i)], p.armature.begin() + first[z(i) + 1], [](double a) { return a != 0; });
}

/// A motion and its inverse, 6×6: rotation by an integer quaternion over its squared length, small translation.
template <class W> struct Motion {
  MatrixX<W> X = MatrixX<W>::Constant(6, 6, W(0)), inverse = X;

  explicit Motion(generators::Random random) {
    const W w(random.integer(1, 3));
    const Vector3<W> v(W(random.integer(-2, 2)), W(random.integer(1, 2)), W(random.integer(-2, 2)));
    const Vector3<W> t(W(random.integer(-1, 1)), W(random.integer(-1, 1)), W(random.integer(-1, 1)));
    const Matrix3<W> turn = cross_matrix(v), shift = cross_matrix(t);
    const W scale = W(2) / (w * w + v.dot(v));
    const Matrix3<W> R = Matrix3<W>::Identity() + scale * (w * turn + turn.lazyProduct(turn));
    X.topLeftCorner(3, 3) = X.bottomRightCorner(3, 3) = R;
    X.bottomLeftCorner(3, 3) = shift.lazyProduct(R);
    inverse.topLeftCorner(3, 3) = inverse.bottomRightCorner(3, 3) = R.transpose();
    inverse.bottomLeftCorner(3, 3) = -R.transpose().lazyProduct(shift);
  }
};

/// The tree of every body: the index of its root.
template <class T> std::vector<Index> trees(const Parts<T>& parts) {
  std::vector<Index> root(parts.bodies.size());
  for (std::size_t i = 0; i < root.size(); ++i) {
    const Index up = parts.bodies[i].parent;
    root[i] = up == ground ? static_cast<Index>(i) : root[z(up)];
  }
  return root;
}

/// N, (6 − n) × 6, with N S = 0 and N of full rank, by elimination of Sᵀ with the largest pivots.
template <class W> MatrixX<W> annihilator(const MatrixX<W>& S) {
  MatrixX<W> G = S.transpose();
  const Index n = G.rows();
  std::vector<Index> pivot(z(n), -1);
  std::vector<bool> taken(6, false);
  for (Index k = 0; k < n; ++k) {
    Index best = 0;
    W largest(0);
    for (Index j = 0; j < 6; ++j)
      if (!taken[z(j)] && abs(W(G(k, j))) > largest) largest = abs(W(G(k, best = j)));
    pivot[z(k)] = best;
    taken[z(best)] = true;
    G.row(k) /= W(G(k, best));
    for (Index i = 0; i < n; ++i)
      if (i != k) G.row(i) -= (W(G(i, best)) * G.row(k)).eval();
  }
  MatrixX<W> N = MatrixX<W>::Constant(6 - n, 6, W(0));
  for (Index j = 0, row = 0; j < 6; ++j) {
    if (taken[z(j)]) continue;
    N(row, j) = W(1);
    for (Index k = 0; k < n; ++k) N(row, pivot[z(k)]) = -G(k, j);
    ++row;
  }
  return N;
}

template <class T> MatrixX<T> identity6() {
  MatrixX<T> I = MatrixX<T>::Constant(6, 6, T(0));
  for (Index k = 0; k < 6; ++k) I(k, k) = T(1);
  return I;
}

}  // namespace

template <class T> Second<T> world_moved(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  using W = Wide<T>;
  Parts<T> parts = apart(p, d);
  const std::vector<Index> root = trees(parts);
  std::map<Index, Motion<W>> motions;
  for (const Index r : root) motions.try_emplace(r, generators::Random(seed + static_cast<std::uint64_t>(r)));
  for (Index i = 0; i < parts.count(); ++i) {
    const Motion<W>& m = motions.at(root[z(i)]);
    auto& b = parts.body(i);
    b.S = as<T, W>(m.X.lazyProduct(as<W, T>(b.S)));
    const MatrixX<W> H = as<W, T>(MatrixX<T>(b.H)).lazyProduct(m.inverse);
    b.H = as<T, W>(m.inverse.transpose().lazyProduct(H));
    for (Index r = 0; r < 6; ++r)
      for (Index c = 0; c < r; ++c) b.H(c, r) = b.H(r, c);
  }
  for (auto& c : parts.constraints)
    for (auto& l : c.links) l.K = as<T, W>(as<W, T>(l.K).lazyProduct(motions.at(root[z(l.body)]).inverse));
  return together(parts);
}

std::vector<Index> free_bases(const Problem<double>& p) {
  const Structure& s = *p.structure;
  const std::vector<bool> rows = with_joint_rows(s);
  std::vector<Index> out;
  for (Index i = 0; i < s.bodies(); ++i)
    if (s.parent[z(i)] == ground && s.dofs(i) == 6 && !rows[z(i)] && !has_armature(p, i) &&
        std::find(s.parent.begin(), s.parent.end(), i) != s.parent.end())
      out.push_back(i);
  return out;
}

template <class T> Second<T> rerooted(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  const std::vector<Index> bases = free_bases(p.template cast<double>());
  Parts<T> parts = apart(p, d);
  const std::vector<Index> root = trees(parts);
  const Index base = bases[seed % bases.size()];
  std::vector<Index> others;
  for (Index i = 0; i < parts.count(); ++i)
    if (root[z(i)] == base && i != base) others.push_back(i);
  const Index first = others[(seed / 2 + others.size() / 2) % others.size()];

  // The joint of body i on the path now carries its parent.
  std::vector<Index> path{first};
  while (path.back() != base) path.push_back(parts.body(path.back()).parent);
  std::vector<Index> carried(parts.bodies.size());
  for (std::size_t i = 0; i < carried.size(); ++i) carried[i] = static_cast<Index>(i);
  const typename Parts<T>::Body free = parts.body(base);
  for (std::size_t k = path.size() - 1; k > 0; --k) {
    const auto& joint = parts.body(path[k - 1]);
    auto& b = parts.body(path[k]);
    b.S = -joint.S;
    b.armature = joint.armature;
    b.parent = path[k - 1];
    carried[z(path[k - 1])] = path[k];
  }
  auto& b = parts.body(first);
  b.S = free.S;
  b.armature = free.armature;
  b.parent = ground;
  for (auto& c : parts.constraints)
    if (c.links.empty()) c.joint = carried[z(c.joint)];
  return together(parts);
}

bool can_split(const Structure& s) {
  const std::vector<bool> rows = with_joint_rows(s);
  for (Index i = 0; i < s.bodies(); ++i)
    if (!rows[z(i)] && s.dofs(i) > 1) return true;
  return false;
}

template <class T> Second<T> joints_split(const Problem<T>& p, const Damping<T>& d) {
  Parts<T> parts = apart(p, d);
  const std::vector<bool> rows = with_joint_rows(*p.structure);
  for (Index i = 0; i < p.structure->bodies(); ++i) {
    const MatrixX<T> S = parts.body(i).S;
    const std::vector<T> armature = parts.body(i).armature;
    if (rows[z(i)] || S.cols() < 2) continue;
    Index up = parts.body(i).parent;
    for (Index k = 0; k + 1 < S.cols(); ++k) {
      up = parts.add_body(up, S.col(k));
      parts.body(up).armature = {armature[z(k)]};
    }
    auto& b = parts.body(i);
    b.parent = up;
    b.S = S.rightCols(1);
    b.armature = {armature.back()};
  }
  return together(parts);
}

template <class T> Second<T> bodies_in_two(const Problem<T>& p, const Damping<T>& d) {
  Parts<T> parts = apart(p, d);
  const Index n = parts.count();
  for (Index i = 0; i < n; ++i) {
    const Index half = parts.add_body(i, MatrixX<T>(6, 0));
    parts.body(half).H = parts.body(i).H = parts.body(i).H * T(0.5);
  }
  Index k = 0;
  for (auto& c : parts.constraints)
    for (auto& l : c.links)
      if (k++ % 2 == 0) l.body += n;
  return together(parts);
}

template <class T> Second<T> stiffened(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  for (Index i = 0; i < parts.count(); i += 2) parts.body(i).H *= T(2);
  const std::vector<bool> rows = with_joint_rows(*p.structure);
  std::vector<Index> lockable;
  for (Index i = 0; i < parts.count(); ++i)
    if (parts.body(i).S.cols() > (rows[z(i)] ? 1 : 0)) lockable.push_back(i);
  if (lockable.empty()) return together(parts);
  const Index locked = lockable[seed % lockable.size()];
  auto& b = parts.body(locked);
  b.S = b.S.leftCols(b.S.cols() - 1).eval();
  b.armature.pop_back();
  for (auto& c : parts.constraints)
    if (c.joint == locked) c.joint_K = c.joint_K.leftCols(b.S.cols()).eval();
  return together(parts);
}

std::vector<Index> geared_joints(const Problem<double>& p) {
  std::vector<Index> out;
  for (Index i = 0; i < p.structure->bodies(); ++i)
    if (p.structure->dofs(i) == 1 && has_armature(p, i)) out.push_back(i);
  return out;
}

template <class T> Second<T> with_rotor(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  using W = Wide<T>;
  const std::vector<Index> joints = geared_joints(p.template cast<double>());
  const Index i = joints[seed % joints.size()];
  Parts<T> parts = apart(p, d);
  const MatrixX<T> axis = identity6<T>().col(2);
  const Index rotor = parts.add_body(ground, axis);
  std::swap(parts.body(rotor).H(2, 2), parts.body(i).armature[0]);
  const MatrixX<W> s = as<W, T>(parts.body(i).S);
  W squared(0);
  for (Index k = 0; k < 6; ++k) squared += s(k, 0) * s(k, 0);
  const MatrixX<T> rate = as<T, W>(MatrixX<W>(s.transpose() / squared));  // rate (a_i − a_π(i)) = ν_i
  auto& gear = parts.add_hard(1);
  parts.add_link(gear, i, rate);
  parts.add_link(gear, parts.body(i).parent, -rate);
  parts.add_link(gear, rotor, -axis.transpose());
  return together(parts);
}

std::vector<Index> joints_to_cut(const Problem<double>& p) {
  const std::vector<bool> rows = with_joint_rows(*p.structure);
  std::vector<Index> out;
  for (Index i = 0; i < p.structure->bodies(); ++i)
    if (p.structure->dofs(i) < 6 && !rows[z(i)] && !has_armature(p, i)) out.push_back(i);
  return out;
}

template <class T> Second<T> joint_cut(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  using W = Wide<T>;
  const std::vector<Index> joints = joints_to_cut(p.template cast<double>());
  const Index i = joints[seed % joints.size()];
  Parts<T> parts = apart(p, d);
  auto& b = parts.body(i);
  const MatrixX<T> N = as<T, W>(annihilator<W>(as<W, T>(b.S)));
  auto& joint = parts.add_hard(N.rows());
  parts.add_link(joint, i, N);
  parts.add_link(joint, b.parent, -N);
  b.parent = ground;
  b.S = identity6<T>();
  b.armature.assign(6, T(0));
  return together(parts);
}

#define DELASSUS_VARIANTS(T)                                                              \
  template Second<T> world_moved(const Problem<T>&, const Damping<T>&, std::uint64_t);    \
  template Second<T> rerooted(const Problem<T>&, const Damping<T>&, std::uint64_t);       \
  template Second<T> joints_split(const Problem<T>&, const Damping<T>&);                  \
  template Second<T> bodies_in_two(const Problem<T>&, const Damping<T>&);                 \
  template Second<T> stiffened(const Problem<T>&, const Damping<T>&, std::uint64_t);      \
  template Second<T> with_rotor(const Problem<T>&, const Damping<T>&, std::uint64_t);     \
  template Second<T> joint_cut(const Problem<T>&, const Damping<T>&, std::uint64_t);
DELASSUS_VARIANTS(double)
DELASSUS_VARIANTS(Rational)
#undef DELASSUS_VARIANTS

}  // namespace delassus::laws
