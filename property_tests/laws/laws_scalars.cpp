// The other scalars an operator serves, refusals, and concurrent use.
#include <algorithm>
#include <latch>
#include <optional>
#include <thread>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"

namespace delassus::laws {
namespace {

/// 30 eps(float) · bound reaches the largest entry of the answer.
bool float_promises_nothing(Function f, const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  const MatrixX<Quad> y = times<Quad>(definition<double>(f, c), converted<Quad>(x)), bound = error_bound(f, op, c, x, Data::rounded);
  Quad reach(0), largest(0);
  for (Index r = 0; r < y.rows(); ++r) {
    reach = std::max(reach, Quad(Quad(pass_below * unit_roundoff<float>) * bound(r, 0)));
    largest = std::max(largest, abs(Quad(y(r, 0))));
  }
  return !(reach < largest);
}

/// Entries of the diagonal of A can be squared, twice, in float.
bool within_float(const Case& c) {
  const MatrixX<Quad>& A = definition<double>(apply, c);
  for (Index r = 0; r < A.rows(); ++r) {
    const double size = static_cast<double>(A(r, r));
    if (size != 0 && !(size > 0x1p-30 && size < 0x1p30)) return false;
  }
  return true;
}

template <Function F> const char* why_not_float(const OperatorRow& op, const Case& c) {
  if (!std::get<Maker<float>>(op.makers)) return "is not served in float";
  if (const char* reason = why_not<double>(F, op, c)) return reason;
  if (!(Quad(pass_below * unit_roundoff<float>) * condition_of_M(c) < Quad(1))) return "M may be singular within the roundoff of float";
  if (!within_float(c)) return "squares of its entries leave the range of float";
  if (F == solve && condition(c) > 0x1p12) return "κ(A) > 2¹², the square root of 1/eps of float";
  return float_promises_nothing(F, op, c) ? "promises no digit: 30 eps(float) · bound reaches the answer" : nullptr;
}

/// In float = the definition, within eps(float) · bound. Rounding the problem to float changes every number by eps(float).
template <Function F> Verdict in_float(const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), 2, c.seed);
  const Route<float> route(op, c.problem.cast<float>(), c.damping.cast<float>());
  const MatrixX<Quad> got = route(F, converted<float>(x)), expected = times<Quad>(definition<double>(F, c), converted<Quad>(x));
  return judge(got - expected, error_bound(F, op, c, x, Data::rounded), unit_roundoff<float>, bound_name(F, op, Data::rounded));
}

template <Function F> const char* why_not_quad(const OperatorRow& op, const Case& c) {
  if (!std::get<Maker<Quad>>(op.makers)) return "is not served in Quad";
  return why_not<Rational>(F, op, c);
}

/// In Quad = the definition in rational numbers, within eps(Quad) · bound.
template <Function F> Verdict in_quad(const OperatorRow& op, const Case& c) {
  const MatrixX<Quad> x = vectors<Quad>(c.rows(), 2, c.seed);
  const MatrixX<Quad> got = Route<Quad>(op, c.problem.cast<Quad>(), c.damping.cast<Quad>())(F, x);
  const MatrixX<Rational> expected = times<Rational>(definition<Rational>(F, c), converted<Rational>(x));
  const MatrixX<Rational> error = converted<Rational>(got) - expected;
  return judge(converted<Quad>(error), error_bound(F, op, c, converted<double>(x), Data::rounded), unit_roundoff<Quad>, bound_name(F, op, Data::rounded));
}

Quad maximum(const MatrixX<Quad>& x) { return x.size() == 0 ? Quad(0) : Quad(x.maxCoeff()); }
/// ‖A‖_∞.
Quad norm(const MatrixX<Quad>& A) { return maximum(magnitude(A).rowwise().sum()); }

/// The answer to one vector; nothing where update or solve refuses.
template <class T> std::optional<MatrixX<T>> answered(const OperatorRow& op, const Case& c, const MatrixX<T>& x) {
  const auto [p, d] = numbers<T>(c);
  try {
    return Route<T>(op, p, d).narrow(solve, x);
  } catch (const Broken&) {
    return std::nullopt;
  }
}

const char* why_not_refusal(const OperatorRow& op, const Case& c) {
  if (c.rows() == 0) return "no rows";
  if (!op.solves) return "has no solve";
  if (!c.exact || !std::get<Maker<Rational>>(op.makers)) return "too large for exact arithmetic";
  if (const char* reason = why_no_bound(apply, c)) return reason;
  if (damped(c)) return "nothing to refuse: R⁻¹ > 0";
  const bool by_rounding_only = dependent_to_rounding(c) && exactly_regular(c);
  return by_rounding_only ? "its hard rows depend on others but for the rounding of their numbers" : nullptr;
}

/// Whether the operator's own product hides how good an answer is: the solution rounded to double, and neighbours a few units
/// away, put through it in double leave a residual above what an iteration on it must reach, 30 eps m (‖A‖‖y‖ + ‖x‖). So it is
/// where J M⁻¹Jᵀ is a small difference of large numbers.
bool product_hides(const OperatorRow& op, const Case& c, const MatrixX<Rational>& solution, const MatrixX<double>& x) {
  constexpr Index neighbours = 8;
  const Route<double> route(op, c.problem, c.damping);
  if (!op.applies || route.run(solve, x).called.status != Status::not_converged) return false;
  const MatrixX<double> y = converted<double>(solution);
  MatrixX<double> ys(y.rows(), neighbours);
  for (Index k = 0; k < neighbours; ++k) ys.col(k) = y * (1 + 2 * static_cast<double>(k) * unit_roundoff<double>);
  const MatrixX<double> got = route.narrow(apply, ys);
  const double size = static_cast<double>(norm(definition<double>(apply, c))) * y.norm() + x.norm();
  for (Index k = 0; k < neighbours; ++k)
    if ((got.col(k) - x).norm() > pass_below * unit_roundoff<double> * static_cast<double>(c.rows()) * size) return true;
  return false;
}

/// Hard or dependent rows. Solved in rational numbers: solved in double, or, by an operator whose error is normwise, not
/// converged where its own product hides it. Refused in rational numbers: refused in double,
/// or answered with a residual A y − a within rounding, the answer to a problem that differs by rounding (in norm, for
/// the error class normwise: by ‖A‖‖y‖ too, times the m that an iteration of m products is allowed, cg.h).
Verdict same_refusal(const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  const auto exact = answered<Rational>(op, c, converted<Rational>(x));
  const auto rounded = answered<double>(op, c, x);
  if (exact && !rounded && op.solve_error == ErrorClass::normwise && product_hides(op, c, *exact, x)) return {0, bound_name(apply, op), -1, {}};
  if (exact && !rounded) return failure("solved in rational numbers, refused in double", bound_name(apply, op));
  if (exact || !rounded) return {0, bound_name(apply, op), -1, {}};
  const MatrixX<Quad>& A = definition<double>(apply, c);
  const MatrixX<Quad> residual = times<Quad>(A, converted<Quad>(*rounded)) - converted<Quad>(x);
  MatrixX<Quad> bound = error_bound(apply, op, c, *rounded);
  const bool iterates = Route<double>(op, c.problem, c.damping).run(solve, x).called.iterations > 0;
  const Quad products(iterates ? static_cast<double>(c.rows()) : 1);
  if (op.solve_error == ErrorClass::normwise)
    bound.setConstant(products * (maximum(bound) + norm(A) * maximum(magnitude(converted<Quad>(*rounded)))));
  return judge(residual, bound, unit_roundoff<double>, bound_name(apply, op));
}

/// Eight answers on another thread while this one answers for other vectors: all as computed alone, and as by a fresh
/// operator, bit for bit.
template <Function F> Verdict on_two_threads(const OperatorRow& op, const Case& c) {
  constexpr int times_over = 8;
  const Route<double> route(op, c.problem, c.damping);
  const MatrixX<double> x[2] = {vectors<double>(c.rows(), 2, c.seed), vectors<double>(c.rows(), 1, c.seed + 1)};
  const Ran<double> alone[2] = {route.run(F, x[0]), route.run(F, x[1])};
  Verdict v[2];
  std::latch both(2);
  const auto work = [&](int k) {
    both.arrive_and_wait();
    for (int repeat = 0; repeat < times_over; ++repeat) v[k] = worst(v[k], judge_runs(route.run(F, x[k]), alone[k]));
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  const Verdict fresh = judge_runs(Route<double>(op, c.problem, c.damping).run(F, x[0]), alone[0]);
  return worst(fresh, worst(v[0], v[1]));
}

}  // namespace

std::vector<LawRow> scalar_laws() {
  constexpr const char *in_f = "apply_sensitivity, eps of float", *in_q = "apply_sensitivity, eps of Quad";
  constexpr const char *solve_f = "by error class, eps of float", *solve_q = "by error class, eps of Quad";
  return {
      {"apply in float", "A x in float = A x by the definition", in_f, why_not_float<apply>, in_float<apply>},
      {"solve in float", "A⁻¹ x in float = A⁻¹ x by the definition", solve_f, why_not_float<solve>, in_float<solve>},
      {"apply in Quad", "A x in Quad = A x in rational numbers", in_q, why_not_quad<apply>, in_quad<apply>},
      {"solve in Quad", "A⁻¹ x in Quad = A⁻¹ x in rational numbers", solve_q, why_not_quad<solve>, in_quad<solve>},
      {"refuses as in exact arithmetic", "hard rows: refused in double ⇔ in rational numbers, or a residual of rounding", of_apply,
       why_not_refusal, same_refusal},
      {"apply on two threads", "concurrent = alone = fresh operator", "identical bits", why_not_called<apply>,
       on_two_threads<apply>},
      {"solve on two threads", "concurrent = alone = fresh operator", "identical bits", why_not_called<solve>,
       on_two_threads<solve>},
  };
}

}  // namespace delassus::laws
