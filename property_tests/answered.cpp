#include "property_tests/answered.h"

namespace delassus::laws {
namespace {

/// Largest error / (eps · bound of the operator's error class); −1: no bound.
double law_ratio(const OperatorRow& row, const Question& q, const MatrixX<double>& f) {
  if (why_no_bound(Function::solve, q.c)) return -1;
  const MatrixX<Quad> error = converted<Quad>(f) - MatrixX<Quad>(q.lambda);
  return judge(error, error_bound(Function::solve, row, q.c, q.a), unit_roundoff<double>, "").ratio;
}

std::string broken_promise(const OperatorRow& row, const Question& q, const Answered& given, const MatrixX<double>& f) {
  const Report& r = given.report;
  const bool answer = r.ok() || r.status == Status::not_converged;
  if (!answer) return f.array().isNaN().all() ? "" : "numbers in an answer called " + std::string(name(r.status));
  if (r.ok() && !given.finite) return "NaN in an answer called ok";
  if (!q.truth) return "";
  const double error = given.errors.energy;
  if (r.error_bound >= 0 && !(q.truth->violation(error, r.error_bound, q.truth->rounding(q.lambda)) < pass_below))
    return "error " + std::to_string(error) + " above the bound " + std::to_string(r.error_bound);
  if (!r.ok()) return "";
  const double ratio = law_ratio(row, q, f);
  return ratio < pass_below ? "" : "error / (eps · bound) = " + std::to_string(ratio);
}

}  // namespace

Answered answered(const OperatorRow& row, const Question& q) {
  Answered given;
  const auto op = row.make<double>();
  op->analyze(q.c.problem.structure);
  given.report = op->update(q.c.problem, q.c.damping);
  Workspace<double> work(op->workspace());
  MatrixX<double> f = MatrixX<double>::Zero(q.a.size(), 1);
  const Report solved = op->solve(q.a, f, work);
  if (given.report.ok() || solved.ok()) given.report = solved;
  given.finite = f.allFinite();
  if (q.truth && given.finite) given.errors = q.truth->errors(q.a, q.lambda, f.col(0));
  given.broken = broken_promise(row, q, given, f);
  return given;
}

}  // namespace delassus::laws
