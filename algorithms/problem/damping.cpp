// R⁻¹ as it is given: its product with a vector, whether it fits a structure, whether it can be right.
#include <algorithm>
#include <cmath>
#include <string>

#include "algorithms/errors/message.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/lanes.h"
#include "algorithms/kit/scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus {
namespace {

template <class T> bool negative(const T& x) {
  if constexpr (!ScalarTraits<T>::ordered) return false;  // a field without an order
  else return x < T(0);
}

/// Whether a symmetric matrix is positive semidefinite up to the rounding of its own elimination:
/// every pivot ≥ −30 ε · size · (largest diagonal entry), and rows whose pivot vanishes vanish likewise. B is overwritten.
template <class T> bool positive_semidefinite(Eigen::Map<MatrixX<T>> B) {
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

template <class T> bool right(const MatrixX<T>& B, T* scratch) {
  const Index n = B.rows();
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j <= i; ++j)
      if (!is_finite(B(i, j)) || !(B(i, j) == B(j, i))) return false;
  if constexpr (!ScalarTraits<T>::ordered) return true;
  else {
    std::copy_n(B.data(), n * n, scratch);
    return positive_semidefinite(Eigen::Map<MatrixX<T>>(scratch, n, n));
  }
}

template <class T> void check_block(const MatrixX<T>& B, const std::string& element) {
  if (B.rows() != B.cols() || B.rows() == 0)
    throw ModelError("", element, "matrix of " + std::to_string(B.rows()) + " x " + std::to_string(B.cols()),
                     "a square matrix; give the block of R^-1 of its rows");
  for (Index i = 0; i < B.rows(); ++i)
    for (Index j = 0; j < B.cols(); ++j)
      if (!is_finite(B(i, j))) throw ModelError("", element, "entry is not finite", "finite numbers [1/kg]; correct it");
  for (Index i = 0; i < B.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (!(B(i, j) == B(j, i)))
        throw ModelError("", element,
                         "entries (" + std::to_string(i) + "," + std::to_string(j) + ") and their transpose differ",
                         "a symmetric matrix; where only rounding differs, give half the sum with its transpose");
  MatrixX<T> left = B;
  if (!positive_semidefinite(Eigen::Map<MatrixX<T>>(left.data(), B.rows(), B.cols())))
    throw ModelError("", element, "matrix has a negative eigenvalue", "positive semidefinite [1/kg]; check its signs");
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

/// Whether no entry is negative, infinite or NaN, four at a time; false where that takes a second look.
template <class T> bool all_right(const std::vector<T>& x) {
  if constexpr (!std::is_same_v<T, double>) return false;
  else {
    Lanes4 wrong{};  // (|x| − x) + 0 x
    std::size_t r = 0;
    for (; r + 4 <= x.size(); r += 4) {
      const Lanes4 y = *reinterpret_cast<const UnalignedLanes4*>(x.data() + r), size = y < 0 ? -y : y;
      wrong += (size - y) + y * 0.0;
    }
    bool right = wrong[0] + wrong[1] + wrong[2] + wrong[3] == 0;
    for (; r < x.size(); ++r) right = right && is_finite(x[r]) && !negative(x[r]);
    return right;
  }
}

}  // namespace

template <class T> void Damping<T>::multiply(const VectorX<T>& x, VectorX<T>& y) const {
  require(x.size() == static_cast<Index>(diagonal.size()), "Damping: x does not have one entry per row");
  require(&x != &y, "Damping: x and y are the same vector");
  y.resize(x.size());
  const auto off = [this](Index row) { return ScalarTraits<T>::is_infinite(diagonal[static_cast<std::size_t>(row)]); };
  for (Index i = 0; i < x.size(); ++i) y[i] = off(i) ? T(0) : T(diagonal[i] * x[i]);
  for (const Block& b : blocks)
    for (Index j = 0; j < b.R_inverse.cols(); ++j)
      for (Index i = 0; i < b.R_inverse.rows(); ++i)
        if (!off(b.row + i) && !off(b.row + j)) y[b.row + i] += b.R_inverse(i, j) * x[b.row + j];
}

template <class T> void Damping<T>::check_sizes(const Structure& s) const {
  require(static_cast<Index>(diagonal.size()) == s.rows, "Damping: the diagonal must have one entry per row");
  Index next = 0;
  std::size_t link = 0, joint = 0;  // the first constraints that do not end before the block
  for (const Block& b : blocks) {
    require(b.R_inverse.rows() == b.R_inverse.cols() && b.R_inverse.rows() > 0, "Damping: a block must be square, and not empty");
    require(b.row >= next && b.row + b.R_inverse.rows() <= s.rows, "Damping: blocks must be disjoint, ascending and within the rows");
    next = b.row + b.R_inverse.rows();
    const auto holds = [&](const auto& c) { return b.row >= c.row && next <= c.row + c.rows; };
    const auto found = [&](const auto& all, std::size_t& at) {
      while (at < all.size() && all[at].row + all[at].rows <= b.row) ++at;
      return at < all.size() && holds(all[at]);
    };
    require(found(s.link_constraints, link) || found(s.joint_constraints, joint) ||
                std::any_of(s.link_constraints.begin(), s.link_constraints.end(), holds) ||  // not in the order of their rows
                std::any_of(s.joint_constraints.begin(), s.joint_constraints.end(), holds),
            "Damping: a block must lie within the rows of one constraint");
  }
}

template <class T> Report Damping<T>::judged(std::vector<T>& scratch) const {
  if (blocks.empty() && all_right(diagonal)) return {};
  for (std::size_t r = 0; r < diagonal.size(); ++r)
    if (!(is_finite(diagonal[r]) || ScalarTraits<T>::is_infinite(diagonal[r])) || negative(diagonal[r]))
      return {Status::bad_damping, static_cast<Index>(r)};
  for (const Block& b : blocks) {
    if (!right(b.R_inverse, scratch.data())) return {Status::bad_damping, b.row};
    for (Index r = b.row; r < b.row + b.R_inverse.rows(); ++r)
      if (!(diagonal[r] == T(0) || ScalarTraits<T>::is_infinite(diagonal[r]))) return {Status::bad_damping, r};
  }
  return {};
}

template <class T> void Damping<T>::validate(const Structure& s) const {
  if (static_cast<Index>(diagonal.size()) != s.rows)
    throw ModelError("", "damping", std::to_string(diagonal.size()) + " entries",
                     std::to_string(s.rows) + ", one per row; give R^-1 of every row");
  for (Index i = 0; i < s.rows; ++i)
    if (!(diagonal[i] >= T(0)))
      throw ModelError("", "damping of row " + std::to_string(i),
                       number_text(static_cast<double>(diagonal[i])) + " 1/kg", "0 or more [1/kg]; 0 makes a hard row, ∞ switches it off");
  if (blocks.empty()) return;
  const auto owner = row_owners(s);
  Index next = 0;
  for (const Block& b : blocks) {
    const std::string element = "damping block at row " + std::to_string(b.row);
    check_block(b.R_inverse, element);
    const Index size = b.R_inverse.rows();
    if (b.row < next) throw ModelError("", element, "overlaps the block before it", "disjoint blocks in ascending order; sort them by row, join those that overlap");
    next = b.row + size;
    if (next > s.rows || next > owner[b.row].first + owner[b.row].second)
      throw ModelError("", element, std::to_string(size) + " rows reach beyond one constraint",
                       "a block over rows of one constraint; split it");
    for (Index i = b.row; i < next; ++i)
      if (!(diagonal[i] == T(0) || ScalarTraits<T>::is_infinite(diagonal[i])))
        throw ModelError("", element, "row " + std::to_string(i) + " also has a diagonal entry", "0 there, or ∞; put all of a block into the block");
  }
}

#define DELASSUS_INSTANTIATE(T) template struct Damping<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
template void Damping<PrimeField>::multiply(const VectorX<PrimeField>&, VectorX<PrimeField>&) const;
template void Damping<PrimeField>::check_sizes(const Structure&) const;
template Report Damping<PrimeField>::judged(std::vector<PrimeField>&) const;
#endif

}  // namespace delassus
