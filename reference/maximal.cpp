#include "algorithms/kit/test_scalars.h"
#include "reference/maximal.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace delassus::reference {

namespace {

constexpr int refinement_steps = 3;

/// The power of two that brings x > 0 into [1, 2); 1 for zero.
template <class T> T normalising_power(const T& x) {
  if constexpr (ScalarTraits<T>::exact) return T(1);
  const double d = static_cast<double>(x);
  if (!(d > 0) || !std::isfinite(d)) return T(1);
  return T(std::ldexp(1.0, -std::ilogb(d)));
}

template <class T> T magnitude(const T& x) { return x < T(0) ? T(-x) : x; }

}  // namespace

template <class T> PivotedLu<T>::PivotedLu(MatrixX<T> A) : A_(std::move(A)) {
  require(A_.rows() == A_.cols(), "PivotedLu: the matrix is not square");
  factor_ = A_;
  scale();
  factorise();
}

template <class T> void PivotedLu<T>::scale() {
  const Index n = factor_.rows();
  row_scale_.resize(n);
  column_scale_.resize(n);
  for (Index i = 0; i < n; ++i) {
    T largest(0);
    for (Index j = 0; j < n; ++j)
      if (magnitude(factor_(i, j)) > largest) largest = magnitude(factor_(i, j));
    row_scale_[i] = normalising_power(largest);
    for (Index j = 0; j < n; ++j) factor_(i, j) *= row_scale_[i];
  }
  for (Index j = 0; j < n; ++j) {
    T largest(0);
    for (Index i = 0; i < n; ++i)
      if (magnitude(factor_(i, j)) > largest) largest = magnitude(factor_(i, j));
    column_scale_[j] = normalising_power(largest);
    for (Index i = 0; i < n; ++i) factor_(i, j) *= column_scale_[j];
  }
}

template <class T> void PivotedLu<T>::factorise() {
  const Index n = factor_.rows();
  // Entries of the scaled matrix are below 2.
  const T smallest = T(30 * unit_roundoff<T> * 2 * static_cast<double>(n));
  for (Index i = 0; i < n; ++i) order_.push_back(i);
  for (Index k = 0; k < n; ++k) {
    Index p = k;
    for (Index i = k; i < n; ++i) {
      if (ScalarTraits<T>::exact && !(factor_(p, k) == T(0))) break;
      if (magnitude(factor_(i, k)) > magnitude(factor_(p, k))) p = i;
    }
    if (!(magnitude(factor_(p, k)) > smallest))
      throw std::runtime_error("the maximal-coordinate system is singular: pivot lost at unknown " + std::to_string(k));
    if (p != k) {
      for (Index j = 0; j < n; ++j) std::swap(factor_(p, j), factor_(k, j));
      std::swap(order_[p], order_[k]);
    }
    for (Index i = k + 1; i < n; ++i) {
      if (factor_(i, k) == T(0)) continue;
      const T multiplier = factor_(i, k) /= factor_(k, k);
      for (Index j = k + 1; j < n; ++j) factor_(i, j) -= multiplier * factor_(k, j);
    }
  }
}

template <class T> VectorX<T> PivotedLu<T>::solve_once(const VectorX<T>& b) const {
  const Index n = factor_.rows();
  VectorX<T> x(n);
  for (Index k = 0; k < n; ++k) {
    x[k] = b[order_[k]] * row_scale_[order_[k]];
    for (Index j = 0; j < k; ++j) x[k] -= factor_(k, j) * x[j];
  }
  for (Index k = n - 1; k >= 0; --k) {
    for (Index j = k + 1; j < n; ++j) x[k] -= factor_(k, j) * x[j];
    x[k] /= factor_(k, k);
  }
  for (Index k = 0; k < n; ++k) x[k] *= column_scale_[k];
  return x;
}

template <class T> MatrixX<T> PivotedLu<T>::solve(const MatrixX<T>& B) const {
  const Index n = factor_.rows();
  require(B.rows() == n, "PivotedLu::solve: wrong number of rows");
  MatrixX<T> X(n, B.cols());
  for (Index c = 0; c < B.cols(); ++c) {
    VectorX<T> x = solve_once(B.col(c));
    for (int step = 0; step < (ScalarTraits<T>::exact ? 0 : refinement_steps); ++step) {
      VectorX<T> r = B.col(c);
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i)
          if (!(A_(i, j) == T(0))) r[i] -= A_(i, j) * x[j];
      const VectorX<T> correction = solve_once(r);
      for (Index i = 0; i < n; ++i) x[i] += correction[i];
    }
    X.col(c) = x;
  }
  return X;
}

namespace {

template <class T> MatrixX<T> dense_matrix(const Kkt<T>& system, bool with_rows) {
  const Index size = with_rows ? system.layout.size() : system.layout.motion_size();
  MatrixX<T> matrix = MatrixX<T>::Constant(size, size, T(0));
  for (const auto& e : system.entries(with_rows)) {
    matrix(e.row, e.column) += e.value;
    if (e.row != e.column) matrix(e.column, e.row) += e.value;
  }
  return matrix;
}

}  // namespace

template <class T>
MatrixX<T> maximal_apply(const Problem<T>& problem, const Damping<T>& damping, const MatrixX<T>& f) {
  require(f.rows() == problem.structure->rows, "maximal_apply: wrong number of rows");
  const Kkt<T> system = kkt(problem, damping);
  return system.accelerations(PivotedLu<T>(dense_matrix(system, false)).solve(system.forces(f)), f);
}

template <class T>
MatrixX<T> maximal_solve(const Problem<T>& problem, const Damping<T>& damping, const MatrixX<T>& a) {
  const Index m = problem.structure->rows;
  require(a.rows() == m, "maximal_solve: wrong number of rows");
  const Kkt<T> system = kkt(problem, damping);
  MatrixX<T> right = MatrixX<T>::Constant(system.layout.size(), a.cols(), T(0));
  right.bottomRows(m) = a;
  return -PivotedLu<T>(dense_matrix(system, true)).solve(right).bottomRows(m);
}

#define DELASSUS_INSTANTIATE(T)                                                                      \
  template class PivotedLu<T>;                                                                       \
  template MatrixX<T> maximal_apply(const Problem<T>&, const Damping<T>&, const MatrixX<T>&);        \
  template MatrixX<T> maximal_solve(const Problem<T>&, const Damping<T>&, const MatrixX<T>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Rational)

}  // namespace delassus::reference
