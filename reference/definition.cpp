#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace delassus::reference {

// ---- square-root-free LDLᵀ -------------------------------------------------------------------------------------

namespace {

/// The pivot policy of PivotedLdlt.
template <class T> bool lost(const T& pivot, const T& scale, Index steps) {
  if (!ScalarTraits<T>::usable_pivot(pivot)) return true;
  if constexpr (ScalarTraits<T>::exact) return false;
  return pivot < T(30 * unit_roundoff<T> * static_cast<double>(steps)) * scale;
}

}  // namespace

template <class T> PivotedLdlt<T>::PivotedLdlt(MatrixX<T> A) : factor_(std::move(A)) {
  require(factor_.rows() == factor_.cols(), "PivotedLdlt: the matrix is not square");
  VectorX<T> scale(factor_.rows());
  for (Index k = 0; k < factor_.rows(); ++k) scale[k] = factor_(k, k);
  factorise(std::move(scale));
}

template <class T> PivotedLdlt<T>::PivotedLdlt(MatrixX<T> A, const VectorX<T>& scale) : factor_(std::move(A)) {
  require(factor_.rows() == factor_.cols(), "PivotedLdlt: the matrix is not square");
  require(scale.size() == factor_.rows(), "PivotedLdlt: the scale does not fit the matrix");
  factorise(scale);
}

template <class T> void PivotedLdlt<T>::factorise(VectorX<T> scale) {
  const Index n = factor_.rows();
  for (Index k = 0; k < n; ++k) order_.push_back(k);
  for (Index k = 0; k < n; ++k) {
    Index largest = k;
    for (Index i = k + 1; i < n; ++i)
      if (factor_(i, i) > factor_(largest, largest)) largest = i;
    if (largest != k) swap(k, largest, scale);
    const T d = factor_(k, k);
    if (lost(d, scale[k], k + 1)) return;
    rank_ = k + 1;
    for (Index i = k + 1; i < n; ++i) factor_(i, k) /= d;
    for (Index j = k + 1; j < n; ++j) {
      if (factor_(j, k) == T(0)) continue;
      const T t = d * factor_(j, k);
      for (Index i = j; i < n; ++i) factor_(i, j) -= factor_(i, k) * t;
    }
  }
}

// Exchanges rows and columns a < b of a symmetric matrix of which only the lower triangle is kept.
template <class T> void PivotedLdlt<T>::swap(Index a, Index b, VectorX<T>& scale) {
  using std::swap;
  for (Index j = 0; j < a; ++j) swap(factor_(a, j), factor_(b, j));
  for (Index j = a + 1; j < b; ++j) swap(factor_(j, a), factor_(b, j));
  for (Index j = b + 1; j < factor_.rows(); ++j) swap(factor_(j, a), factor_(j, b));
  swap(factor_(a, a), factor_(b, b));
  swap(scale[a], scale[b]);
  swap(order_[a], order_[b]);
}

template <class T> MatrixX<T> PivotedLdlt<T>::solve(const MatrixX<T>& B) const {
  const Index n = factor_.rows();
  require(B.rows() == n, "PivotedLdlt::solve: wrong number of rows");
  if (!regular()) throw std::runtime_error("the matrix is singular: pivot lost at row " + std::to_string(lost_row()));
  MatrixX<T> X(n, B.cols());
  VectorX<T> x(n);
  for (Index c = 0; c < B.cols(); ++c) {
    for (Index k = 0; k < n; ++k) x[k] = B(order_[k], c);
    for (Index k = 0; k < n; ++k) {
      if (x[k] == T(0)) continue;
      for (Index i = k + 1; i < n; ++i) x[i] -= factor_(i, k) * x[k];
    }
    for (Index k = n - 1; k >= 0; --k) {
      x[k] /= factor_(k, k);
      for (Index i = k + 1; i < n; ++i) x[k] -= factor_(i, k) * x[i];
    }
    for (Index k = 0; k < n; ++k) X(order_[k], c) = x[k];
  }
  return X;
}

template <class T> MatrixX<T> PivotedLdlt<T>::inverse() const {
  const Index n = factor_.rows();
  MatrixX<T> identity(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) identity(i, j) = T(i == j ? 1 : 0);
  MatrixX<T> X = solve(identity);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < j; ++i) X(i, j) = X(j, i);
  return X;
}

// ---- the definition --------------------------------------------------------------------------------------------

namespace {

template <class T> MatrixX<T> zeros(Index rows, Index columns) {
  MatrixX<T> X(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) X(i, j) = T(0);
  return X;
}

template <class T> T dot(const Vector6<T>& x, const Vector6<T>& y) {
  T sum(0);
  for (Index i = 0; i < 6; ++i) sum += x[i] * y[i];
  return sum;
}

template <class T> Vector6<T> times(const Matrix6<T>& H, const Vector6<T>& x) {
  Vector6<T> y;
  for (Index i = 0; i < 6; ++i) {
    y[i] = T(0);
    for (Index j = 0; j < 6; ++j) y[i] += H(i, j) * x[j];
  }
  return y;
}

}  // namespace

std::vector<Index> path_dofs(const Structure& structure, Index body) {
  std::vector<Index> path;
  for (Index i = body; i != ground; i = structure.parent[i])
    for (Index k = structure.first_dof[i + 1] - 1; k >= structure.first_dof[i]; --k) path.push_back(k);
  return {path.rbegin(), path.rend()};
}

template <class T> MatrixX<T> body_jacobian(const Problem<T>& problem, Index body) {
  MatrixX<T> J = zeros<T>(6, problem.structure->dofs());
  for (const Index k : path_dofs(*problem.structure, body))
    for (Index i = 0; i < 6; ++i) J(i, k) = problem.S[k][i];
  return J;
}

template <class T> MatrixX<T> constraint_jacobian(const Problem<T>& problem) {
  const Structure& s = *problem.structure;
  MatrixX<T> J = zeros<T>(s.rows, s.dofs());
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (const Index k : path_dofs(s, link.body))
        for (Index r = 0; r < e.rows; ++r) J(e.row + r, k) += dot(problem.K[link.first + r], problem.S[k]);
  for (const auto& c : s.joint_constraints) {
    const Index n = s.dofs(c.body);
    for (Index r = 0; r < c.rows; ++r)
      for (Index k = 0; k < n; ++k) J(c.row + r, s.first_dof[c.body] + k) += problem.joint_K[c.first + r * n + k];
  }
  return J;
}

template <class T> MatrixX<T> mass_matrix(const Problem<T>& problem) {
  const Structure& s = *problem.structure;
  MatrixX<T> M = zeros<T>(s.dofs(), s.dofs());
  for (Index i = 0; i < s.bodies(); ++i) {
    const std::vector<Index> path = path_dofs(s, i);
    for (const Index l : path) {
      const Vector6<T> momentum = times(problem.H[i], problem.S[l]);
      for (const Index k : path) M(k, l) += dot(problem.S[k], momentum);
    }
  }
  for (Index k = 0; k < s.dofs(); ++k) M(k, k) += problem.armature[k];
  return M;
}

template <class T> MatrixX<T> damping_matrix(const Structure& structure, const Damping<T>& damping) {
  MatrixX<T> R_inverse = zeros<T>(structure.rows, structure.rows);
  for (Index r = 0; r < structure.rows; ++r) R_inverse(r, r) = damping.diagonal[r];
  for (const auto& block : damping.blocks)
    for (Index j = 0; j < block.R_inverse.cols(); ++j)
      for (Index i = 0; i < block.R_inverse.rows(); ++i) R_inverse(block.row + i, block.row + j) += block.R_inverse(i, j);
  return R_inverse;
}

template <class T> MatrixX<T> product(const MatrixX<T>& X, const MatrixX<T>& Y) {
  require(X.cols() == Y.rows(), "product: shapes do not fit");
  MatrixX<T> Z = zeros<T>(X.rows(), Y.cols());
  for (Index i = 0; i < X.rows(); ++i)
    for (Index k = 0; k < X.cols(); ++k) {
      if (X(i, k) == T(0)) continue;
      for (Index j = 0; j < Y.cols(); ++j) Z(i, j) += X(i, k) * Y(k, j);
    }
  return Z;
}

template <class T> Dense<T> dense(const Problem<T>& problem, const Damping<T>& damping) {
  problem.check_sizes();
  require(static_cast<Index>(damping.diagonal.size()) == problem.structure->rows, "dense: damping does not fit");
  Dense<T> d;
  d.M = mass_matrix(problem);
  d.J = constraint_jacobian(problem);
  d.R_inverse = damping_matrix(*problem.structure, damping);
  const PivotedLdlt<T> M(d.M);
  if (!M.regular())
    throw std::runtime_error("M is singular: pivot lost at degree of freedom " + std::to_string(M.lost_row()));
  d.M_inv_Jt = M.solve(d.J.transpose());
  d.A0 = product(d.J, d.M_inv_Jt);
  return d;
}

template <class T> PivotedLdlt<T> factorise(const Dense<T>& d) {
  using std::abs;
  VectorX<T> scale(d.A0.rows());
  for (Index r = 0; r < d.A0.rows(); ++r) {
    scale[r] = d.R_inverse(r, r);
    for (Index k = 0; k < d.J.cols(); ++k) scale[r] += T(abs(d.J(r, k) * d.M_inv_Jt(k, r)));
  }
  return PivotedLdlt<T>(d.A(), scale);
}

namespace {

template <class T> PivotedLdlt<T> regular_factor(const Dense<T>& d) {
  PivotedLdlt<T> A = factorise(d);
  if (!A.regular())
    throw std::runtime_error("A = J M⁻¹ Jᵀ + R⁻¹ is singular: pivot lost at row " + std::to_string(A.lost_row()));
  return A;
}

}  // namespace

template <class T> MatrixX<T> dense_damped_inverse(const Dense<T>& d) { return regular_factor(d).inverse(); }

template <class T> MatrixX<T> dense_apply(const Dense<T>& d, const MatrixX<T>& f) {
  return product(d.A0, f) + product(d.R_inverse, f);
}

template <class T> MatrixX<T> dense_solve(const Dense<T>& d, const MatrixX<T>& a) { return regular_factor(d).solve(a); }

#define DELASSUS_INSTANTIATE(T)                                                              \
  template class PivotedLdlt<T>;                                                             \
  template MatrixX<T> body_jacobian(const Problem<T>&, Index);                               \
  template MatrixX<T> constraint_jacobian(const Problem<T>&);                                \
  template MatrixX<T> mass_matrix(const Problem<T>&);                                        \
  template MatrixX<T> damping_matrix(const Structure&, const Damping<T>&);                   \
  template Dense<T> dense(const Problem<T>&, const Damping<T>&);                             \
  template PivotedLdlt<T> factorise(const Dense<T>&);                                        \
  template MatrixX<T> dense_damped_inverse(const Dense<T>&);                                 \
  template MatrixX<T> dense_apply(const Dense<T>&, const MatrixX<T>&);                       \
  template MatrixX<T> dense_solve(const Dense<T>&, const MatrixX<T>&);                       \
  template MatrixX<T> product(const MatrixX<T>&, const MatrixX<T>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Rational)

}  // namespace delassus::reference
