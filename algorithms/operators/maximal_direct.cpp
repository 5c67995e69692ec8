#include "algorithms/operators/maximal_direct.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void MaximalDirect<T>::analyze_form() {
  const Structure& s = *this->structure();
  const std::size_t bodies = static_cast<std::size_t>(s.bodies());
  first_.assign(bodies, 0);
  at_ = first_;
  active_.assign(bodies, 0);
  Index size = 0;
  unknowns_ = 0;
  for (Index i = 0; i < s.bodies(); ++i) {
    first_[i] = size;
    at_[i] = unknowns_;
    size += most * pivots(i);
    unknowns_ += pivots(i);
  }
  std::vector<std::vector<OfRow>> of_row(static_cast<std::size_t>(s.rows));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) of_row[e.row + r].push_back({link.body, link.first + r, 0});
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r) of_row[j.row + r].push_back({j.body, j.first + r * s.dofs(j.body), s.dofs(j.body)});
  parts_.clear();
  first_row_.assign(1, 0);
  for (const auto& parts : of_row) {
    parts_.insert(parts_.end(), parts.begin(), parts.end());
    first_row_.push_back(static_cast<Index>(parts_.size()));
    for (const OfRow& part : parts)
      for (Index i = part.body; i != ground; i = s.parent[i]) active_[i] = 1;
  }
  factor_.assign(static_cast<std::size_t>(size), T(0));
  inertia_.assign(bodies, Matrix6<T>::Zero());
  k_.assign(static_cast<std::size_t>(s.K_rows), Vector6<T>::Zero());
  joint_k_.assign(static_cast<std::size_t>(s.joint_K_size), T(0));
  x_.assign(static_cast<std::size_t>(unknowns_), T(0));
}

// Rows of the front: a_1 φ_1 … a_6 φ_6, ν, then a_π.
template <class T> bool MaximalDirect<T>::factor_body(Index body, const Problem<T>& problem) {
  const Structure& s = *this->structure();
  const Index n = s.dofs(body), p = pivots(body), rows = s.parent[body] == ground ? p : p + 6;
  T F[most][most];  // lower triangle
  for (Index r = 0; r < rows; ++r)
    for (Index c = 0; c <= r; ++c) F[r][c] = T(0);
  for (Index r = 0; r < 6; ++r) {
    for (Index c = 0; c <= r; ++c) F[2 * r][2 * c] = inertia_[body](r, c);
    F[2 * r + 1][2 * r] = T(1);
    for (Index k = 0; k < n; ++k) F[12 + k][2 * r + 1] = T(-problem.S[s.first_dof[body] + k][r]);
    if (rows > p) F[p + r][2 * r + 1] = T(-1);
  }
  for (Index k = 0; k < n; ++k) F[12 + k][12 + k] = problem.armature[s.first_dof[body] + k];
  for (Index c = 0; c < p;) {
    const Index width = c < 12 ? 2 : 1;
    const T d = F[c][c];
    if (width == 1 && !ScalarTraits<T>::usable_pivot(d)) return false;
    for (Index r = c + width; r < rows; ++r) {  // (x, y) [h 1; 1 0]⁻¹ = (y, x − h y)
      L(body, r, c) = width == 2 ? F[r][c + 1] : T(F[r][c] / d);
      if (width == 2) L(body, r, c + 1) = F[r][c] - d * F[r][c + 1];
    }
    for (Index r = c + width; r < rows; ++r)
      for (Index q = c + width; q <= r; ++q)
        for (Index w = 0; w < width; ++w) F[r][q] -= L(body, r, c + w) * F[q][c + w];
    L(body, c, c) = d;
    c += width;
  }
  for (Index r = 0; rows > p && r < 6; ++r)
    for (Index c = 0; c <= r; ++c) inertia_[s.parent[body]](r, c) += F[p + r][p + c];
  return true;
}

template <class T> Report MaximalDirect<T>::factor_M(const Problem<T>& problem) {
  const Structure& s = *this->structure();
  std::copy(problem.H.begin(), problem.H.end(), inertia_.begin());
  for (Index i = s.bodies(); i-- > 0;)
    if (!factor_body(i, problem)) return {Status::lost_pivot, s.first_dof[i]};
  return {};
}

template <class T> void MaximalDirect<T>::forward(Index body, T* x) const {
  const Index p = pivots(body), parent = this->structure()->parent[body];
  T *const v = x + at_[body], *const of_parent = parent == ground ? nullptr : x + at_[parent];
  for (Index c = 0; c < p; ++c) {
    for (Index r = c + (c < 12 && c % 2 == 0 ? 2 : 1); r < p; ++r) v[r] -= L(body, r, c) * v[c];
    for (Index r = 0; of_parent != nullptr && r < 6; ++r) of_parent[2 * r] -= L(body, p + r, c) * v[c];
  }
}

template <class T> void MaximalDirect<T>::backward(Index body, T* x) const {
  const Index p = pivots(body), parent = this->structure()->parent[body];
  T *const v = x + at_[body], *const of_parent = parent == ground ? nullptr : x + at_[parent];
  for (Index k = 0; k < 6; ++k) {  // [h 1; 1 0]⁻¹
    const T of_a = v[2 * k];
    v[2 * k] = v[2 * k + 1];
    v[2 * k + 1] = of_a - L(body, 2 * k, 2 * k) * v[2 * k];
  }
  for (Index c = 12; c < p; ++c) v[c] = v[c] / L(body, c, c);
  for (Index c = p; c-- > 0;) {
    for (Index r = c + (c < 12 && c % 2 == 0 ? 2 : 1); r < p; ++r) v[c] -= L(body, r, c) * v[r];
    for (Index r = 0; of_parent != nullptr && r < 6; ++r) v[c] -= L(body, p + r, c) * of_parent[2 * r];
  }
}

template <class T> void MaximalDirect<T>::add_row(Index row, T* x) const {
  for (Index k = first_row_[row]; k < first_row_[row + 1]; ++k) {
    const OfRow& part = parts_[k];
    T* const v = x + at_[part.body];
    for (Index c = 0; part.count == 0 && c < 6; ++c) v[2 * c] += k_[part.first][c];
    for (Index c = 0; c < part.count; ++c) v[12 + c] += joint_k_[part.first + c];
  }
}

template <class T> T MaximalDirect<T>::rate_of(Index row, const T* x) const {
  T sum(0);
  for (Index k = first_row_[row]; k < first_row_[row + 1]; ++k) {
    const OfRow& part = parts_[k];
    const T* const v = x + at_[part.body];
    for (Index c = 0; part.count == 0 && c < 6; ++c) sum += k_[part.first][c] * v[2 * c];
    for (Index c = 0; c < part.count; ++c) sum += joint_k_[part.first + c] * v[12 + c];
  }
  return sum;
}

template <class T> void MaximalDirect<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  const Index bodies = this->structure()->bodies(), m = this->size();
  std::copy(problem.K.begin(), problem.K.end(), k_.begin());
  std::copy(problem.joint_K.begin(), problem.joint_K.end(), joint_k_.begin());
  for (Index row = 0; row < m; ++row) {
    std::fill(x_.begin(), x_.end(), T(0));
    add_row(row, x_.data());
    for (Index i = bodies; i-- > 0;)
      if (active_[i]) forward(i, x_.data());
    for (Index i = 0; i < bodies; ++i)
      if (active_[i]) backward(i, x_.data());
    for (Index r = row; r < m; ++r) A0(r, row) = rate_of(r, x_.data());
  }
}

template <class T> void MaximalDirect<T>::subtract_rates(const T* r1, T* x, T* work) const {
  const Structure& s = *this->structure();
  std::fill(work, work + unknowns_, T(0));
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = 0; k < s.dofs(i); ++k) work[at_[i] + 12 + k] = r1[s.first_dof[i] + k];
  for (Index i = s.bodies(); i-- > 0;) forward(i, work);
  for (Index i = 0; i < s.bodies(); ++i) backward(i, work);
  for (Index r = 0; r < s.rows; ++r) x[r] -= rate_of(r, work);
}

template <class T> void MaximalDirect<T>::motion(const T* r1, const T* lambda, T* nu, T* work) const {
  const Structure& s = *this->structure();
  std::fill(work, work + unknowns_, T(0));
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = 0; k < s.dofs(i); ++k) work[at_[i] + 12 + k] = r1[s.first_dof[i] + k];
  for (Index row = 0; row < s.rows; ++row)
    for (Index k = first_row_[row]; k < first_row_[row + 1]; ++k) {
      const OfRow& part = parts_[k];
      T* const v = work + at_[part.body];
      for (Index c = 0; part.count == 0 && c < 6; ++c) v[2 * c] += k_[part.first][c] * lambda[row];
      for (Index c = 0; c < part.count; ++c) v[12 + c] += joint_k_[part.first + c] * lambda[row];
    }
  for (Index i = s.bodies(); i-- > 0;) forward(i, work);
  for (Index i = 0; i < s.bodies(); ++i) backward(i, work);
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = 0; k < s.dofs(i); ++k) nu[s.first_dof[i] + k] = work[at_[i] + 12 + k];
}

template <class T> Index MaximalDirect<T>::form_bytes() const {
  const auto scalars = factor_.size() + joint_k_.size() + x_.size();
  return static_cast<Index>(scalars * sizeof(T) + inertia_.size() * sizeof(Matrix6<T>) + k_.size() * sizeof(Vector6<T>) + active_.size() +
                            (first_.size() + at_.size() + first_row_.size()) * sizeof(Index) + parts_.size() * sizeof(OfRow));
}

#define DELASSUS_INSTANTIATE(T) template class MaximalDirect<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
