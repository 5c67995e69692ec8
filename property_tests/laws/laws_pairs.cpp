// Laws about the pair (ν, λ) of solve_kkt, and about rows that come and go: R⁻¹ = ∞, update_rows.
#include "property_tests/laws/laws_conduct.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"
#include "property_tests/laws/variants_rows.h"
#include "reference/definition.h"

namespace delassus::laws {
namespace {

template <class T> struct Pair {
  Report report;
  MatrixX<T> nu, lambda;
};

/// @throws Broken.
template <class T> Pair<T> pair_of(const OperatorRow& row, const Problem<T>& p, const Damping<T>& d, const MatrixX<T>& r1, const MatrixX<T>& r2) {
  Route<T> route(row, p, d);
  if (!route.updated().ok()) throw Broken("update", route.updated());
  Workspace<T> w(route.get().kkt_workspace());
  Pair<T> out{{}, MatrixX<T>::Constant(r1.rows(), r1.cols(), T(0)), MatrixX<T>::Constant(r2.rows(), r2.cols(), T(0))};
  out.report = route.get().solve_kkt(r1, r2, out.nu, out.lambda, Accuracy::full(), w);
  if (!out.report.ok()) throw Broken("solve_kkt", out.report);
  return out;
}

/// Wrong operators may lack it; each of the table that solves has it (unit test Pair).
bool has_pairs(const OperatorRow& row, const Case& c) {
  Route<double> route(row, c.problem, c.damping);
  Workspace<double> w(route.get().kkt_workspace());
  const Index n = c.problem.structure->dofs();
  const MatrixX<double> r1 = MatrixX<double>::Zero(n, 1), r2 = MatrixX<double>::Zero(c.rows(), 1);
  MatrixX<double> nu(n, 1), lambda(c.rows(), 1);
  return route.get().solve_kkt(r1, r2, nu, lambda, Accuracy::full(), w).status != Status::not_supported;
}

template <class T> const char* why_not_pair(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<T>(solve, op, c)) return reason;
  return has_pairs(op, c) ? nullptr : "has no solve_kkt";
}

/// M ν − Jᵀλ = r₁ and J ν + R⁻¹λ = r₂, in rational numbers.
Verdict pair_is_definition(const OperatorRow& op, const Case& c) {
  using X = Rational;
  const auto [p, d] = numbers<X>(c);
  const MatrixX<X> r1 = vectors<X>(p.structure->dofs(), 2, c.seed + 3), r2 = vectors<X>(c.rows(), 2, c.seed + 4);
  const Pair<X> x = pair_of<X>(op, p, d, r1, r2);
  const MatrixX<X> M = reference::mass_matrix(p), J = reference::constraint_jacobian(p), R = reference::damping_matrix(*p.structure, d);
  return worst(judge_equal<X>(times<X>(M, x.nu) - times<X>(J.transpose(), x.lambda), r1),
               judge_equal<X>(times<X>(J, x.nu) + times<X>(R, x.lambda), r2));
}

/// With r₁ = Jᵀy the force y acts beside λ: λ + y = A⁻¹ (r₂ + R⁻¹y). Jᵀy is rounded, and J M⁻¹Jᵀy as inexact as A y.
Verdict shifted_force(const OperatorRow& op, const Case& c) {
  const reference::Dense<Quad>& D = matrices(c);
  const MatrixX<double> y = vectors<double>(c.rows(), 1, c.seed + 5), r2 = vectors<double>(c.rows(), 1, c.seed + 6);
  const MatrixX<Quad> wy = converted<Quad>(y), b = converted<Quad>(r2) + times<Quad>(D.R_inverse, wy);
  const MatrixX<double> r1 = converted<double>(times<Quad>(D.J.transpose(), wy));
  const MatrixX<Quad> inverse = definition<double>(solve, c), expected = times<Quad>(inverse, b) - wy;
  const Pair<double> x = pair_of<double>(op, c.problem, c.damping, r1, r2);
  return agree<double>(converted<Quad>(x.lambda), expected, bound_name(solve, op), [&] {
    const MatrixX<Quad> of_r1 = times<Quad>(magnitude(MatrixX<Quad>(D.M_inv_Jt.transpose())), magnitude(converted<Quad>(r1)));
    return MatrixX<Quad>(error_bound(solve, op, c, converted<double>(b)) + magnitude(wy) + magnitude(expected) +
                         times<Quad>(magnitude(inverse), MatrixX<Quad>(error_bound(apply, op, c, y) + of_r1)));
  });
}

const char* why_not_certified(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not_pair<double>(op, c)) return reason;
  return op.solve_error == ErrorClass::refined ? nullptr : "has no certificate";
}

/// √(‖ν‖²_M + ‖λ‖²_{R⁻¹})
Quad energy(const reference::Dense<Quad>& D, const MatrixX<Quad>& nu, const MatrixX<Quad>& lambda) {
  const auto square = [](const MatrixX<Quad>& X, const MatrixX<Quad>& x) { return times<Quad>(x.transpose(), times<Quad>(X, x))(0, 0); };
  return sqrt(abs(Quad(square(D.M, nu) + square(D.R_inverse, lambda))));
}

/// The pair, of any r₁, is as near the true one as its bound says, but for rounding it to double.
Verdict certified_pair(const OperatorRow& op, const Case& c) {
  const reference::Dense<Quad>& D = matrices(c);
  const MatrixX<double> r1 = vectors<double>(c.problem.structure->dofs(), 1, c.seed + 3), r2 = vectors<double>(c.rows(), 1, c.seed + 4);
  const Pair<double> x = pair_of<double>(op, c.problem, c.damping, r1, r2);
  const MatrixX<Quad> tau = converted<Quad>(r1), inverse = definition<double>(solve, c);
  const MatrixX<Quad> lambda = times<Quad>(inverse, MatrixX<Quad>(converted<Quad>(r2) - times<Quad>(D.M_inv_Jt.transpose(), tau)));
  const MatrixX<Quad> nu = reference::PivotedLdlt<Quad>(D.M).solve(tau) + times<Quad>(D.M_inv_Jt, lambda);
  const Quad size = energy(D, nu, lambda);
  const Quad error = energy(D, converted<Quad>(x.nu) - nu, converted<Quad>(x.lambda) - lambda);
  // |ν|ᵀ|M||ν| and |λ|ᵀ|R⁻¹||λ| of what rounds; without a bound, what the data allow
  const auto rounding = [](const MatrixX<Quad>& X, const MatrixX<Quad>& x1) {
    return times<Quad>(magnitude(MatrixX<Quad>(x1.transpose())), times<Quad>(magnitude(X), magnitude(x1)))(0, 0);
  };
  const Quad rounded = sqrt(Quad(rounding(D.M, nu) + rounding(D.R_inverse, lambda)));
  const Quad promised = x.report.error_bound >= 0 ? Quad(x.report.error_bound / unit_roundoff<double>) : condition_of_M(c) * Quad(condition(c));
  const Quad of_reference = Quad(unit_roundoff<Quad> / unit_roundoff<double> * condition(c)) * size;  // its λ is off by eps κ(A) of Quad
  const MatrixX<Quad> bound = MatrixX<Quad>::Constant(1, 1, promised * size + rounded * sqrt(condition_of_M(c)) + of_reference);
  return judge(MatrixX<Quad>::Constant(1, 1, error), bound, unit_roundoff<double>, "its certificate + rounding of the pair");
}

// --- rows that are off ---

/// One constraint, or one row of it: by the seed.
std::vector<Index> rows_to_switch_off(const Case& c) {
  const Structure& s = *c.problem.structure;
  std::vector<std::pair<Index, Index>> all;
  for (const auto& e : s.link_constraints) all.emplace_back(e.row, e.rows);
  for (const auto& e : s.joint_constraints) all.emplace_back(e.row, e.rows);
  const auto [first, count] = all[c.seed % all.size()];
  if (c.seed % 2 == 0 && count > 1) return {first + static_cast<Index>(c.seed / 2) % count};
  std::vector<Index> rows;
  for (Index r = first; r < first + count; ++r) rows.push_back(r);
  return rows;
}

template <class T> Damping<T> with_rows_off(Damping<T> d, const std::vector<Index>& rows) {
  for (const Index r : rows) d.diagonal[static_cast<std::size_t>(r)] = ScalarTraits<T>::infinity();
  return d;
}

const Case& absent(const Case& c) {
  return second_case(c, "rows left out", [&](const auto& p, const auto& d) { return rows_left_out<double>(p, d, rows_to_switch_off(c)); }, Data::given);
}

template <class T, Function F> const char* why_not_off(const OperatorRow& op, const Case& c) {
  if (static_cast<Index>(c.rows()) < 2) return "has one row at most";
  if (c.rows() == static_cast<Index>(rows_to_switch_off(c).size())) return "has one constraint at most";
  return why_not_second<T>(F, op, c, absent(c));
}

template <class T, Function F> Verdict rows_off(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  const std::vector<Index> off = rows_to_switch_off(c);
  const Second<T> second = rows_left_out(p, d, off);
  const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed);  // what it holds in rows that are off must not matter
  const MatrixX<T> there = spread<T>(x, second.from);
  const Dense<T> switched = Route<T>(op, p, with_rows_off(d, off))(F, x);
  for (const Index r : off)
    for (Index k = 0; k < switched.cols(); ++k)
      if (!(switched(r, k) == Wide<T>(0))) return failure("row " + std::to_string(r) + " is off, and not zero");
  const Dense<T> answer = Route<T>(op, second.numbers.problem, second.numbers.damping)(F, there);
  return agree<T>(spread<Wide<T>>(switched, second.from), answer, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return MatrixX<Quad>(error_bound(F, op, absent(c), there) * Quad(2));
  });
}

// --- update_rows ---

/// Other K and 𝒦 on the same tree, every other row off.
template <class T> Variant<T> other_rows(Problem<T> p, Damping<T> d) {
  for (auto& k : p.K) k *= T(-0.5);
  for (T& k : p.joint_K) k *= T(2);
  for (std::size_t r = 0; r < d.diagonal.size(); r += 2) d.diagonal[r] = ScalarTraits<T>::infinity();
  return {std::move(p), std::move(d)};
}

/// update with other rows, then update_rows = update on a fresh operator, bit for bit.
template <Function F> Verdict rows_updated(const OperatorRow& op, const Case& c) {
  const Variant<double> other = other_rows(c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 2, c.seed);
  Route<double> moved(op, other.problem, other.damping);
  static_cast<void>(moved.run(F, x));
  moved.updated() = moved.get().update_rows(c.problem, c.damping);
  return judge_runs(moved.run(F, x), Route<double>(op, c.problem, c.damping).run(F, x));
}

}  // namespace

std::vector<LawRow> pair_laws() {
  return {
      {"exact pair = definition", "M ν − Jᵀλ = r₁, J ν + R⁻¹λ = r₂", "equality", why_not_twin<why_not_pair<Rational>>, pair_is_definition},
      {"pair with a force shifted", "r₁ = Jᵀy: λ + y = A⁻¹(r₂ + R⁻¹y)", of_solve, why_not_pair<double>, shifted_force},
      {"pair within its certificate", "‖δν‖²_M + ‖δλ‖²_{R⁻¹} ≤ error_bound²", "its certificate + rounding of the pair", why_not_certified, certified_pair},
      DELASSUS_TWINS("apply with rows off", "R⁻¹ = ∞ on some rows = without them", of_apply, apply, why_not_off, rows_off),
      DELASSUS_TWINS("solve with rows off", "R⁻¹ = ∞ on some rows = without them", of_solve, solve, why_not_off, rows_off),
      {"apply after update_rows", "update_rows = update", "identical bits", why_not_called<apply>, rows_updated<apply>},
      {"solve after update_rows", "update_rows = update", "identical bits", why_not_called<solve>, rows_updated<solve>},
  };
}

}  // namespace delassus::laws
