// Bounds for operators on a problem that kinematics has just filled, against numbers from outside.
//
// The formulas of reference/sensitivity.h, with the data's absolute values replaced by what a rounding error of
// kinematics is relative to: a rotated vector errs by eps of its length, a position by eps of the lengths added up to it
// along its path (ℓ_i for body i, from its tree's reference point):
//   S_i   1 for directions, ℓ_i for moments
//   K_e^i 1 for directions, ℓ_i + the offset of the frame for moments
//   H_i   largest moment + m c_i², m c_i, m, with c_i = ℓ_i + |com|, and zero for a root
// An entry that is zero at a random configuration is zero at every one, and stays zero.
#pragma once

#include "algorithms/delassus.h"
#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"
#include "reference/lagrangian.h"

namespace delassus::unit {

/// ℓ_i [m].
inline std::vector<double> path_lengths(const Model& model, const VectorX<double>& q) {
  std::vector<double> out;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& b = model.bodies[i];
    if (b.parent == ground) out.push_back(b.com.norm());
    else {
      const double slide = b.joint.type == JointType::prismatic ? std::fabs(q[model.first_q[i]]) : 0;
      out.push_back(out[static_cast<std::size_t>(b.parent)] + b.joint.placement.translation.norm() + slide);
    }
  }
  return out;
}

/// |entry| replaced by `size` where it is smaller and not zero.
template <class Block> void widen(Block&& block, double size) {
  block = block.unaryExpr([=](double x) { return x == 0 ? 0 : std::max(std::fabs(x), size); }).eval();
}

/// The problem with its numbers replaced as said above. `q` as the library orders it.
inline Problem<double> widened(const Model& model, const VectorX<double>& q, Problem<double> p) {
  const std::vector<double> path = path_lengths(model, q);
  const Structure& s = *p.structure;
  for (Index i = 0; i < s.bodies(); ++i) {
    const Body& b = model.bodies[static_cast<std::size_t>(i)];
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      const bool turns = !p.S[k].head<3>().isZero(0);
      widen(p.S[k].head<3>(), 1);
      widen(p.S[k].tail<3>(), turns ? path[i] : 1);
    }
    const double c = b.parent == ground ? 0 : path[i] + b.com.norm();
    widen(p.H[i].topLeftCorner<3, 3>(), b.inertia.cwiseAbs().maxCoeff() + b.mass * c * c);
    widen(p.H[i].topRightCorner<3, 3>(), b.mass * c);
    widen(p.H[i].bottomLeftCorner<3, 3>(), b.mass * c);
  }
  std::vector<double> frame(path.size(), 0);  // the largest offset of a frame on each body
  for (const Constraint& c : model.constraints)
    for (const Frame* f : {&c.a, &c.b})
      if (f->body != ground) frame[f->body] = std::max(frame[f->body], f->placement.translation.norm());
  for (const auto& e : s.link_constraints)
    for (const auto& l : e.links)
      for (Index r = l.first; r < l.first + e.rows; ++r) {
        const bool moves = !p.K[r].tail<3>().isZero(0);
        widen(p.K[r].head<3>(), moves ? path[l.body] + frame[l.body] : 1);
        widen(p.K[r].tail<3>(), moves ? 1 : 0);
      }
  for (auto& k : p.joint_K) k = std::fabs(k);
  return p;
}

class LagrangianBounds {
  using Matrix = MatrixX<double>;
  using Vector = VectorX<double>;

 public:
  /// `p`: the widened problem.
  LagrangianBounds(const reference::lagrangian::Numbers& exact, const Problem<double>& p, const std::vector<double>& R_inverse) {
    J_ = reference::constraint_jacobian(p);
    M_ = reference::mass_matrix(p);
    R_inverse_ = Eigen::Map<const Vector>(R_inverse.data(), static_cast<Index>(R_inverse.size()));

    const MatrixX<Quad> M = exact.M(), J = exact.J();
    MatrixX<Quad> A = exact.lambda_inverse();
    R_.resize(A.rows());
    for (Index i = 0; i < A.rows(); ++i) {
      R_[i] = Quad(1) / Quad(R_inverse[static_cast<std::size_t>(i)]);
      A(i, i) += Quad(R_inverse[static_cast<std::size_t>(i)]);
    }
    const MatrixX<Quad> RJ = R_.asDiagonal() * J;
    J_exact_ = J;
    MR_inverse_ = reference::PivotedLdlt<Quad>(M + reference::product<Quad>(J.transpose(), RJ)).inverse();
    M_inverse_abs_ = magnitude(reference::PivotedLdlt<Quad>(M).inverse());
    A_inverse_abs_ = magnitude(reference::PivotedLdlt<Quad>(A).inverse());
    A_norm_ = norm(magnitude(A));
  }

  /// Bound on the error of an operator's y = A x or y = A⁻¹ x. Shapes m.
  [[nodiscard]] Vector of(const OperatorRow& row, bool solve, const Vector& x, const Vector& y) const {
    if (!solve) return apply(x);
    if (row.solve_error == ErrorClass::normwise)
      return Vector::Constant(x.size(), norm(A_inverse_abs_) * (A_norm_ * norm(y) + norm(apply(y)) + norm(x)));
    const Vector b = A_inverse_abs_ * (apply(y) + x.cwiseAbs());
    return row.solve_error == ErrorClass::amplified ? b + amplified(x) : b;
  }

 private:
  static Matrix magnitude(const MatrixX<Quad>& x) {
    return x.unaryExpr([](const Quad& v) { return std::fabs(static_cast<double>(v)); });
  }
  static double norm(const Matrix& X) { return X.cwiseAbs().rowwise().sum().maxCoeff(); }

  [[nodiscard]] Vector apply(const Vector& x) const {
    const Vector rate = M_inverse_abs_ * (J_.transpose() * x.cwiseAbs());
    return J_ * (rate + M_inverse_abs_ * (M_ * rate)) + R_inverse_.cwiseProduct(x.cwiseAbs());
  }
  [[nodiscard]] Vector amplified(const Vector& a) const {
    MatrixX<Quad> Ra(a.size(), 1);
    for (Index i = 0; i < a.size(); ++i) Ra(i, 0) = R_[i] * Quad(a[i]);
    const Matrix nu = magnitude(reference::product<Quad>(MR_inverse_, reference::product<Quad>(J_exact_.transpose(), Ra)));
    const Vector R = magnitude(R_), force = magnitude(Ra);
    const Matrix RJ = R.asDiagonal() * J_, MR = M_ + J_.transpose() * RJ;
    const Vector of_rate = magnitude(MR_inverse_) * (MR * nu + J_.transpose() * force);
    return R.cwiseProduct(a.cwiseAbs() + J_ * (nu + of_rate));
  }

  Matrix J_, M_, M_inverse_abs_, A_inverse_abs_;
  Vector R_inverse_;
  VectorX<Quad> R_;
  MatrixX<Quad> J_exact_, MR_inverse_;
  double A_norm_ = 0;
};

}  // namespace delassus::unit
