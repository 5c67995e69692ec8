// (K)  M δν − Jᵀδλ = r₁,  J δν + R⁻¹δλ = r₂  by the definition. Used by one_solve*.cpp only.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {

template <class T> [[nodiscard]] MatrixX<T> transposed(const MatrixX<T>& A) { return A.transpose(); }

template <class T> struct Sides {
  MatrixX<T> r1, r2;  // or the answer: δν, δλ
};

/// M, J and R⁻¹ of the definition.
template <class X> struct System {
  MatrixX<X> M, J, R_inverse;

  System(const Problem<X>& p, const Damping<X>& d)
      : M(reference::mass_matrix(p)), J(reference::constraint_jacobian(p)), R_inverse(reference::damping_matrix(*p.structure, d)) {}
  /// Right-hand side of (K).
  [[nodiscard]] Sides<X> image(const Sides<X>& x) const {
    return {reference::product<X>(M, x.r1) - reference::product<X>(transposed(J), x.r2), reference::product<X>(J, x.r1) + reference::product<X>(R_inverse, x.r2)};
  }
};

[[nodiscard]] inline Quad largest(const MatrixX<Quad>& x) { return x.size() == 0 ? Quad(0) : Quad(magnitude(x).maxCoeff()); }

/// |A| · (largest |x|), row by row.
[[nodiscard]] inline MatrixX<Quad> terms(const MatrixX<Quad>& A, const MatrixX<Quad>& x) { return MatrixX<Quad>(magnitude(A).rowwise().sum()) * largest(x); }

/// How far x is from solving (K), against the sizes of its terms: those of the row where `by_row`, else of the largest row.
[[nodiscard]] inline Verdict residual(const System<Quad>& s, const Sides<Quad>& right, const Sides<Quad>& x, bool by_row, double eps) {
  const Sides<Quad> got = s.image(x);
  MatrixX<Quad> one = terms(s.M, x.r1) + terms(transposed(s.J), x.r2) + magnitude(right.r1);
  MatrixX<Quad> two = terms(s.J, x.r1) + terms(s.R_inverse, x.r2) + magnitude(right.r2);
  one.setConstant(largest(one));
  if (!by_row) two.setConstant(largest(two));
  return worst(judge(got.r1 - right.r1, one, eps, "terms"), judge(got.r2 - right.r2, two, eps, "terms"));
}

template <class T> [[nodiscard]] Sides<Quad> quad(const Sides<T>& x) { return {converted<Quad>(x.r1), converted<Quad>(x.r2)}; }

}  // namespace delassus::laws
