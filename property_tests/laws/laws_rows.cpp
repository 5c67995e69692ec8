// Laws about the rows alone: fewer, in another order, split, stacked, with idle links, parallel, in other units.
#include <cfenv>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"
#include "property_tests/laws/variants_rows.h"

namespace delassus::laws {
namespace {

const Case& fewer(const Case& c) {
  return second_case(c, "one constraint left out", [&](const auto& p, const auto& d) { return one_left_out<double>(p, d, c.seed); }, Data::given);
}

/// The rows of the case that `second` does not have.
template <class T> std::vector<Index> missing(const Second<T>& second, Index rows) {
  std::vector<bool> there(static_cast<std::size_t>(rows), false);
  for (const Index r : second.from) there[static_cast<std::size_t>(r)] = true;
  std::vector<Index> out;
  for (Index r = 0; r < rows; ++r)
    if (!there[static_cast<std::size_t>(r)]) out.push_back(r);
  return out;
}

/// x without the rows left out, the Schur complement on it, and what its second description has.
template <class T> Eliminated<T> eliminated(const OperatorRow& op, const Case& c, const Second<T>& second) {
  const auto [p, d] = numbers<T>(c);
  const MatrixX<T> x = restricted<T>(vectors<T>(c.rows(), 2, c.seed), second.from);
  return Eliminated<T>(solve, op, c, p, d, x, missing(second, c.rows()));
}

template <class T, Function F> const char* why_not_fewer(const OperatorRow& op, const Case& c) {
  if (constraint_count(*c.problem.structure) < 2) return "has one constraint at most";
  if (const char* reason = why_not_second<T>(F, op, c, fewer(c))) return reason;
  if (F == apply || ScalarTraits<T>::exact) return nullptr;
  const bool certain = eliminated<double>(op, c, one_left_out(c.problem, c.damping, c.seed)).certain();
  return certain ? nullptr : "promises no digit: 30 eps · bound reaches the rows left out";
}

template <class T, Function F> Verdict fewer_rows(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  const Second<T> second = one_left_out(p, d, c.seed);
  if (F == apply) return same_answer<T>(F, op, c, second, fewer(c));
  const Eliminated<T> schur = eliminated(op, c, second);
  const MatrixX<T> x = spread<T>(vectors<T>(c.rows(), 2, c.seed), second.from);
  const Dense<T> answer = Route<T>(op, second.numbers.problem, second.numbers.damping)(F, x);
  return agree<T>(spread<Wide<T>>(schur.value(), second.from), answer, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return spread<Quad>(schur.bound(), second.from) + error_bound(F, op, fewer(c), x);
  });
}

template <class T, Function F> Verdict rows_reordered(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, reordered(p, d, c.seed), c, true);
}

template <class T, Function F> const char* why_not_idle(const OperatorRow& op, const Case& c) {
  const Structure& s = *c.problem.structure;
  if (s.link_constraints.empty() || s.bodies() < 2) return "has no body that a constraint leaves out";
  return why_not<T>(F, op, c);
}

template <class T, Function F> Verdict idle_links(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, with_idle_links(p, d), c, true);
}

template <class T, Function F> const char* why_not_row_by_row(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<T>(F, op, c)) return reason;
  return can_split_rows(c.problem, c.damping) ? nullptr : "has no constraint of several rows without a block of R⁻¹";
}

template <class T, Function F> Verdict row_by_row(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, rows_split(p, d), c, true);
}

template <class T, Function F> const char* why_not_stacked(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<T>(F, op, c)) return reason;
  return can_stack(c.problem, c.damping) ? nullptr : "has no two constraints on bodies or on one joint";
}

template <class T, Function F> Verdict stacked(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, rows_stacked(p, d, c.seed), c, true);
}

const Case& twice(const Case& c) {
  return second_case(c, "one constraint twice", [&](const auto& p, const auto& d) { return doubled<double>(p, d, c.seed); });
}

template <class T, Function F> const char* why_not_parallel(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<T>(F, op, c)) return reason;
  if (!damped(c)) return "needs R⁻¹ > 0";
  return why_not_second<T>(F, op, c, twice(c));
}

/// Forces add up to those of the single constraint, and the copy, with R twice as large, carries twice the force.
template <class T, Function F> Verdict parallel(const OperatorRow& op, const Case& c) {
  using W = Wide<T>;
  const auto [p, d] = numbers<T>(c);
  const Second<T> second = doubled(p, d, c.seed);
  const Verdict sum = same_answer<T>(F, op, c, second, twice(c));
  const MatrixX<T> x = spread<T>(vectors<T>(c.rows(), 2, c.seed), second.from);
  const Dense<T> force = Route<T>(op, second.numbers.problem, second.numbers.damping)(F, x);
  const Index copied = force.rows() - c.rows(), first = second.from[static_cast<std::size_t>(c.rows())];
  const Dense<T> half = force.middleRows(first, copied) * W(2), copy = force.bottomRows(copied);
  return worst(sum, agree<T>(half, copy, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const MatrixX<Quad> b = error_bound(F, op, twice(c), x);
      return MatrixX<Quad>(b.middleRows(first, copied) * Quad(2)) + MatrixX<Quad>(b.bottomRows(copied));
    }
  }));
}

/// The answers in two units, and whether a number on the way was too small to be normal: forces and motions that decay along
/// thousands of links are. It is rounded to another digit then, and what follows rounds as it comes.
struct InTwoUnits {
  MatrixX<double> x;
  Ran<double> expected, other;
  bool underflow = false;
};

template <Function F> InTwoUnits in_two_units(const OperatorRow& op, const Case& c) {
  const Units<double> u = other_units<double>();
  const Second<double> second = in_units(c.problem, c.damping, u);
  const MatrixX<double> x = vectors<double>(c.rows(), 2, c.seed);
  std::feclearexcept(FE_UNDERFLOW);
  InTwoUnits runs{x, Route<double>(op, c.problem, c.damping).run(F, x), Route<double>(op, second.numbers.problem, second.numbers.damping).run(F, x)};
  runs.underflow = std::fetestexcept(FE_UNDERFLOW) != 0;
  runs.expected.y *= F == apply ? u.row * u.row / u.mass : u.mass / (u.row * u.row);
  return runs;
}

template <class T, Function F> const char* why_not_units(const OperatorRow& op, const Case& c) {
  if constexpr (ScalarTraits<T>::exact) return why_not<T>(F, op, c);
  else {
    if (const char* const why = why_not_called<F>(op, c)) return why;
    return why_no_bound(F, c) && in_two_units<F>(op, c).underflow ? "numbers on the way are not normal, and there is no bound" : nullptr;
  }
}

/// A' = row²/mass A, whatever the unit of length: bit for bit in double; where numbers are not normal within the bound, or the
/// same refusal.
template <class T, Function F> Verdict units_changed(const OperatorRow& op, const Case& c) {
  if constexpr (ScalarTraits<T>::exact) {
    const auto [p, d] = numbers<T>(c);
    const Units<T> u = other_units<T>();
    const Second<T> second = in_units(p, d, u);
    const T scale = F == apply ? u.row * u.row / u.mass : u.mass / (u.row * u.row);
    const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed);
    return judge_equal<T>(Route<T>(op, second.numbers.problem, second.numbers.damping).narrow(F, x), Route<T>(op, p, d).narrow(F, x) * scale);
  } else {
    const InTwoUnits runs = in_two_units<F>(op, c);
    const Verdict bits = judge_runs(runs.other, runs.expected);
    if (bits.passed() || !runs.underflow) return bits;
    const Report &expected = runs.expected.called, &other = runs.other.called;
    if (!expected.ok() || !other.ok())  // the same refusal, after as many steps as it takes
      return expected.status == other.status && expected.where == other.where ? judge_bits({}, {}) : bits;
    const Units<T> u = other_units<T>();
    const T back = F == apply ? u.mass / (u.row * u.row) : u.row * u.row / u.mass;
    return agree<double>(converted<Quad>(MatrixX<double>(runs.other.y * back)), converted<Quad>(MatrixX<double>(runs.expected.y * back)),
                         bound_name(F, op), [&] { return error_bound(F, op, c, runs.x); });
  }
}

}  // namespace

std::vector<LawRow> row_laws() {
  constexpr const char* bits = "identical bits";
  return {
      DELASSUS_TWINS("apply of fewer rows", "A x of some constraints = those rows of A x, x = 0 on the others", of_apply, apply, why_not_fewer, fewer_rows),
      DELASSUS_TWINS("solve of fewer rows", "V of some constraints = Schur complement of V", of_solve, solve, why_not_fewer, fewer_rows),
      DELASSUS_TWINS("apply reordered", "A x = A x with constraints in another order", of_apply, apply, why_not_function, rows_reordered),
      DELASSUS_TWINS("solve reordered", "V x = V x with constraints in another order", of_solve, solve, why_not_function, rows_reordered),
      DELASSUS_TWINS("apply with rows split", "a constraint of k rows = k constraints of one", of_apply, apply, why_not_row_by_row, row_by_row),
      DELASSUS_TWINS("solve with rows split", "a constraint of k rows = k constraints of one", of_solve, solve, why_not_row_by_row, row_by_row),
      DELASSUS_TWINS("apply with rows stacked", "constraints on the same bodies = one of all their rows", of_apply, apply, why_not_stacked, stacked),
      DELASSUS_TWINS("solve with rows stacked", "constraints on the same bodies = one of all their rows", of_solve, solve, why_not_stacked, stacked),
      DELASSUS_TWINS("apply with idle links", "a body added with K = 0 changes nothing", of_apply, apply, why_not_idle, idle_links),
      DELASSUS_TWINS("solve with idle links", "a body added with K = 0 changes nothing", of_solve, solve, why_not_idle, idle_links),
      DELASSUS_TWINS("parallel constraints", "R₁, R₂ on the same rows: f₁ + f₂ = f of R₁ + R₂, f₁ : f₂ = R₁ : R₂", of_solve, solve, why_not_parallel, parallel),
      DELASSUS_TWINS("apply in other units", "lengths, masses, rows scaled: A' = row²/mass A", bits, apply, why_not_units, units_changed),
      DELASSUS_TWINS("solve in other units", "lengths, masses, rows scaled: V' = mass/row² V", bits, solve, why_not_units, units_changed),
  };
}

}  // namespace delassus::laws
