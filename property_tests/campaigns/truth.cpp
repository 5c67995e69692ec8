#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/delassus.h"

namespace delassus::laws {
namespace {

constexpr Index most_dofs = 100, most_rows = 150;

/// J M⁻¹Jᵀ, column by column.
MatrixX<Quad> swept(const Problem<double>& problem) {
  const auto op = find_operator("aba_sweep").make<Quad>();
  const Index m = problem.structure->rows;
  op->analyze(problem.structure);
  const Report updated = op->update(problem.cast<Quad>(), Damping<Quad>::uniform(m, Quad(0)));
  if (!updated.ok()) throw std::runtime_error("M is singular in Quad");
  Workspace<Quad> work(op->workspace());
  MatrixX<Quad> A0(m, m), unit = MatrixX<Quad>::Zero(m, 1), column = unit;
  for (Index c = 0; c < m; ++c) {
    unit(c, 0) = Quad(1);
    static_cast<void>(op->apply(unit, column, work));
    A0.col(c) = column;
    unit(c, 0) = Quad(0);
  }
  return A0;
}

Quad largest(const VectorX<Quad>& x) {
  Quad most(0);
  for (Index r = 0; r < x.size(); ++r) most = std::max(most, abs(Quad(x[r])));
  return most;
}

double relative(const Quad& error, const Quad& size) {
  return error == Quad(0) ? 0 : static_cast<double>(error / size);
}

VectorX<Quad> quad(const VectorX<double>& x) {
  VectorX<Quad> y(x.size());
  for (Index r = 0; r < x.size(); ++r) y[r] = Quad(x[r]);
  return y;
}

VectorX<Quad> times(const MatrixX<Quad>& B, const VectorX<Quad>& x) { return reference::product<Quad>(B, MatrixX<Quad>(x)); }

/// κ_∞ of a positive definite matrix brought to unit diagonal.
double scaled_condition(const MatrixX<Quad>& B) {
  const MatrixX<Quad> inverse = reference::PivotedLdlt<Quad>(B).inverse();
  Quad of_B(0), of_inverse(0);
  for (Index r = 0; r < B.rows(); ++r) {
    Quad sum(0), inverse_sum(0);
    for (Index c = 0; c < B.cols(); ++c) {
      const Quad scale = sqrt(B(r, r) * B(c, c));
      sum += abs(Quad(B(r, c))) / scale;
      inverse_sum += abs(Quad(inverse(r, c))) * scale;
    }
    of_B = std::max(of_B, sum);
    of_inverse = std::max(of_inverse, inverse_sum);
  }
  return static_cast<double>(of_B * of_inverse);
}

}  // namespace

Quad norm(const MatrixX<Quad>& B, const VectorX<Quad>& x) {
  const VectorX<Quad> y = times(B, x);
  Quad sum(0);
  for (Index r = 0; r < x.size(); ++r) sum += x[r] * y[r];
  return sum > Quad(0) ? sqrt(sum) : Quad(0);
}

MatrixX<Quad> entrywise(const MatrixX<Quad>& X) {
  MatrixX<Quad> Y(X.rows(), X.cols());
  for (Index c = 0; c < X.cols(); ++c)
    for (Index r = 0; r < X.rows(); ++r) Y(r, c) = abs(Quad(X(r, c)));
  return Y;
}

Truth::Truth(const Problem<double>& problem, const Damping<double>& damping) {
  const Structure& s = *problem.structure;
  if (s.dofs() <= most_dofs && s.rows <= most_rows) {
    dense_ = reference::dense(problem.cast<Quad>(), damping.cast<Quad>());
    A0_ = dense_->A0;
    A_ = dense_->A();
    factor_.emplace(reference::factorise(*dense_));
  } else {
    A0_ = swept(problem);
    A_ = A0_ + reference::damping_matrix(s, damping.cast<Quad>());
    factor_.emplace(A_);
  }
}

VectorX<Quad> Truth::solve(const VectorX<double>& a) const { return factor_->solve(MatrixX<Quad>(quad(a))); }

VectorX<double> Truth::reachable(const VectorX<double>& x) const {
  VectorX<Quad> y = times(A0_, quad(x));
  while (largest(y) > Quad(0x1p1000)) y *= Quad(0x1p-100);
  VectorX<double> a(x.size());
  for (Index r = 0; r < x.size(); ++r) a[r] = static_cast<double>(y[r]);
  return a;
}

Quad Truth::energy(const VectorX<Quad>& x) const { return norm(A_, x); }

double Truth::rounding(const VectorX<Quad>& lambda) const {
  const Quad least(Quad(0x1p-1074) / Quad(2));
  VectorX<Quad> e = entrywise(MatrixX<Quad>(lambda));
  for (Quad& x : e) x = std::max(Quad(Quad(unit_roundoff<double>) * x), least);
  return relative(norm(entrywise(A_), e), energy(lambda));
}

double Truth::violation(double error, double bound, double rounding) const {
  if (error <= bound + rounding) return 0;
  if (!dense_ || !(bound > 0)) return std::numeric_limits<double>::infinity();
  const bool damped = reference::PivotedLdlt<Quad>(dense_->R_inverse).regular();
  const double of_rows = damped ? scaled_condition(dense_->R_inverse) : std::sqrt(scaled_condition(A_));
  const double condition = std::max(scaled_condition(dense_->M), of_rows);
  return (error - bound - rounding) / (unit_roundoff<double> * condition * bound);
}

Errors Truth::errors(const VectorX<double>& a, const VectorX<Quad>& lambda, const VectorX<double>& answer) const {
  const VectorX<Quad> given = quad(answer), error = given - lambda, residual = quad(a) - times(A_, given);
  Quad norm_A(0);
  for (Index r = 0; r < A_.rows(); ++r) {
    Quad sum(0);
    for (Index c = 0; c < A_.cols(); ++c) sum += abs(Quad(A_(r, c)));
    norm_A = std::max(norm_A, sum);
  }
  return {relative(largest(error), largest(lambda)), relative(norm(A0_, error), norm(A0_, lambda)),
          relative(energy(error), energy(lambda)),
          relative(largest(residual), norm_A * largest(given) + largest(quad(a)))};
}

}  // namespace delassus::laws
