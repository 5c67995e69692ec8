#include "algorithms/operators/maximal_free.h"

#include <algorithm>

#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/ldlt.h"

namespace delassus {
namespace {

template <class T> using Sixth = Eigen::Map<Vector6<T>>;
template <class T> using ConstSixth = Eigen::Map<const Vector6<T>>;

template <class T> T inner(const T* x, const T* y, Index n) {
  T sum(0);
  for (Index k = 0; k < n; ++k) sum += x[k] * y[k];
  return sum;
}

/// gram ← the factor of SᵀHS; false where the n columns are dependent.
template <class T> bool factor_gram(const Vector6<T>* S, const Vector6<T>* HS, Index n, T* gram) {
  for (Index r = 0; r < n; ++r)
    for (Index c = 0; c <= r; ++c) gram[c * n + r] = S[r].dot(HS[c]);
  return ldlt_factor(gram, n, n) < 0;
}

/// Rows of (SᵀHS)⁻¹Xᵀ.
template <class T> void divide_by_gram(const T* gram, const Vector6<T>* X, Index n, Vector6<T>* rows) {
  for (Index k = 0; k < 6; ++k) {
    T x[6];
    for (Index r = 0; r < n; ++r) x[r] = X[r][k];
    ldlt_solve(gram, n, n, x);
    for (Index r = 0; r < n; ++r) rows[r][k] = x[r];
  }
}

/// 6 − n forces g without work on S, orthogonal in H⁻¹: of the unit forces less their part HS(SᵀHS)⁻¹Sᵀ the one of which most is left,
/// again and again. What is compared has no unit.
template <class T> void find_complement(const Vector6<T>* HS, const Vector6<T>* part, Index n, const Matrix6<T>& H_inverse, Matrix6<T>& out) {
  Matrix6<T> P = Matrix6<T>::Identity();
  for (Index k = 0; k < n; ++k) P -= HS[k] * part[k].transpose();
  for (Index c = n; c < 6; ++c) {
    const auto left = [&](Index k) { return T(P.col(k).dot(H_inverse * P.col(k)) / H_inverse(k, k)); };
    Index most = 0;
    for (Index k = 1; k < 6; ++k)
      if (left(k) > left(most)) most = k;
    const Vector6<T> v = P.col(most), moved = H_inverse * v;
    out.col(c) = v;
    const T size = v.dot(moved);
    for (Index k = 0; k < 6; ++k) P.col(k) -= v * T(moved.dot(P.col(k)) / size);
  }
}

}  // namespace

template <class T> void MaximalFree<T>::do_analyze() {
  const Structure& s = *this->structure();
  const std::size_t bodies = static_cast<std::size_t>(s.bodies());
  refinement_.analyze(this->structure());
  damping_.analyze(s);
  parts_.clear();
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) parts_.push_back({e.row + r, link.body, ground, link.first + r});
  Index next = s.K_rows;
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r) parts_.push_back({j.row + r, j.body, s.parent[j.body], next++});
  k_.assign(static_cast<std::size_t>(next), Vector6<T>::Zero());
  pseudo_inverse_.assign(static_cast<std::size_t>(s.dofs()), Vector6<T>::Zero());
  compliance_.assign(static_cast<std::size_t>(s.dofs()), T(0));
  H_inverse_.assign(bodies, Matrix6<T>::Zero());
  joint_ = joint_block_ = H_inverse_;
  of_rows_.assign(static_cast<std::size_t>(s.rows), T(0));
  diagonal_ = of_rows_;
}

template <class T> bool MaximalFree<T>::take_body(Index body, const Problem<T>& problem) {
  const Structure& s = *this->structure();
  const Index first = s.first_dof[body], n = s.dofs(body);
  Matrix6<T> H = problem.H[body];
  if (ldlt_factor(H.data(), 6, 6) >= 0) return false;
  ldlt_inverse(H.data(), 6, 6, H_inverse_[body].data());
  Vector6<T> HS[6], part[6];
  T gram[36];
  for (Index k = 0; k < n; ++k) HS[k] = problem.H[body] * problem.S[first + k];
  if (!factor_gram(problem.S.data() + first, HS, n, gram)) return false;
  divide_by_gram(gram, HS, n, pseudo_inverse_.data() + first);
  divide_by_gram(gram, problem.S.data() + first, n, part);
  for (Index k = 0; k < n; ++k) {
    const T& armature = problem.armature[first + k];
    joint_[body].col(k) = pseudo_inverse_[first + k] * armature;
    compliance_[first + k] = ScalarTraits<T>::usable_pivot(armature) ? armature : T(1);  // of a row that is zero, any
  }
  find_complement(HS, part, n, H_inverse_[body], joint_[body]);
  return true;
}

// G (H_i⁻¹ + H_π⁻¹) Gᵀ + C
template <class T> void MaximalFree<T>::take_joint_block(Index body) {
  const Structure& s = *this->structure();
  Matrix6<T> mobility = H_inverse_[body];
  if (s.parent[body] != ground) mobility += H_inverse_[s.parent[body]];
  joint_block_[body] = joint_[body].transpose() * mobility * joint_[body];
  for (Index k = 0; k < s.dofs(body); ++k) joint_block_[body](k, k) += compliance_[s.first_dof[body] + k];
}

template <class T> Report MaximalFree<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  const Structure& s = *this->structure();
  refinement_.update(problem);
  regular_ = refinement_.factor_mass();
  for (Index i = 0; i < s.bodies() && regular_.ok(); ++i) {
    if (!take_body(i, problem)) regular_ = {Status::lost_pivot, s.first_dof[i]};
    else take_joint_block(i);
    if (regular_.ok() && ldlt_factor(joint_block_[i].data(), 6, 6) >= 0) regular_ = {Status::lost_pivot, s.first_dof[i]};
  }
  if (regular_.ok()) take_rows(problem);
  return do_update_damping(damping);
}

template <class T> Report MaximalFree<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  refinement_.update_rows(problem);
  if (regular_.ok()) take_rows(problem);
  return do_update_damping(damping);
}

template <class T> void MaximalFree<T>::take_rows(const Problem<T>& problem) {
  const Structure& s = *this->structure();
  std::copy(problem.K.begin(), problem.K.end(), k_.begin());
  Index next = s.K_rows;
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r, ++next) {
      k_[next].setZero();
      for (Index c = 0; c < s.dofs(j.body); ++c) k_[next] += pseudo_inverse_[s.first_dof[j.body] + c] * problem.joint_K[j.first + r * s.dofs(j.body) + c];
    }
  std::fill(of_rows_.begin(), of_rows_.end(), T(0));
  for (const Part& p : parts_) {
    of_rows_[p.row] += k_[p.first].dot(H_inverse_[p.body] * k_[p.first]);
    if (p.parent != ground) of_rows_[p.row] += k_[p.first].dot(H_inverse_[p.parent] * k_[p.first]);
  }
}

template <class T> Report MaximalFree<T>::do_update_damping(const Damping<T>& damping) {
  refinement_.update_damping(damping);
  factored_ = regular_;
  if (!factored_.ok()) return factored_;
  damping_.assign(damping);
  Index e = 0;
  const auto invert = [&](Index row, Index rows) {
    const T* const block = damping_.dense(e++);
    for (Index r = 0; r < rows; ++r) {
      const T d = of_rows_[row + r] + (block != nullptr ? block[r * rows + r] : damping_.diagonal(row + r));
      diagonal_[row + r] = ScalarTraits<T>::usable_pivot(d) ? T(T(1) / d) : T(0);
    }
  };
  for (const auto& c : this->structure()->link_constraints) invert(c.row, c.rows);
  for (const auto& c : this->structure()->joint_constraints) invert(c.row, c.rows);
  return factored_;
}

template <class T> void MaximalFree<T>::add_forces(const T* x, T* f) const {
  const Structure& s = *this->structure();
  for (Index i = 0; i < s.bodies(); ++i) {
    const Vector6<T> force = joint_[i] * ConstSixth<T>(x + 6 * i);
    Sixth<T>(f + 6 * i) += force;
    if (s.parent[i] != ground) Sixth<T>(f + 6 * s.parent[i]) -= force;
  }
  const T* const of_row = x + 6 * s.bodies();
  for (const Part& p : parts_) {
    Sixth<T>(f + 6 * p.body) += k_[p.first] * of_row[p.row];
    if (p.parent != ground) Sixth<T>(f + 6 * p.parent) -= k_[p.first] * of_row[p.row];
  }
}

template <class T> void MaximalFree<T>::add_torques(const T* tau, T* f) const {
  const Structure& s = *this->structure();
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      Sixth<T>(f + 6 * i) += pseudo_inverse_[k] * tau[k];
      if (s.parent[i] != ground) Sixth<T>(f + 6 * s.parent[i]) -= pseudo_inverse_[k] * tau[k];
    }
}

template <class T> void MaximalFree<T>::accelerations(const T* f, T* a) const {
  for (Index i = 0; i < this->structure()->bodies(); ++i) Sixth<T>(a + 6 * i) = H_inverse_[i] * ConstSixth<T>(f + 6 * i);
}

template <class T> void MaximalFree<T>::rates(const T* a, T* y) const {
  const Structure& s = *this->structure();
  for (Index i = 0; i < s.bodies(); ++i) {
    Vector6<T> relative = ConstSixth<T>(a + 6 * i);
    if (s.parent[i] != ground) relative -= ConstSixth<T>(a + 6 * s.parent[i]);
    Sixth<T>(y + 6 * i) = joint_[i].transpose() * relative;
  }
  T* const of_row = y + 6 * s.bodies();
  std::fill(of_row, of_row + s.rows, T(0));
  for (const Part& p : parts_) {
    of_row[p.row] += k_[p.first].dot(ConstSixth<T>(a + 6 * p.body));
    if (p.parent != ground) of_row[p.row] -= k_[p.first].dot(ConstSixth<T>(a + 6 * p.parent));
  }
}

template <class T> void MaximalFree<T>::multiply(const T* x, T* y, T* bodies) const {
  const Structure& s = *this->structure();
  T *const f = bodies, *const a = f + 6 * s.bodies();
  std::fill(f, f + 6 * s.bodies(), T(0));
  add_forces(x, f);
  accelerations(f, a);
  rates(a, y);
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = 0; k < s.dofs(i); ++k) y[6 * i + k] += compliance_[s.first_dof[i] + k] * x[6 * i + k];
  T *const of_row = y + 6 * s.bodies(), *const damped = bodies;
  damping_.multiply(x + 6 * s.bodies(), damped);
  for (Index r = 0; r < s.rows; ++r) of_row[r] += damped[r];
  damping_.switch_off(of_row);
}

template <class T> void MaximalFree<T>::precondition(const T* r, T* z) const {
  const Structure& s = *this->structure();
  std::copy(r, r + unknowns(), z);
  for (Index i = 0; i < s.bodies(); ++i) ldlt_solve(joint_block_[i].data(), 6, 6, z + 6 * i);
  T* const of_row = z + 6 * s.bodies();
  for (Index k = 0; k < s.rows; ++k) of_row[k] = of_row[k] * diagonal_[k];
}

template <class T> void MaximalFree<T>::iterate(T* r, T* x, T* work) const {
  const Index n = unknowns(), most = std::min<Index>(max_iterations, 10 * n + 50);
  T *const z = work, *const p = z + padded(n), *const q = p + padded(n), *const bodies = q + padded(n);
  std::fill(x, x + n, T(0));
  precondition(r, z);
  std::copy(z, z + n, p);
  T rz = inner(r, z, n);
  const T enough = rz * T(0x1p-80);
  for (Index k = 0; k < most && rz > enough; ++k) {
    multiply(p, q, bodies);
    const T pq = inner(p, q, n);
    if (!ScalarTraits<T>::usable_pivot(pq)) return;  // p in the null space, or not finite
    const T alpha = rz / pq;
    for (Index i = 0; i < n; ++i) x[i] += p[i] * alpha;
    for (Index i = 0; i < n; ++i) r[i] -= q[i] * alpha;
    precondition(r, z);
    const T next = inner(r, z, n), beta = next / rz;
    for (Index i = 0; i < n; ++i) p[i] = z[i] + p[i] * beta;
    rz = next;
  }
}

template <class T> void MaximalFree<T>::correct(const T* r1, const T* r2, T* d_nu, T* d_lambda, T* work) const {
  const Structure& s = *this->structure();
  const Index n = unknowns(), b = 6 * s.bodies();
  T *const h = work, *const a = h + padded(b), *const r = a + padded(b), *const x = r + padded(n), *const rest = x + padded(n);
  std::fill(h, h + b, T(0));
  if (r1 != nullptr) add_torques(r1, h);
  accelerations(h, a);
  rates(a, r);
  for (Index k = 0; k < b; ++k) r[k] = -r[k];
  for (Index k = 0; k < s.rows; ++k) r[b + k] = r2[k] - r[b + k];
  damping_.switch_off(r + b);
  iterate(r, x, rest);
  add_forces(x, h);
  accelerations(h, a);
  for (Index i = 0; i < s.bodies(); ++i) {
    Vector6<T> relative = ConstSixth<T>(a + 6 * i);
    if (s.parent[i] != ground) relative -= ConstSixth<T>(a + 6 * s.parent[i]);
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) d_nu[k] = pseudo_inverse_[k].dot(relative);
  }
  std::copy(x + b, x + n, d_lambda);
}

template <class T>
Report MaximalFree<T>::solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const {
  if (!factored_.ok()) return factored_;
  return refinement_.solve(asked, f, wanted, {max_steps, true}, [this](auto... args) { correct(args...); }, work, nu);
}

template <class T> Index MaximalFree<T>::do_workspace(Index) const {
  const Index bodies = padded(6 * this->structure()->bodies());
  return refinement_.workspace(2 * bodies + 5 * padded(unknowns()) + std::max(2 * bodies, padded(this->size())));
}

template <class T> Index MaximalFree<T>::do_bytes() const {
  return refinement_.bytes() + damping_.bytes() +
         static_cast<Index>(parts_.size() * sizeof(Part) + (k_.size() + pseudo_inverse_.size()) * sizeof(Vector6<T>) +
                            (H_inverse_.size() + joint_.size() + joint_block_.size()) * sizeof(Matrix6<T>) + (compliance_.size() + of_rows_.size() + diagonal_.size()) * sizeof(T));
}

#ifdef DELASSUS_EXACT
template class MaximalFree<Counted>;
#else
template class MaximalFree<double>;
#endif

}  // namespace delassus
