#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/ldlt.h"
#include "algorithms/operators/dense_cholesky.h"

#include <algorithm>
#include <iterator>

namespace delassus {

template <class T> void DenseCholesky<T>::analyze_form() {
  const Structure& s = *this->structure();
  const Index n = s.dofs(), m = s.rows;
  composite_.assign(static_cast<std::size_t>(s.bodies()), Matrix6<T>::Zero());
  M_.setZero(n, n);
  Y_.setZero(n, m);
  DY_.setZero(n, m);
}

// M_kl = S_kᵀ H^c_j S_l for l a degree of freedom of joint j and k one of j's own or an ancestor's: in leaf-first order the
// lower triangle, and within a joint what is above it.
template <class T> void DenseCholesky<T>::assemble_M(const Problem<T>& problem) {
  const Structure& s = *this->structure();
  const Index last = M_.rows() - 1;
  M_.setZero();
  composite_ = problem.H;
  for (Index j = s.bodies(); j-- > 0;) {
    if (s.parent[j] != ground) composite_[s.parent[j]] += composite_[j];
    for (Index l = s.first_dof[j]; l < s.first_dof[j + 1]; ++l) {
      const Vector6<T> F = composite_[j] * problem.S[l];
      for (Index i = j; i != ground; i = s.parent[i])
        for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) M_(last - k, last - l) = problem.S[k].dot(F);
      M_(last - l, last - l) += problem.armature[l];
    }
  }
}

// Jᵀ: K_e^i S_k along the path from body i to its root; 𝒦_i on its own joint.
template <class T> void DenseCholesky<T>::assemble_J(const Problem<T>& problem) {
  const Structure& s = *this->structure();
  const Index last = Y_.rows() - 1;
  Y_.setZero();
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index i = link.body; i != ground; i = s.parent[i])
        for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k)
          for (Index r = 0; r < e.rows; ++r) Y_(last - k, e.row + r) += problem.K[link.first + r].dot(problem.S[k]);
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r)
      for (Index c = 0; c < s.dofs(j.body); ++c)
        Y_(last - s.first_dof[j.body] - c, j.row + r) += problem.joint_K[j.first + r * s.dofs(j.body) + c];
}

template <class T> Report DenseCholesky<T>::factor_M(const Problem<T>& problem) {
  const Index n = M_.rows();
  assemble_M(problem);
  const Index lost = ldlt_factor(M_.data(), n, n);  // M = L D Lᵀ
  const auto& first = this->structure()->first_dof;
  return lost < 0 ? Report{} : Report{Status::lost_pivot, *std::prev(std::upper_bound(first.begin(), first.end(), n - 1 - lost))};
}

template <class T> void DenseCholesky<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  const Index n = M_.rows(), m = this->size();
  assemble_J(problem);
  if (n == 0) return;
  for (Index c = 0; c < m; ++c) {
    T* const y = Y_.data() + c * n;
    for (Index k = 0; k < n; ++k)  // Y = L⁻¹ Jᵀ
      Eigen::Map<VectorX<T>>(y + k + 1, n - k - 1) -= Eigen::Map<const VectorX<T>>(M_.data() + k * n + k + 1, n - k - 1) * y[k];
    for (Index k = 0; k < n; ++k) DY_(k, c) = y[k] / M_(k, k);
  }
  for (Index c = 0; c < m; ++c)  // A₀ = Yᵀ D⁻¹ Y
    for (Index r = c; r < m; ++r) A0(r, c) = Y_.col(r).dot(DY_.col(c));
}

// z = L⁻¹ r₁ in `work`, degrees of freedom backwards;  x −= (D⁻¹Y)ᵀ z
template <class T> void DenseCholesky<T>::subtract_rates(const T* r1, T* x, T* work) const {
  const Index n = M_.rows();
  for (Index k = 0; k < n; ++k) work[k] = r1[n - 1 - k];
  for (Index k = 0; k < n; ++k)
    for (Index r = k + 1; r < n; ++r) work[r] -= M_(r, k) * work[k];
  for (Index r = 0; r < this->size(); ++r)
    for (Index k = 0; k < n; ++k) x[r] -= DY_(k, r) * work[k];
}

// ν = L⁻ᵀ D⁻¹ (z + Y λ)
template <class T> void DenseCholesky<T>::motion(const T*, const T* lambda, T* nu, T* work) const {
  const Index n = M_.rows();
  for (Index r = 0; r < this->size(); ++r)
    for (Index k = 0; k < n; ++k) work[k] += Y_(k, r) * lambda[r];
  for (Index k = n; k-- > 0;) {
    work[k] = work[k] / M_(k, k);
    for (Index r = k + 1; r < n; ++r) work[k] -= M_(r, k) * work[r];
  }
  for (Index k = 0; k < n; ++k) nu[n - 1 - k] = work[k];
}

template <class T> Index DenseCholesky<T>::form_bytes() const {
  return static_cast<Index>(sizeof(T)) * (M_.size() + Y_.size() + DY_.size()) +
         static_cast<Index>(sizeof(Matrix6<T>) * composite_.size());
}

#define DELASSUS_INSTANTIATE(T) template class DenseCholesky<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
