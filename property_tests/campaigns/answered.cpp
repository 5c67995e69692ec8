#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/answered.h"

#include <cmath>

namespace delassus::laws {
namespace {

/// Exponent of the largest |number|; 0 when all are zero.
template <class Numbers> int exponent(const Numbers& numbers) {
  double most = 0;
  for (const double x : numbers) most = std::max(most, std::fabs(x));
  return most > 0 ? std::ilogb(most) : 0;
}

void multiply(std::vector<double>& numbers, int power) {
  for (double& x : numbers) x = std::ldexp(x, power);
}

/// 2^power in Quad, beyond the range of double too.
Quad power_of_two(int power) { return Quad(std::ldexp(1.0, power / 2)) * Quad(std::ldexp(1.0, power - power / 2)); }

/// A question whose forces are 2^power times those of another.
struct Scaled {
  Case c;
  MatrixX<double> a;
  int power = 0;
};

/// The same in units in which masses and a are about one: powers of two, so that no number is rounded. Unchanged where
/// they are within 2^±300.
Scaled about_one(const Question& q) {
  std::vector<double> inertias;
  for (const auto& H : q.c.problem.H) inertias.insert(inertias.end(), H.data(), H.data() + H.size());
  const int mass = exponent(inertias), acceleration = -exponent(q.a);
  if (std::max(std::abs(mass), std::abs(acceleration)) < 300) return {q.c, q.a};
  Problem<double> p = q.c.problem;
  Damping<double> d = q.c.damping;
  for (auto& H : p.H) H = H.unaryExpr([=](double x) { return std::ldexp(x, -mass); }).eval();
  multiply(p.armature, -mass);
  multiply(d.diagonal, mass);
  for (auto& b : d.blocks) b.R_inverse = b.R_inverse.unaryExpr([=](double x) { return std::ldexp(x, mass); }).eval();
  MatrixX<double> a = q.a.unaryExpr([=](double x) { return std::ldexp(x, acceleration); });
  return {make_case(std::move(p), std::move(d), q.c.label, q.c.seed), std::move(a), acceleration - mass};
}

/// Largest error / (eps · bound of the operator's error class); −1: no bound.
double law_ratio(const OperatorRow& row, const Question& q, const MatrixX<double>& f) {
  const Scaled scaled = about_one(q);
  if (why_no_bound(Function::solve, scaled.c)) return -1;
  const Quad unit = power_of_two(scaled.power);
  const MatrixX<Quad> error = (converted<Quad>(f) - MatrixX<Quad>(q.lambda)) * unit;
  MatrixX<Quad> bound = error_bound(Function::solve, row, scaled.c, scaled.a);
  for (Quad& b : bound.reshaped())  // half the least denormal number: eps · 2⁻¹⁰²²
    if (b > Quad(0)) b += Quad(0x1p-1022) * unit;
  return judge(error, bound, unit_roundoff<double>, "").ratio;
}

/// A status says what the certificate says: all digits, or not half of them.
std::string contradiction(const Report& r) {
  const double eps = unit_roundoff<double>;
  const bool nothing_left = r.error_bound >= 0 && r.error_bound <= 8 * eps && r.error_estimate >= 0 && r.error_estimate <= 4 * eps;
  if (r.status == Status::not_converged && nothing_left) return "not_converged beside a bound and a correction of rounding";
  return r.ok() && r.error_bound > std::sqrt(eps) ? "ok beside a bound above the square root of eps" : "";
}

std::string broken_promise(const OperatorRow& row, const Question& q, const Answered& given, const MatrixX<double>& f) {
  const Report& r = given.report;
  const bool answer = r.ok() || r.status == Status::not_converged;
  if (!answer) return f.array().isNaN().all() ? "" : "numbers in an answer called " + std::string(name(r.status));
  if (r.ok() && !given.finite) return "NaN in an answer called ok";
  if (const std::string said = contradiction(r); !said.empty()) return said;
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
