#include "algorithms/kit/test_scalars.h"
#include "reference/definition.h"
#include "reference/kkt_cholmod.h"
#include "reference/maximal.h"
#include "reference/reference.h"
#include "reference/zeros.h"

namespace delassus::reference {

namespace {

MatrixX<Quad> quad(const MatrixX<double>& X) {
  MatrixX<Quad> Y(X.rows(), X.cols());
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) Y(i, j) = Quad(X(i, j));
  return Y;
}

using P = const Problem<double>&;
using Damped = const Damping<double>&;
using Sides = const MatrixX<double>&;

bool definition_trusts(P p, Damped) { return p.structure->dofs() <= 250 && p.structure->rows <= 400; }
MatrixX<Quad> definition_apply(P p, Damped d, Sides f) { return dense_apply(dense(p.cast<Quad>(), d.cast<Quad>()), quad(f)); }
MatrixX<Quad> definition_solve(P p, Damped d, Sides a) { return dense_solve(dense(p.cast<Quad>(), d.cast<Quad>()), quad(a)); }

bool maximal_trusts(P p, Damped) {
  const Structure& s = *p.structure;
  return 12 * s.bodies() + s.dofs() + s.rows <= 600;
}
MatrixX<Quad> maximal_row_apply(P p, Damped d, Sides f) {
  MatrixX<Quad> a = maximal_apply(p.cast<Quad>(), d.cast<Quad>(), quad(f));
  Zeros(p, d).clear_apply(f, a);
  return a;
}
MatrixX<Quad> maximal_row_solve(P p, Damped d, Sides a) {
  MatrixX<Quad> f = maximal_solve(p.cast<Quad>(), d.cast<Quad>(), quad(a));
  Zeros(p, d).clear_solve(a, f);
  return f;
}

MatrixX<Quad> cholmod_row_apply(P p, Damped d, Sides f) {
  MatrixX<Quad> a = kkt_cholmod_apply(p, d, f);
  Zeros(p, d).clear_apply(f, a);
  return a;
}
MatrixX<Quad> cholmod_row_solve(P p, Damped d, Sides a) {
  MatrixX<Quad> f = kkt_cholmod_solve(p, d, a);
  Zeros(p, d).clear_solve(a, f);
  return f;
}

}  // namespace

const std::vector<ReferenceRow>& references() {
  static const std::vector<ReferenceRow> table{
      {"definition", "dense M, J, A from body Jacobians, LDLᵀ with diagonal pivoting, in Quad",
       "up to 250 degrees of freedom and 400 rows (cost); M regular; solve: A regular, otherwise it throws",
       unit_roundoff<Quad>, definition_trusts, definition_apply, definition_solve},
      {"maximal", "every joint a constraint: one dense LU of the maximal-coordinate system, in Quad",
       "up to 600 unknowns 12 N + n + m (cost); M regular; solve: A regular, otherwise it throws",
       unit_roundoff<Quad>, maximal_trusts, maximal_row_apply, maximal_row_solve},
      {"kkt_cholmod", "the maximal-coordinate system, sparse: CHOLMOD's LDLᵀ in double, refined with residuals in Quad",
       "10⁴ bodies and more; not with massless bodies, redundant undamped rows, or beyond 10¹⁰ operations",
       unit_roundoff<double>, kkt_cholmod_trusts, cholmod_row_apply, cholmod_row_solve},
  };
  return table;
}

}  // namespace delassus::reference
