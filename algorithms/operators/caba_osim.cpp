#include "algorithms/operators/caba_osim.h"

#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T, Tree tree> void CabaOsimWith<T, tree>::do_analyze() {
  const Index m = this->size();
  plan_ = make_plan(*this->structure(), Matrix::M_R);
  factor_.analyze(*this->structure(), plan_);
  rows_.analyze(*this->structure(), plan_, tree);
  weights_.analyze(*this->structure());
  F_.setZero(m, m);
  RF_.setZero(m, m);
  inverse_.analyze(m);
}

template <class T, Tree tree> Report CabaOsimWith<T, tree>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  undamped_ = factor_.start(problem);
  rows_.load(problem);
  return do_update_damping(damping);
}

template <class T, Tree tree> Report CabaOsimWith<T, tree>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  factor_.move_rows(problem);
  rows_.load(problem);
  return do_update_damping(damping);
}

template <class T, Tree tree> Report CabaOsimWith<T, tree>::do_update_damping(const Damping<T>& damping) {
  factored_ = undamped_;
  if (factored_.ok()) factored_ = weights_.assign_inverse(damping);
  if (factored_.ok()) factored_ = factor_.update_weights(weights_);
  if (factored_.ok()) invert();
  return factored_;
}

// V = R − (R F) R, its lower triangle, a block of R after the other: of its columns the rows from its first on
template <class T, Tree tree> void CabaOsimWith<T, tree>::invert() {
  const Structure& s = *this->structure();
  const Index m = s.rows;
  F_.setZero();
  rows_.form(factor_, F_);
  Index e = 0;
  const auto block = [&](Index first, Index count) {
    const T* const R = weights_.dense(e++);
    for (Index c = first; c < first + count; ++c)
      for (Index r = c + 1; r < first + count; ++r) F_(c, r) = F_(r, c);
    for (Index c = first; c < first + count; ++c) weights_.multiply(F_.data() + c * m, RF_.data() + c * m);
    for (Index c = first; c < first + count; ++c) {
      T* const v = F_.data() + c * m;
      if (R == nullptr) {
        for (Index r = first; r < m; ++r) v[r] = -(RF_(r, c) * weights_.diagonal(c));
        v[c] += weights_.diagonal(c);
        continue;
      }
      const T* const of_R = R + (c - first) * count;
      for (Index r = first; r < m; ++r) v[r] = -(RF_(r, first) * of_R[0]);
      for (Index k = 1; k < count; ++k)
        for (Index r = first; r < m; ++r) v[r] -= RF_(r, first + k) * of_R[k];
      for (Index r = 0; r < count; ++r) v[first + r] += of_R[r];
    }
  };
  for (const auto& c : s.link_constraints) block(c.row, c.rows);
  for (const auto& c : s.joint_constraints) block(c.row, c.rows);
  inverse_.assign(F_);
}

template <class T, Tree tree> Report CabaOsimWith<T, tree>::do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const {
  if (!factored_.ok()) return factored_;
  T *const x = workspace, *const y = x + padded(this->size());
  for (Index c = 0; c < a.cols(); ++c) {
    inverse_.load(a.data() + c * a.outerStride(), x);
    inverse_.multiply(x, y);
    inverse_.store(y, f.data() + c * f.outerStride());
  }
  return {};
}

// M_R ν = r₁ + JᵀR r₂;  λ = R (r₂ − J ν)
template <class T, Tree tree>
Report CabaOsimWith<T, tree>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy, Start, T* workspace) const {
  if (!factored_.ok()) return factored_;
  T* const rate = workspace + padded(factor_.solve_workspace());
  weights_.multiply(r2, lambda);
  factor_.solve(lambda, r1, rate, nu, workspace);
  for (Index r = 0; r < this->size(); ++r) rate[r] = r2[r] - rate[r];
  weights_.multiply(rate, lambda);
  return {};
}

template <class T, Tree tree> Index CabaOsimWith<T, tree>::do_kkt_workspace() const { return padded(factor_.solve_workspace()) + padded(this->size()); }

template <class T, Tree tree> Index CabaOsimWith<T, tree>::do_bytes() const {
  return plan_.bytes() + factor_.bytes() + rows_.bytes() + weights_.bytes() + 2 * static_cast<Index>(sizeof(T)) * F_.size() + inverse_.bytes();
}

#define DELASSUS_INSTANTIATE(T) template class CabaOsimWith<T, Tree::whole>; template class CabaOsimWith<T, Tree::contracted>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
