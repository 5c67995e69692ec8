// Inequalities between quadratic forms: more damping, a joint less or a mass more, and the band around R. An inequality
// is broken by as much as one side exceeds the other; that excess is the error.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"
#include "property_tests/laws/variants_mechanism.h"

namespace delassus::laws {
namespace {

/// xᵀ y of every column, 1×k.
template <class W> MatrixX<W> forms(const MatrixX<W>& x, const MatrixX<W>& y) {
  MatrixX<W> out = MatrixX<W>::Constant(1, x.cols(), W(0));
  for (Index k = 0; k < x.cols(); ++k)
    for (Index r = 0; r < x.rows(); ++r) out(0, k) += x(r, k) * y(r, k);
  return out;
}

/// How far x exceeds y; NaN counts.
template <class W> MatrixX<W> excess(const MatrixX<W>& x, const MatrixX<W>& y) {
  MatrixX<W> out = MatrixX<W>::Constant(x.rows(), x.cols(), W(0));
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r)
      if (!(x(r, c) <= y(r, c))) out(r, c) = x(r, c) - y(r, c);
  return out;
}

template <class T> Dense<T> zeros(const Dense<T>& like) { return Dense<T>::Constant(like.rows(), like.cols(), Wide<T>(0)); }

/// xᵀ F_less x ≤ xᵀ F_more x.
template <class T>
Verdict ordered(Function f, const OperatorRow& op, const Case& c, const Variant<T>& less, const Case& of_less,
                const Variant<T>& more, const Case& of_more) {
  const MatrixX<T> x = vectors<T>(c.rows(), 3, c.seed);
  const Dense<T> wx = converted<Wide<T>>(x);
  const Dense<T> small = forms<Wide<T>>(wx, Route<T>(op, less.problem, less.damping)(f, x));
  const Dense<T> large = forms<Wide<T>>(wx, Route<T>(op, more.problem, more.damping)(f, x));
  const Dense<T> error = excess<Wide<T>>(small, large);
  return agree<T>(error, zeros<T>(error), bound_name(f, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const MatrixX<Quad> sum = error_bound(f, op, of_less, x) + error_bound(f, op, of_more, x);
      return forms<Quad>(magnitude(wx), sum);
    }
  });
}

const Case& more_damped(const Case& c) {
  return variant(c, "other damping", [](const Case& of) {
    return Variant<double>{of.problem, other_damping(*of.problem.structure, of.damping)};
  }, Data::given);
}

template <class T, Function F> const char* why_not_damped(const OperatorRow& op, const Case& c) {
  return why_not_second<T>(F, op, c, more_damped(c));
}

template <class T, Function F> Verdict ordered_by_damping(const OperatorRow& op, const Case& c) {
  const Variant<T> given = numbers<T>(c), more{given.problem, other_damping(*given.problem.structure, given.damping)};
  if (F == solve) return ordered<T>(F, op, c, more, more_damped(c), given, c);
  return ordered<T>(F, op, c, given, c, more, more_damped(c));
}

const Case& stiff(const Case& c) {
  return second_case(c, "stiffened", [&](const auto& p, const auto& d) { return stiffened<double>(p, d, c.seed); }, Data::given);
}

template <class T, Function F> const char* why_not_stiff(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<T>(F, op, c)) return reason;
  if (F == solve && !why_no_bound(apply, stiff(c)) && ScalarTraits<T>::exact && !exactly_regular(stiff(c))) return "A is singular";
  return why_not_second<T>(F, op, c, stiff(c));
}

template <class T, Function F> Verdict ordered_by_stiffness(const OperatorRow& op, const Case& c) {
  const Variant<T> given = numbers<T>(c), stiffer = stiffened<T>(given.problem, given.damping, c.seed).numbers;
  if (F == apply) return ordered<T>(F, op, c, stiffer, stiff(c), given, c);
  return ordered<T>(F, op, c, given, c, stiffer, stiff(c));
}

/// 0 ≤ yᵀ R⁻¹ y − xᵀ V_R x ≤ yᵀ F y with x = R⁻¹ y; F by the definition where the operator has no apply. x is rounded
/// once, which moves xᵀ V_R x by 2 |x|ᵀ|V_R x|.
template <class T, Function> Verdict band(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> y = vectors<T>(c.rows(), 3, c.seed);
  const Dense<T> wy = converted<W>(y), Ry = times<W>(damping_of(*p.structure, d), wy);
  const MatrixX<T> x = narrowed<T>(Ry);
  const Dense<T> wx = converted<W>(x), force = route(solve, x);
  const Dense<T> Ay = op.applies ? route(apply, y) : times<W>(definition<T>(apply, c), wy);
  const Dense<T> whole = forms<W>(wy, Ry), part = forms<W>(wx, force), free = forms<W>(wy, Ay) - whole;
  Dense<T> error(2, y.cols());
  error << excess<W>(part, whole), excess<W>(Dense<T>(whole - part), free);
  return agree<T>(error, zeros<T>(error), bound_name(solve, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const MatrixX<Quad> twice = magnitude(force) * Quad(2);
      const MatrixX<Quad> of_solve = error_bound(solve, op, c, x) + twice, of_apply_y = error_bound(apply, op, c, y);
      MatrixX<Quad> bound(2, y.cols());
      bound << forms<Quad>(magnitude(wx), of_solve), forms<Quad>(magnitude(wx), of_solve) + forms<Quad>(magnitude(wy), of_apply_y);
      return bound;
    }
  });
}

/// R⁻¹ f = a − F f with f = V_R a, as A f = a; A by the definition where the operator has no apply.
template <class T, Function> Verdict fixed_point(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> a = vectors<T>(c.rows(), 2, c.seed), f = route.narrow(solve, a);
  const Dense<T> Af = op.applies ? route(apply, f) : times<W>(definition<T>(apply, c), converted<W>(f));
  return agree<T>(Af, converted<W>(a), bound_name(solve, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return error_bound(apply, op, c, f) + times<Quad>(magnitude(definition<double>(apply, c)), error_bound(solve, op, c, a));
  });
}

}  // namespace

std::vector<LawRow> order_laws() {
  return {
      DELASSUS_TWINS("apply ordered by damping", "R'⁻¹ ≥ R⁻¹: xᵀA x ≤ xᵀA'x", of_apply, apply, why_not_damped, ordered_by_damping),
      DELASSUS_TWINS("solve ordered by damping", "R' ≤ R: xᵀV_R'x ≤ xᵀV_R x", of_solve, solve, why_not_damped, ordered_by_damping),
      DELASSUS_TWINS("apply decreases", "a freedom locked, masses added: xᵀA'x ≤ xᵀA x", of_apply, apply, why_not_stiff, ordered_by_stiffness),
      DELASSUS_TWINS("solve increases", "a freedom locked, masses added: xᵀV x ≤ xᵀV'x", of_solve, solve, why_not_stiff, ordered_by_stiffness),
      DELASSUS_TWINS("small-R band", "0 ≤ yᵀ(R⁻¹ − R⁻¹V_R R⁻¹)y ≤ yᵀF y", of_solve, solve, why_not_function, band),
      DELASSUS_TWINS("fixed point", "R⁻¹f = a − F f, f = V_R a", of_solve, solve, why_not_function, fixed_point),
  };
}

}  // namespace delassus::laws
