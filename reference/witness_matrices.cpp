#include "algorithms/kit/test_scalars.h"
#include "reference/witness_matrices.h"

#include "reference/definition.h"

namespace delassus::reference {
namespace witness {
namespace {

Real33 crossing(const Real3& a) {
  Real33 K;
  K << Quad(0), -a[2], a[1], a[2], Quad(0), -a[0], -a[1], a[0], Quad(0);
  return K;
}

MatrixX<Quad> magnitudes(MatrixX<Quad> X) {
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) X(i, j) = abs(X(i, j));
  return X;
}

}  // namespace

Transform operator*(const Transform& a, const Transform& b) { return {Real33(a.R * b.R), Real3(a.R * b.p + a.p)}; }
Transform inverse(const Transform& x) { return {Real33(x.R.transpose()), Real3(-(x.R.transpose() * x.p))}; }

Real3 wide(const Triple& x) { return {Quad(x[0]), Quad(x[1]), Quad(x[2])}; }
Quad length(const Real3& x) { return sqrt(Quad(x.dot(x))); }

Real33 turned(const Real3& axis, const Quad& t) {
  const Real33 K = crossing(axis);
  return Real33::Identity() + sin(t) * K + (Quad(1) - cos(t)) * Real33(K * K);
}

Real33 of_rpy(const Triple& rpy) {
  return turned(Real3(0, 0, 1), rpy[2]) * turned(Real3(0, 1, 0), rpy[1]) * turned(Real3(1, 0, 0), rpy[0]);
}

Real33 of_quaternion(const Quad& w, const Real3& v) {
  const Quad n = w * w + v.dot(v);
  const Real33 K = crossing(v);
  return Real33::Identity() + (Quad(2) / n) * Real33(w * K + K * K);
}

void add_link(const Solid& solid, const Placed& at, const std::vector<Freedom>& freedoms, MatrixX<Quad>& M, MatrixX<Quad>& bound) {
  const Transform X = at.X * solid.centre;
  const Quad reach = at.reach + length(solid.centre.p), mass(solid.mass);
  const auto& v = solid.inertia;
  Real33 I;
  I << Quad(v[0]), Quad(v[1]), Quad(v[2]), Quad(v[1]), Quad(v[3]), Quad(v[4]), Quad(v[2]), Quad(v[4]), Quad(v[5]);
  const Real33 world = X.R * I * X.R.transpose();
  Quad size(0);
  for (Index k = 0; k < 9; ++k) size += I(k / 3, k % 3) * I(k / 3, k % 3);
  size = sqrt(size);
  for (const Index a : at.freedoms) {
    const Freedom& fa = freedoms[static_cast<std::size_t>(a)];
    const Real3 va = fa.v + fa.w.cross(Real3(X.p - fa.o)), Ia = world * fa.w;
    const Quad ba = fa.turns ? reach + fa.reach : Quad(1);
    for (const Index b : at.freedoms) {
      const Freedom& fb = freedoms[static_cast<std::size_t>(b)];
      const Real3 vb = fb.v + fb.w.cross(Real3(X.p - fb.o));
      M(a, b) += mass * va.dot(vb) + Ia.dot(fb.w);
      bound(a, b) += at.steps * (abs(mass) * ba * (fb.turns ? reach + fb.reach : Quad(1)) + (fa.turns && fb.turns ? size : Quad(0)));
    }
  }
}

void add_weld(const Placed& at, const std::vector<Freedom>& freedoms, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound) {
  for (const Index a : at.freedoms) {
    const Freedom& f = freedoms[static_cast<std::size_t>(a)];
    const Real3 angular = at.X.R.transpose() * f.w;
    const Real3 linear = at.X.R.transpose() * Real3(f.v + f.w.cross(Real3(at.X.p - f.o)));
    for (Index k = 0; k < 3; ++k) {
      J(r + k, a) += angular[k], J(r + 3 + k, a) += linear[k];
      bound(r + k, a) += f.turns ? at.steps : Quad(0), bound(r + 3 + k, a) += at.steps * (f.turns ? at.reach + f.reach : Quad(1));
    }
  }
}

void couple(WitnessMatrices& out) {
  const PivotedLdlt<Quad> factor(out.M);
  out.regular = factor.regular();
  if (!out.regular) return;
  const MatrixX<Quad> X = factor.solve(out.J.transpose()), size = magnitudes(X);
  out.A0 = product(out.J, X);
  const MatrixX<Quad> of_J = product(out.J_bound, size);
  const MatrixX<Quad> both = out.J_bound + product(MatrixX<Quad>(size.transpose()), out.M_bound);
  const MatrixX<Quad> second = product(both, product(magnitudes(factor.inverse()), MatrixX<Quad>(both.transpose())));
  out.A_bound = MatrixX<Quad>(of_J.transpose()) + product(both, size) + Quad(unit_roundoff<double>) * second;
}

}  // namespace witness
}  // namespace delassus::reference
