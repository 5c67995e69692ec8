#include "property_tests/laws/maximal_condition.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <limits>

#include "reference/definition.h"

namespace delassus::laws {
namespace {

using Matrix = MatrixX<double>;

}  // namespace

double maximal_condition(const Problem<double>& p, const Damping<double>& damping) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const Structure& s = *p.structure;
  const Index N = s.bodies(), size = 6 * N + s.rows;
  Matrix B = Matrix::Zero(size, 6 * N), C = Matrix::Zero(size, size), half = B;  // B L⁻ᵀ, H = L Lᵀ
  std::vector<Matrix> inverse;  // S⁺
  for (Index i = 0; i < N; ++i) {
    const Index n = s.dofs(i), first = s.first_dof[static_cast<std::size_t>(i)];
    Matrix S(6, n);
    for (Index k = 0; k < n; ++k) S.col(k) = p.S[static_cast<std::size_t>(first + k)];
    Matrix rows(6, 6);
    if (n > 0) {
      const Eigen::HouseholderQR<Matrix> qr(S);
      const Matrix Q = qr.householderQ();
      rows = Q.transpose();
      rows.topRows(n) = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>().solve(Matrix(Q.leftCols(n).transpose()));
    } else {
      rows.setIdentity();
    }
    inverse.push_back(rows.topRows(n));
    for (Index k = 0; k < n; ++k) {
      rows.row(k) *= std::sqrt(p.armature[static_cast<std::size_t>(first + k)]);
      C(6 * i + k, 6 * i + k) = 1;
    }
    B.block(6 * i, 6 * i, 6, 6) = rows;
    if (const Index parent = s.parent[static_cast<std::size_t>(i)]; parent != ground) B.block(6 * i, 6 * parent, 6, 6) = -rows;
  }
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) B.block(6 * N + e.row + r, 6 * link.body, 1, 6) = p.K[static_cast<std::size_t>(link.first + r)].transpose();
  for (const auto& e : s.joint_constraints)
    for (Index r = 0; r < e.rows; ++r)
      for (Index k = 0; k < s.dofs(e.body); ++k) {
        const Matrix row = inverse[static_cast<std::size_t>(e.body)].row(k) * p.joint_K[static_cast<std::size_t>(e.first + r * s.dofs(e.body) + k)];
        B.block(6 * N + e.row + r, 6 * e.body, 1, 6) += row;
        if (const Index parent = s.parent[static_cast<std::size_t>(e.body)]; parent != ground) B.block(6 * N + e.row + r, 6 * parent, 1, 6) -= row;
      }
  C.bottomRightCorner(s.rows, s.rows) = reference::damping_matrix(s, damping);
  for (Index i = 0; i < N; ++i) {
    const Eigen::LLT<Matrix6<double>> H(p.H[static_cast<std::size_t>(i)]);
    if (H.info() != Eigen::Success) return infinite;
    half.middleCols(6 * i, 6) = H.matrixL().solve(B.middleCols(6 * i, 6).transpose()).transpose();
  }
  Matrix A = half * half.transpose() + C;
  for (Index i = 0; i < N; ++i) {
    const Eigen::LLT<Matrix6<double>> block(A.block(6 * i, 6 * i, 6, 6));
    if (block.info() != Eigen::Success) return infinite;
    A.middleRows(6 * i, 6) = block.matrixL().solve(A.middleRows(6 * i, 6)).eval();
    A.middleCols(6 * i, 6) = block.matrixL().solve(A.middleCols(6 * i, 6).transpose()).transpose().eval();
  }
  for (Index r = 6 * N; r < size; ++r) {
    if (!(A(r, r) > 0)) return infinite;
    const double scale = 1 / std::sqrt(A(r, r));
    A.row(r) *= scale;
    A.col(r) *= scale;
  }
  const VectorX<double> values = Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues();
  if (size == 0) return 1;
  return values[0] > 0 ? values[size - 1] / values[0] : infinite;
}

}  // namespace delassus::laws
