#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/ldlt.h"
#include "algorithms/operators/dense_cholesky.h"

#include <algorithm>
#include <iterator>

namespace delassus {

template <class T> void DenseCholesky<T>::do_analyze() {
  const Structure& s = *this->structure();
  const Index n = s.dofs(), m = s.rows;
  composite_.assign(static_cast<std::size_t>(s.bodies()), Matrix6<T>::Zero());
  M_.setZero(n, n);
  Y_.setZero(n, m);
  DY_.setZero(n, m);
  A0_.setZero(m, m);
  A_.setZero(m, m);
  factor_.setZero(m, m);
  damping_.analyze(s);
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

template <class T> Report DenseCholesky<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  const Index n = M_.rows();
  assemble_M(problem);
  const Index lost = ldlt_factor(M_.data(), n, n);  // M = L D Lᵀ
  const auto& first = this->structure()->first_dof;
  factored_M_ = lost < 0 ? Report{} : Report{Status::lost_pivot, *std::prev(std::upper_bound(first.begin(), first.end(), n - 1 - lost))};
  return do_update_rows(problem, damping);
}

template <class T> Report DenseCholesky<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  const Index n = M_.rows(), m = this->size();
  assemble_J(problem);
  if (!factored_M_.ok()) return factored_M_;
  for (Index c = 0; c < m; ++c) {
    T* const y = Y_.data() + c * n;
    for (Index k = 0; k < n; ++k)  // Y = L⁻¹ Jᵀ
      Eigen::Map<VectorX<T>>(y + k + 1, n - k - 1) -= Eigen::Map<const VectorX<T>>(M_.data() + k * n + k + 1, n - k - 1) * y[k];
    for (Index k = 0; k < n; ++k) DY_(k, c) = y[k] / M_(k, k);
  }
  for (Index c = 0; c < m; ++c)  // A₀ = Yᵀ D⁻¹ Y
    for (Index r = c; r < m; ++r) A0_(r, c) = A0_(c, r) = n == 0 ? T(0) : T(Y_.col(r).dot(DY_.col(c)));
  return do_update_damping(damping);
}

template <class T> Report DenseCholesky<T>::do_update_damping(const Damping<T>& damping) {
  if (!factored_M_.ok()) return factored_M_;
  const Structure& s = *this->structure();
  damping_.assign(damping);
  A_ = A0_;  // A = J M⁻¹ Jᵀ + R⁻¹
  Index e = 0;
  const auto add_damping = [&](Index row, Index rows) {
    const T* const block = damping_.dense(e++);
    for (Index c = 0; c < rows; ++c)
      for (Index r = 0; r < rows; ++r)
        if (block != nullptr) A_(row + r, row + c) += block[c * rows + r];
        else if (r == c) A_(row + r, row + c) += damping_.diagonal(row + r);
  };
  for (const auto& c : s.link_constraints) add_damping(c.row, c.rows);
  for (const auto& c : s.joint_constraints) add_damping(c.row, c.rows);
  for (const Index r : damping_.off()) {
    A_.row(r).setZero();
    A_.col(r).setZero();
  }
  factor_ = A_;
  for (const Index r : damping_.off()) factor_(r, r) = T(1);  // λ_r = 0 of a right-hand side 0
  const Index lost = ldlt_factor(factor_.data(), s.rows, s.rows);
  factored_A_ = lost < 0 ? Report{} : Report{.status = Status::lost_pivot, .where = lost, .of_A = true};
  return {};  // apply is defined all the same; solve reports the lost pivot
}

template <class T> Report DenseCholesky<T>::do_apply(ConstRef<T> f, Ref<T> a, T*) const {
  if (!factored_M_.ok()) return factored_M_;
  for (Index c = 0; c < f.cols(); ++c) {
    a.col(c).setZero();
    for (Index k = 0; k < f.rows(); ++k) a.col(c) += A_.col(k) * f(k, c);
  }
  return {};
}

template <class T> Report DenseCholesky<T>::do_solve(ConstRef<T> a, Ref<T> f, T*) const {
  if (!factored_M_.ok()) return factored_M_;
  if (!factored_A_.ok()) return factored_A_;
  f = a;
  for (Index c = 0; c < f.cols(); ++c) damping_.switch_off(f.data() + c * f.outerStride());
  for (Index c = 0; c < f.cols(); ++c) ldlt_solve(factor_.data(), f.rows(), f.rows(), f.data() + c * f.outerStride());
  return {};
}

// z = L⁻¹ r₁;  λ = A⁻¹ (r₂ − (D⁻¹Y)ᵀ z);  ν = L⁻ᵀ D⁻¹ (z + Y λ), degrees of freedom backwards
template <class T>
Report DenseCholesky<T>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy, Start, T* workspace) const {
  if (!factored_M_.ok()) return factored_M_;
  if (!factored_A_.ok()) return factored_A_;
  const Index n = M_.rows(), m = this->size();
  T* const z = workspace;
  for (Index k = 0; k < n; ++k) z[k] = r1[n - 1 - k];
  for (Index k = 0; k < n; ++k)
    for (Index r = k + 1; r < n; ++r) z[r] -= M_(r, k) * z[k];
  for (Index r = 0; r < m; ++r) {
    lambda[r] = r2[r];
    for (Index k = 0; k < n; ++k) lambda[r] -= DY_(k, r) * z[k];
  }
  damping_.switch_off(lambda);
  ldlt_solve(factor_.data(), m, m, lambda);
  for (Index r = 0; r < m; ++r)
    for (Index k = 0; k < n; ++k) z[k] += Y_(k, r) * lambda[r];
  for (Index k = n; k-- > 0;) {
    z[k] = z[k] / M_(k, k);
    for (Index r = k + 1; r < n; ++r) z[k] -= M_(r, k) * z[r];
  }
  for (Index k = 0; k < n; ++k) nu[n - 1 - k] = z[k];
  return {};
}

template <class T> Index DenseCholesky<T>::do_bytes() const {
  return static_cast<Index>(sizeof(T)) * (M_.size() + Y_.size() + DY_.size() + 3 * A_.size()) +
         static_cast<Index>(sizeof(Matrix6<T>) * composite_.size()) + damping_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class DenseCholesky<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
