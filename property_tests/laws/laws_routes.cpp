#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_routes.h"

#include <algorithm>

#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

const Case& as_links(const Case& c) {
  return variant(c, "joint rows as links", [](const Case& of) { return joint_rows_as_links(of.problem, of.damping); });
}
const Case& as_rows(const Case& c) {
  return variant(c, "armature as rows", [](const Case& of) { return armature_as_rows(of.problem, of.damping); });
}

/// The same question to two descriptions, `other` with rows appended after those of `c`.
template <class T>
Verdict same_answer(Function f, const OperatorRow& op, const Case& c, const Variant<T>& v, const Case& other) {
  const auto [p, d] = numbers<T>(c);
  const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed);
  MatrixX<T> longer = MatrixX<T>::Zero(v.problem.structure->rows, x.cols());
  longer.topRows(c.rows()) = x;
  const Dense<T> first = Route<T>(op, p, d)(f, x);
  const Dense<T> second = Route<T>(op, v.problem, v.damping)(f, longer).topRows(c.rows());
  return agree<T>(first, second, bound_name(f, op, other.known->data), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return error_bound(f, op, c, x) + MatrixX<Quad>(error_bound(f, op, other, longer).topRows(c.rows()));
  });
}

constexpr std::string_view reference_name(Witness w) { return w == Witness::maximal ? "maximal" : "kkt_cholmod"; }

constexpr Index witness_columns = 3;

template <Function F, Witness W> const std::optional<MatrixX<Quad>>& witness(const Case& c) {
  return answer(F, reference_name(W), c, vectors<double>(c.rows(), witness_columns, c.seed));
}

}  // namespace

template <class T, Function F> Verdict relabelling(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, relabelled(p, d, c.seed + 3), c);  // the bound does not depend on names
}

template <class T, Function F> const char* why_not_joint_rows(const OperatorRow& op, const Case& c) {
  if (c.problem.structure->joint_constraints.empty()) return "has no joint rows";
  if (const char* reason = why_not<T>(F, op, c)) return reason;
  return ScalarTraits<T>::exact ? nullptr : why_not<T>(F, op, as_links(c));
}

template <class T, Function F> Verdict joint_rows(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, joint_rows_as_links(p, d), as_links(c));
}

template <class T> const char* why_not_armature(const OperatorRow& op, const Case& c) {
  const auto& A = c.problem.armature;
  if (std::all_of(A.begin(), A.end(), [](double x) { return x == 0; })) return "has no armature";
  if (const char* reason = why_not<T>(Function::solve, op, c)) return reason;
  if (const char* reason = why_no_bound(Function::solve, as_rows(c))) return reason;
  return ScalarTraits<T>::exact ? nullptr : why_not<T>(Function::solve, op, as_rows(c));
}

template <class T> Verdict armature(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(Function::solve, op, c, armature_as_rows(p, d), as_rows(c));
}

template <Function F, Witness W> const char* why_not_witness(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not<double>(F, op, c)) return reason;
  return witness<F, W>(c) ? nullptr : "the reference does not trust itself here";
}

template <Function F, Witness W> Verdict witnessed(const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), witness_columns, c.seed);
  const MatrixX<Quad>& expected = *witness<F, W>(c);
  const MatrixX<Quad> got = Route<double>(op, c.problem, c.damping)(F, x);
  return agree<double>(got, expected, bound_name(F, op), [&] {
    MatrixX<Quad> bound = error_bound(F, op, c, x);
    // CHOLMOD's answer is rounded to double in norm: one unit of its largest entry.
    if (W == Witness::kkt)
      for (Index k = 0; k < bound.cols(); ++k) {
        Quad largest(0);
        for (Index r = 0; r < bound.rows(); ++r) largest = std::max(largest, abs(Quad(expected(r, k))));
        for (Index r = 0; r < bound.rows(); ++r) bound(r, k) += largest;
      }
    return bound;
  });
}

#define DELASSUS_LAWS(T, F)                                                              \
  template Verdict relabelling<T, F>(const OperatorRow&, const Case&);                   \
  template const char* why_not_joint_rows<T, F>(const OperatorRow&, const Case&);        \
  template Verdict joint_rows<T, F>(const OperatorRow&, const Case&);
DELASSUS_LAWS(double, Function::apply)
DELASSUS_LAWS(double, Function::solve)
DELASSUS_LAWS(Rational, Function::apply)
DELASSUS_LAWS(Rational, Function::solve)
template const char* why_not_armature<double>(const OperatorRow&, const Case&);
template const char* why_not_armature<Rational>(const OperatorRow&, const Case&);
template Verdict armature<double>(const OperatorRow&, const Case&);
template Verdict armature<Rational>(const OperatorRow&, const Case&);
#define DELASSUS_WITNESS(F, W)                                                    \
  template const char* why_not_witness<F, W>(const OperatorRow&, const Case&);    \
  template Verdict witnessed<F, W>(const OperatorRow&, const Case&);
DELASSUS_WITNESS(Function::apply, Witness::maximal)
DELASSUS_WITNESS(Function::solve, Witness::maximal)
DELASSUS_WITNESS(Function::apply, Witness::kkt)
DELASSUS_WITNESS(Function::solve, Witness::kkt)
#undef DELASSUS_LAWS
#undef DELASSUS_WITNESS

}  // namespace delassus::laws
