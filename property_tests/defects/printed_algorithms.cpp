#include "algorithms/kit/test_scalars.h"
#include "property_tests/defects/printed_algorithms.h"

#include "reference/definition.h"

namespace delassus::paper {

template <class T> MatrixX<T> Transcription<T>::S(Index i) const {
  Matrix m(6, s_.dofs(i));
  for (Index c = 0; c < m.cols(); ++c) m.col(c) = p_.S[s_.first_dof[i] + c];
  return m;
}

template <class T> MatrixX<T> Transcription<T>::joint_K(const Structure::JointConstraint& j) const {
  Matrix m(j.rows, s_.dofs(j.body));
  for (Index r = 0; r < m.rows(); ++r)
    for (Index c = 0; c < m.cols(); ++c) m(r, c) = p_.joint_K[j.first + r * m.cols() + c];
  return m;
}

template <class T>
MatrixX<T> Transcription<T>::K(const Structure::LinkConstraint& e, const Structure::Attachment& link) const {
  Matrix m(e.rows, 6);
  for (Index r = 0; r < e.rows; ++r) m.row(r) = p_.K[link.first + r].transpose();
  return m;
}

// Alg. 1, lines 2–6, merged: f_i from the constraint forces; u_i starts as τ_i = 𝒦ᵢᵀ λ_i.
template <class T> void Transcription<T>::start(const VectorX<T>& lambda, bool wrong_sign) {
  const Index n = s_.bodies();
  H_.clear();
  N_.assign(static_cast<std::size_t>(n), {});
  f_.assign(static_cast<std::size_t>(n), Matrix::Zero(6, 1));
  u_.clear();
  D_.clear();
  for (Index i = 0; i < n; ++i) {
    H(i, i) = p_.H[i];
    u_.push_back(Matrix::Zero(s_.dofs(i), 1));
    D_.push_back(Matrix::Zero(s_.dofs(i), s_.dofs(i)));
    for (Index c = 0; c < s_.dofs(i); ++c) D_[i](c, c) = p_.armature[s_.first_dof[i] + c];
  }
  U_ = D_;
  a_ = f_;
  for (const auto& e : s_.link_constraints)
    for (const auto& link : e.links) {
      const Matrix force = K(e, link).transpose() * lambda.segment(e.row, e.rows);
      f_[link.body] = wrong_sign ? Matrix(f_[link.body] + force) : Matrix(f_[link.body] - force);
    }
  for (const auto& j : s_.joint_constraints) u_[j.body] += joint_K(j).transpose() * lambda.segment(j.row, j.rows);
}

template <class T> void Transcription<T>::couple() {
  for (const auto& e : s_.link_constraints)
    for (const auto& i : e.links) {
      const Matrix Re = R(e.row, e.rows);
      H(i.body, i.body) += K(e, i).transpose() * Re * K(e, i);  // line 4
      for (const auto& j : e.links) {
        if (i.body == j.body) continue;
        N_[i.body].insert(j.body);  // line 8
        if (is(Printed::line_9_transposed)) H(i.body, j.body) += K(e, j).transpose() * Re * K(e, i);
        else H(i.body, j.body) += K(e, i).transpose() * Re * K(e, j);
      }
    }
}

template <class T> void Transcription<T>::joint_weights() {
  if (is(Printed::line_14_no_armature))
    for (Matrix& D : D_) D.setZero();
  for (const auto& j : s_.joint_constraints) {
    const Matrix weight = joint_K(j).transpose() * R(j.row, j.rows) * joint_K(j);
    if (is(Printed::line_11_assigned)) {
      D_[j.body] = weight;
      for (Index c = 0; c < weight.rows(); ++c) D_[j.body](c, c) += p_.armature[s_.first_dof[j.body] + c];
    } else {
      D_[j.body] += weight;
    }
  }
}

template <class T> void Transcription<T>::fill(Index i) {
  std::set<Index> q = N_[i];
  if (s_.parent[i] != ground) q.insert(s_.parent[i]);
  for (const Index j : q) {
    N_[j].erase(i);
    for (const Index k : q)
      if (k != j) N_[j].insert(k);
  }
}

template <class T> bool Transcription<T>::eliminate(Index i) {
  const Index pi = s_.parent[i], n = s_.dofs(i);
  const Matrix Si = S(i), Hii = H(i, i);
  u_[i] -= Si.transpose() * f_[i];  // line 13
  U_[i] = Hii * Si;                 // line 14
  D_[i] += Si.transpose() * U_[i];
  const reference::PivotedLdlt<T> factor(D_[i]);
  if (!factor.regular()) return false;
  D_[i] = n == 0 ? Matrix(0, 0) : factor.inverse();
  const Matrix& D = D_[i];                                                          // D⁻¹ from here on
  const Matrix P = Matrix::Identity(6, 6) - U_[i] * D * Si.transpose();             // line 15
  fill(i);                                                                          // lines 16–20
  for (const Index j : N_[i]) {
    const Matrix Hij = H(i, j), Hji = H(j, i);
    if (pi != ground) {
      const Matrix moved = is(Printed::line_22_right_factor) ? Matrix(Hij * P.transpose()) : Matrix(P * Hij);
      H(pi, j) += moved;  // line 22
      if (j != pi && !is(Printed::line_22_one_sided)) H(j, pi) = H(pi, j).transpose();
    }
    const Matrix force = is(Printed::line_23_transposed) ? Hij : Hji;
    f_[j] += force * Si * D * u_[i];  // line 23
    H(j, j) -= (is(Printed::line_24_transposed) ? Hij : Hji) * Si * D * Si.transpose() * Hij;  // line 24
    for (const Index k : N_[i])
      if (k > j) {
        const Matrix left = is(Printed::line_26_transposed) ? H(i, k) : H(k, i);
        H(k, j) -= left * Si * D * Si.transpose() * Hij;  // line 26
        H(j, k) = H(k, j).transpose();                    // line 27
      }
    if (j == pi) {  // line 29
      const Matrix moved = is(Printed::line_29_transposed) ? Matrix(Hij * P.transpose()) : Matrix(P * Hij);
      H(pi, pi) += moved.transpose();
    }
  }
  if (pi != ground) {
    const Matrix correction = U_[i] * D * u_[i];
    f_[pi] += is(Printed::line_31_sign) ? Matrix(f_[i] - correction) : Matrix(f_[i] + correction);  // line 31
    H(pi, pi) += Hii - U_[i] * D * U_[i].transpose();                                               // line 32
  }
  return true;
}

template <class T> bool Transcription<T>::backward() {
  for (Index i = s_.bodies(); i-- > 0;)
    if (!eliminate(i)) return false;
  return true;
}

template <class T> VectorX<T> Transcription<T>::forward() {
  for (Index i = 0; i < s_.bodies(); ++i) {
    const Matrix Si = S(i);
    for (const Index j : N_[i]) {  // line 35
      if (is(Printed::line_35_subspace)) {
        if (s_.dofs(i) != s_.dofs(j)) return {};
        u_[i] -= (H(i, j) * S(j)).transpose() * a_[j];
      } else if (is(Printed::line_35_transposed)) {
        u_[i] -= (H(i, j) * Si).transpose() * a_[j];
      } else {
        u_[i] -= (H(j, i) * Si).transpose() * a_[j];
      }
    }
    const Matrix ap = s_.parent[i] == ground ? Matrix(Matrix::Zero(6, 1)) : a_[s_.parent[i]];
    u_[i] = D_[i] * (u_[i] - U_[i].transpose() * ap);  // line 36: ν_i
    a_[i] = ap + Si * u_[i];                           // line 37
  }
  VectorX<T> y = VectorX<T>::Zero(s_.rows);  // Alg. 3, lines 4–8
  for (const auto& e : s_.link_constraints)
    for (const auto& link : e.links) y.segment(e.row, e.rows) += K(e, link) * a_[link.body];
  for (const auto& j : s_.joint_constraints) y.segment(j.row, j.rows) += joint_K(j) * u_[j.body];
  return y;
}

template <class T> VectorX<T> Transcription<T>::apply(const VectorX<T>& lambda) {
  start(lambda, is(Printed::merged_apply_sign));
  if (is(Printed::alg2_no_armature))
    for (Matrix& D : D_) D.setZero();
  return backward() ? forward() : VectorX<T>();
}

template <class T> VectorX<T> Transcription<T>::solve(const VectorX<T>& a) {
  const VectorX<T> compliant = R_ * a;
  start(compliant, is(Printed::merged_solve_sign));
  couple();
  joint_weights();
  if (!backward()) return {};
  const VectorX<T> motion = forward();
  return motion.size() == 0 ? motion : VectorX<T>(compliant - R_ * motion);
}

template class Transcription<Quad>;
template class Transcription<Rational>;

}  // namespace delassus::paper
