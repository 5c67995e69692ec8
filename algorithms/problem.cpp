#include "algorithms/problem.h"

#include <algorithm>
#include <string>
#include <utility>

#include "algorithms/stochastic.h"

namespace delassus {
namespace {

std::string body_name(Index i) { return "body " + std::to_string(i); }

void check_body(Index parent, Index n, Index i) {
  if (parent < ground || parent >= i)
    throw ModelError("", body_name(i), "parent " + std::to_string(parent) + " is not an earlier body",
                     "-1 (ground) to " + std::to_string(i - 1));
  if (n < 0 || n > 6)
    throw ModelError("", body_name(i), "joint with " + std::to_string(n) + " degrees of freedom", "0 to 6");
}

/// Rows and bodies of one link constraint: at least one row, at least one body, every body once.
void check_links(Index rows, std::vector<Index> bodies, Index body_count, const std::string& element) {
  if (rows < 1) throw ModelError("", element, std::to_string(rows) + " rows", "1 or more");
  if (bodies.empty()) throw ModelError("", element, "acts on no body", "1 or more bodies, the ground left out");
  std::sort(bodies.begin(), bodies.end());
  if (bodies.front() < 0 || bodies.back() >= body_count)
    throw ModelError("", element,
                     body_name(bodies.front() < 0 ? bodies.front() : bodies.back()) + " does not exist",
                     "0 to " + std::to_string(body_count - 1));
  const auto twice = std::adjacent_find(bodies.begin(), bodies.end());
  if (twice != bodies.end())
    throw ModelError("", element, body_name(*twice) + " appears twice", "distinct bodies, their blocks added up");
}

void check_joint_rows(Index rows, Index body, Index body_count, const std::string& element) {
  if (rows < 1) throw ModelError("", element, std::to_string(rows) + " rows", "1 or more");
  if (body < 0 || body >= body_count)
    throw ModelError("", element, body_name(body) + " does not exist", "0 to " + std::to_string(body_count - 1));
}

/// The ranges [first, first + size) must follow each other without gap or overlap from 0 to `total`.
void check_tiling(std::vector<std::pair<Index, Index>> ranges, Index total, const char* of) {
  std::sort(ranges.begin(), ranges.end());
  Index next = 0;
  for (const auto& [first, size] : ranges) {
    if (first != next)
      throw ModelError("", of, "gap or overlap at " + std::to_string(std::min(first, next)),
                       "every entry in exactly one constraint");
    next += size;
  }
  if (next != total)
    throw ModelError("", of, std::to_string(next) + " entries used of " + std::to_string(total), "all of them");
}

template <class T> bool finite(const T& x) {
  using std::isfinite;
  return isfinite(x);
}

template <class U, class T> U convert(const T& x) {
  if constexpr (ScalarTraits<U>::exact) require(finite(x), "cast: an exact scalar holds finite numbers only");
  return scalar_cast<U>(x);
}

template <class U, class T> std::vector<U> convert(const std::vector<T>& x) {
  std::vector<U> y;
  y.reserve(x.size());
  for (const T& v : x) y.push_back(convert<U>(v));
  return y;
}

template <class U, class T, int R, int C> Eigen::Matrix<U, R, C> convert(const Eigen::Matrix<T, R, C>& x) {
  Eigen::Matrix<U, R, C> y(x.rows(), x.cols());
  for (Index j = 0; j < x.cols(); ++j)
    for (Index i = 0; i < x.rows(); ++i) y(i, j) = convert<U>(x(i, j));
  return y;
}

template <class U, class T, int R, int C>
std::vector<Eigen::Matrix<U, R, C>> convert(const std::vector<Eigen::Matrix<T, R, C>>& x) {
  std::vector<Eigen::Matrix<U, R, C>> y;
  y.reserve(x.size());
  for (const auto& v : x) y.push_back(convert<U>(v));
  return y;
}

/// Whether a symmetric matrix is positive semidefinite up to the rounding of its own elimination:
/// every pivot ≥ −30 ε · size · (largest diagonal entry), and rows whose pivot vanishes vanish likewise.
template <class T> bool positive_semidefinite(MatrixX<T> B) {
  using std::abs;
  const Index n = B.rows();
  T largest(0);
  for (Index i = 0; i < n; ++i) largest = std::max(largest, T(B(i, i)));
  const T slack = scalar_cast<T>(30 * unit_roundoff<T> * static_cast<double>(n)) * largest;
  for (Index k = 0; k < n; ++k) {
    Index p = k;
    for (Index i = k; i < n; ++i) {
      if (B(i, i) < -slack) return false;
      if (B(i, i) > B(p, p)) p = i;
    }
    if (!(B(p, p) > slack)) {
      for (Index i = k; i < n; ++i)
        for (Index j = k; j < i; ++j)
          if (T(abs(B(i, j))) > slack) return false;
      return true;
    }
    B.row(k).swap(B.row(p));
    B.col(k).swap(B.col(p));
    for (Index i = k + 1; i < n; ++i) {
      const T factor = B(i, k) / B(k, k);
      for (Index j = k + 1; j < n; ++j) B(i, j) -= factor * B(k, j);
    }
  }
  return true;
}

template <class T> void check_block(const MatrixX<T>& B, const std::string& element) {
  if (B.rows() != B.cols() || B.rows() == 0)
    throw ModelError("", element, "matrix of " + std::to_string(B.rows()) + " x " + std::to_string(B.cols()),
                     "a square matrix");
  for (Index i = 0; i < B.rows(); ++i)
    for (Index j = 0; j < B.cols(); ++j)
      if (!finite(B(i, j))) throw ModelError("", element, "entry is not finite", "finite numbers [1/kg]");
  for (Index i = 0; i < B.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (!(B(i, j) == B(j, i)))
        throw ModelError("", element,
                         "entries (" + std::to_string(i) + "," + std::to_string(j) + ") and their transpose differ",
                         "a symmetric matrix");
  if (!positive_semidefinite<T>(B))
    throw ModelError("", element, "matrix has a negative eigenvalue", "positive semidefinite [1/kg]");
}

/// For each row the first row of its constraint and that constraint's size.
std::vector<std::pair<Index, Index>> row_owners(const Structure& s) {
  std::vector<std::pair<Index, Index>> owner(static_cast<std::size_t>(s.rows));
  for (const auto& e : s.link_constraints)
    for (Index k = 0; k < e.rows; ++k) owner[e.row + k] = {e.row, e.rows};
  for (const auto& e : s.joint_constraints)
    for (Index k = 0; k < e.rows; ++k) owner[e.row + k] = {e.row, e.rows};
  return owner;
}

}  // namespace

Index Structure::add_body(Index parent_body, Index n) {
  const Index i = bodies();
  check_body(parent_body, n, i);
  parent.push_back(parent_body);
  first_dof.push_back(first_dof.back() + n);
  return i;
}

Index Structure::add_link_constraint(Index m, const std::vector<Index>& on) {
  const Index e = static_cast<Index>(link_constraints.size());
  check_links(m, on, bodies(), "link constraint " + std::to_string(e));
  LinkConstraint c{rows, m, {}};
  c.links.reserve(on.size());
  for (const Index body : on) {
    c.links.push_back({body, K_rows});
    K_rows += m;
  }
  link_constraints.push_back(std::move(c));
  rows += m;
  return e;
}

Index Structure::add_joint_constraint(Index m, Index body) {
  const Index e = static_cast<Index>(joint_constraints.size());
  check_joint_rows(m, body, bodies(), "joint constraint " + std::to_string(e));
  joint_constraints.push_back({rows, m, body, joint_K_size});
  rows += m;
  joint_K_size += m * dofs(body);
  return e;
}

void Structure::validate() const {
  if (first_dof.size() != parent.size() + 1 || first_dof.front() != 0)
    throw ModelError("", "first_dof", std::to_string(first_dof.size()) + " entries, or not starting at 0",
                     "one more entry than bodies, starting at 0");
  for (Index i = 0; i < bodies(); ++i) check_body(parent[i], dofs(i), i);

  std::vector<std::pair<Index, Index>> row_ranges, K_ranges, joint_ranges;
  std::vector<Index> on;
  for (std::size_t e = 0; e < link_constraints.size(); ++e) {
    const LinkConstraint& c = link_constraints[e];
    on.clear();
    for (const Attachment& l : c.links) {
      on.push_back(l.body);
      K_ranges.emplace_back(l.first, c.rows);
    }
    check_links(c.rows, on, bodies(), "link constraint " + std::to_string(e));
    row_ranges.emplace_back(c.row, c.rows);
  }
  for (std::size_t e = 0; e < joint_constraints.size(); ++e) {
    const JointConstraint& c = joint_constraints[e];
    check_joint_rows(c.rows, c.body, bodies(), "joint constraint " + std::to_string(e));
    row_ranges.emplace_back(c.row, c.rows);
    joint_ranges.emplace_back(c.first, c.rows * dofs(c.body));
  }
  check_tiling(std::move(row_ranges), rows, "rows of J");
  check_tiling(std::move(K_ranges), K_rows, "rows of K");
  check_tiling(std::move(joint_ranges), joint_K_size, "entries of joint_K");
}

template <class T> Problem<T>::Problem(std::shared_ptr<const Structure> s) : structure(std::move(s)) {
  require(structure != nullptr, "Problem: no structure");
  S.assign(structure->dofs(), Vector6<T>::Constant(T(0)));
  armature.assign(structure->dofs(), T(0));
  H.assign(structure->bodies(), Matrix6<T>::Constant(T(0)));
  K.assign(structure->K_rows, Vector6<T>::Constant(T(0)));
  joint_K.assign(structure->joint_K_size, T(0));
}

template <class T> void Problem<T>::check_sizes() const {
  require(structure != nullptr, "Problem: no structure");
  const auto fits = [](const auto& array, Index n) { return static_cast<Index>(array.size()) == n; };
  require(fits(S, structure->dofs()), "Problem: S needs one column per degree of freedom");
  require(fits(armature, structure->dofs()), "Problem: armature needs one entry per degree of freedom");
  require(fits(H, structure->bodies()), "Problem: H needs one matrix per body");
  require(fits(K, structure->K_rows), "Problem: K needs Structure::K_rows rows");
  require(fits(joint_K, structure->joint_K_size), "Problem: joint_K needs Structure::joint_K_size entries");
}

template <class T> template <class U> Problem<U> Problem<T>::cast() const {
  Problem<U> p;
  p.structure = structure;
  p.S = convert<U>(S);
  p.armature = convert<U>(armature);
  p.H = convert<U>(H);
  p.K = convert<U>(K);
  p.joint_K = convert<U>(joint_K);
  return p;
}

template <class T> void Damping<T>::multiply(const VectorX<T>& x, VectorX<T>& y) const {
  require(x.size() == static_cast<Index>(diagonal.size()), "Damping: x does not have one entry per row");
  require(&x != &y, "Damping: x and y are the same vector");
  y.resize(x.size());
  for (Index i = 0; i < x.size(); ++i) y[i] = diagonal[i] * x[i];
  for (const Block& b : blocks)
    for (Index j = 0; j < b.R_inverse.cols(); ++j)
      for (Index i = 0; i < b.R_inverse.rows(); ++i) y[b.row + i] += b.R_inverse(i, j) * x[b.row + j];
}

template <class T> void Damping<T>::validate(const Structure& s) const {
  if (static_cast<Index>(diagonal.size()) != s.rows)
    throw ModelError("", "damping", std::to_string(diagonal.size()) + " entries",
                     std::to_string(s.rows) + ", one per row");
  for (Index i = 0; i < s.rows; ++i)
    if (!finite(diagonal[i]) || diagonal[i] < T(0))
      throw ModelError("", "damping of row " + std::to_string(i),
                       std::to_string(static_cast<double>(diagonal[i])) + " 1/kg", "finite and 0 or more [1/kg]");
  if (blocks.empty()) return;
  const auto owner = row_owners(s);
  Index next = 0;
  for (const Block& b : blocks) {
    const std::string element = "damping block at row " + std::to_string(b.row);
    check_block(b.R_inverse, element);
    const Index size = b.R_inverse.rows();
    if (b.row < next) throw ModelError("", element, "overlaps the block before it", "disjoint blocks in ascending order");
    next = b.row + size;
    if (next > s.rows || next > owner[b.row].first + owner[b.row].second)
      throw ModelError("", element, std::to_string(size) + " rows reach beyond one constraint",
                       "a block over rows of one constraint");
    for (Index i = b.row; i < next; ++i)
      if (!(diagonal[i] == T(0)))
        throw ModelError("", element, "row " + std::to_string(i) + " also has a diagonal entry", "0 there");
  }
}

template <class T> template <class U> Damping<U> Damping<T>::cast() const {
  Damping<U> d;
  d.diagonal = convert<U>(diagonal);
  d.blocks.reserve(blocks.size());
  for (const Block& b : blocks) d.blocks.push_back({b.row, convert<U>(b.R_inverse)});
  return d;
}

#define DELASSUS_CAST(T, U)                        \
  template Problem<U> Problem<T>::cast<U>() const; \
  template Damping<U> Damping<T>::cast<U>() const;
#define DELASSUS_CAST_FROM_DOUBLE(U) DELASSUS_CAST(double, U)
#define DELASSUS_CAST_TO_DOUBLE(T) DELASSUS_CAST(T, double)
#define DELASSUS_INSTANTIATE(T) \
  template struct Problem<T>;   \
  template struct Damping<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)
template struct Problem<PrimeField>;
template void Damping<PrimeField>::multiply(const VectorX<PrimeField>&, VectorX<PrimeField>&) const;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_CAST_FROM_DOUBLE)
DELASSUS_CAST_FROM_DOUBLE(Stochastic)
DELASSUS_CAST_TO_DOUBLE(float)
DELASSUS_CAST_TO_DOUBLE(Quad)
DELASSUS_CAST_TO_DOUBLE(Rational)
DELASSUS_CAST(Quad, Rational)
DELASSUS_CAST(Rational, Quad)
#undef DELASSUS_INSTANTIATE
#undef DELASSUS_CAST_TO_DOUBLE
#undef DELASSUS_CAST_FROM_DOUBLE
#undef DELASSUS_CAST

}  // namespace delassus
