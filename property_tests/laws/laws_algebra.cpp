#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_algebra.h"

#include <algorithm>

#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

/// Not a digit of the answer is promised: 30 eps · bound reaches the largest entry of the answer.
bool promises_nothing(const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  const MatrixX<Quad> bound = error_bound(Function::solve, op, c, x);
  const MatrixX<Quad> y = times<Quad>(definition<double>(Function::solve, c), converted<Quad>(x));
  Quad largest_bound(0), largest(0);
  for (Index r = 0; r < y.rows(); ++r) {
    largest_bound = std::max(largest_bound, Quad(bound(r, 0)));
    largest = std::max(largest, abs(Quad(y(r, 0))));
  }
  return !(Quad(pass_below * unit_roundoff<double>) * largest_bound < largest);
}

/// Exact numbers grow with every step of an iteration: more than six steps (those taken in double) are left out.
bool long_iteration(const OperatorRow& op, const Case& c) {
  if (!op.solves || c.rows() <= 6) return false;
  Route<double> route(op, c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  MatrixX<double> y = MatrixX<double>::Zero(c.rows(), 1);
  Workspace<double> w(route.get().workspace(1));
  return route.get().solve(x, y, w).iterations > 6;
}

/// Bound of F(x) for double; nothing for exact scalars.
template <class T> auto bound_of(Function f, const OperatorRow& op, const Case& c, const MatrixX<T>& x) {
  if constexpr (ScalarTraits<T>::exact) return 0;
  else return error_bound(f, op, c, x);
}

/// The columns the definition is compared on: unit vectors (at most ten, spread over the rows) and two more.
template <class T> MatrixX<T> probes(Index rows, std::uint64_t seed) {
  const Index units = std::min<Index>(rows, 10);
  MatrixX<T> x = MatrixX<T>::Zero(rows, units + 2);
  for (Index k = 0; k < units; ++k) x(k * rows / units, k) = T(1);
  x.rightCols(2) = vectors<T>(rows, 2, seed);
  return x;
}

}  // namespace

template <Function F> const char* why_not_called(const OperatorRow& op, const Case& c) {
  if (c.rows() == 0) return "no rows";
  if (F == Function::solve) return op.solves ? nullptr : "has no solve";
  return op.applies ? nullptr : "has no apply";
}
template const char* why_not_called<Function::apply>(const OperatorRow&, const Case&);
template const char* why_not_called<Function::solve>(const OperatorRow&, const Case&);

template <class T> const char* why_not(Function f, const OperatorRow& op, const Case& c) {
  const bool solve = f == Function::solve;
  if (const char* reason = solve ? why_not_called<Function::solve>(op, c) : why_not_called<Function::apply>(op, c)) return reason;
  if constexpr (ScalarTraits<T>::exact) {
    if (!c.exact) return "too large for exact arithmetic";
    if (!op.terminates_exactly || !std::get<Maker<T>>(op.makers)) return "does not end in exact arithmetic";
  }
  if (solve && !op.zero_damping && !damped(c)) return "needs R⁻¹ > 0";
  if (solve && ScalarTraits<T>::exact && long_iteration(op, c)) return "more than six steps with ever longer exact numbers";
  if (const char* reason = why_no_bound(f, c)) return reason;
  if (solve && ScalarTraits<T>::exact && !exactly_regular(c)) return "A is singular";
  if (!ScalarTraits<T>::exact && solve && promises_nothing(op, c)) return "promises no digit: 30 eps · bound reaches the answer";
  return nullptr;
}
template const char* why_not<double>(Function, const OperatorRow&, const Case&);
template const char* why_not<Rational>(Function, const OperatorRow&, const Case&);

template <class T, Function F> Verdict symmetric(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed), y = vectors<T>(c.rows(), 2, c.seed + 1);
  const Dense<T> wx = converted<Wide<T>>(x), wy = converted<Wide<T>>(y);
  const Dense<T> left = times<Wide<T>>(wx.transpose(), route(F, y));
  const Dense<T> right = times<Wide<T>>(route(F, x).transpose(), wy);
  return agree<T>(left, right, bound_name(F, op), [&]() -> MatrixX<Quad> {
    const auto bx = bound_of<T>(F, op, c, x), by = bound_of<T>(F, op, c, y);
    if constexpr (ScalarTraits<T>::exact) return {};
    else return times<Quad>(magnitude(wx).transpose(), by) + times<Quad>(bx.transpose(), magnitude(wy));
  });
}

template <class T, Function F> Verdict positive(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> x = vectors<T>(c.rows(), 3, c.seed);
  const Dense<T> wx = converted<W>(x), y = route(F, x);
  const Dense<T> Ry = F == Function::solve ? times<W>(damping_of(*p.structure, d), y) : Dense<T>::Zero(x.rows(), 3);
  Dense<T> below = Dense<T>::Zero(1, 3);  // how far xᵀy is below 0 or yᵀR⁻¹y: the error
  for (Index k = 0; k < 3; ++k) {
    W power(0), least(0);
    for (Index r = 0; r < x.rows(); ++r) {
      power += wx(r, k) * y(r, k);
      least += y(r, k) * Ry(r, k);
    }
    if (!(power >= least)) below(0, k) = least - power;
  }
  return agree<T>(below, Dense<T>::Zero(1, 3), bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const MatrixX<Quad> b = error_bound(F, op, c, x);
      const MatrixX<Quad> weight = magnitude(wx) + magnitude(Dense<T>(Ry * W(2)));
      MatrixX<Quad> total = MatrixX<Quad>::Zero(1, 3);
      for (Index k = 0; k < 3; ++k)
        for (Index r = 0; r < x.rows(); ++r) total(0, k) += weight(r, k) * b(r, k);
      return total;
    }
  });
}

template <class T, Function F> Verdict linear(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> x = vectors<T>(c.rows(), 1, c.seed), y = vectors<T>(c.rows(), 1, c.seed + 1);
  const MatrixX<T> z = x * T(2) - y * T(3);
  const Dense<T> sum = route(F, x) * W(2) - route(F, y) * W(3);
  return agree<T>(route(F, z), sum, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return error_bound(F, op, c, z) + error_bound(F, op, c, x) * Quad(2) + error_bound(F, op, c, y) * Quad(3);
  });
}

template <class T, Function F> Verdict is_definition(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> x = probes<T>(c.rows(), c.seed);
  const Dense<T> expected = times<Wide<T>>(definition<T>(F, c), converted<Wide<T>>(x));
  return agree<T>(route(F, x), expected, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return error_bound(F, op, c, x);
  });
}

template <class T> Verdict round_trip(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Route<T> route(op, p, d);
  const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed);
  const MatrixX<T> a = op.applies ? route.narrow(Function::apply, x)
                                  : narrowed<T>(times<W>(definition<T>(Function::apply, c), converted<W>(x)));
  return agree<T>(route(Function::solve, a), converted<W>(x), bound_name(Function::solve, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {  // the error of solve, and |A⁻¹| times the error of A x
      const MatrixX<Quad> of_a = op.applies ? error_bound(Function::apply, op, c, x) : magnitude(converted<Quad>(a));
      return error_bound(Function::solve, op, c, a) +
             times<Quad>(magnitude(definition<double>(Function::solve, c)), of_a);
    }
  });
}

template <class T> Verdict resolvent(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Damping<T> d2 = other_damping(*p.structure, d);
  const Dense<T> change = damping_of(*p.structure, d) - damping_of(*p.structure, d2);
  const Route<T> first(op, p, d), second(op, p, d2);
  const MatrixX<T> a = vectors<T>(c.rows(), 2, c.seed);
  const MatrixX<T> force = second.narrow(Function::solve, a);
  const Dense<T> wforce = converted<W>(force);
  const MatrixX<T> moved = narrowed<T>(Dense<T>(converted<W>(a) + times<W>(change, wforce)));
  return agree<T>(first(Function::solve, moved), wforce, bound_name(Function::solve, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const Case& other = variant(c, "other damping", [](const Case& of) {
        return Variant<double>{of.problem, other_damping(*of.problem.structure, of.damping)};
      }, Data::given);
      const MatrixX<Quad> of_force = error_bound(Function::solve, op, other, a);
      const MatrixX<Quad> of_moved = times<Quad>(magnitude(change), of_force) + magnitude(converted<Quad>(moved));
      return error_bound(Function::solve, op, c, moved) + of_force +
             times<Quad>(magnitude(definition<double>(Function::solve, c)), of_moved);
    }
  });
}

#define DELASSUS_LAWS(T)                                                                    \
  template Verdict symmetric<T, Function::apply>(const OperatorRow&, const Case&);          \
  template Verdict symmetric<T, Function::solve>(const OperatorRow&, const Case&);          \
  template Verdict positive<T, Function::apply>(const OperatorRow&, const Case&);           \
  template Verdict positive<T, Function::solve>(const OperatorRow&, const Case&);           \
  template Verdict linear<T, Function::apply>(const OperatorRow&, const Case&);             \
  template Verdict linear<T, Function::solve>(const OperatorRow&, const Case&);             \
  template Verdict is_definition<T, Function::apply>(const OperatorRow&, const Case&);      \
  template Verdict is_definition<T, Function::solve>(const OperatorRow&, const Case&);      \
  template Verdict round_trip<T>(const OperatorRow&, const Case&);                          \
  template Verdict resolvent<T>(const OperatorRow&, const Case&);
DELASSUS_LAWS(double)
DELASSUS_LAWS(Rational)
#undef DELASSUS_LAWS

}  // namespace delassus::laws
