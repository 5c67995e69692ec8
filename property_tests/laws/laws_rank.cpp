// Laws about rank decisions: the number of hard rows left out is that of the mechanism, not of its description; and what is
// answered without them holds on all rows.
#include <algorithm>

#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"
#include "property_tests/laws/variants_rows.h"

namespace delassus::laws {
namespace {

bool any_hard(const Case& c) {
  std::vector<bool> damped_row(static_cast<std::size_t>(c.rows()), false);
  for (const auto& b : c.damping.blocks)
    for (Index r = 0; r < b.R_inverse.rows(); ++r) damped_row[static_cast<std::size_t>(b.row + r)] = true;
  for (std::size_t r = 0; r < damped_row.size(); ++r)
    if (!damped_row[r] && c.damping.diagonal[r] == 0) return true;
  return false;
}

const char* why_not_rank(const OperatorRow& op, const Case& c) {
  if (!op.decides_rank) return "does not decide ranks";
  return any_hard(c) ? nullptr : "has no hard row";
}

Index left_out(const OperatorRow& op, const Problem<double>& p, const Damping<double>& d) {
  const auto made = op.make<double>();
  made->analyze(p.structure);
  static_cast<void>(made->update(p, d));  // its report is that of the solves
  return static_cast<Index>(made->dependent_rows().size());
}

Verdict same_number(const OperatorRow& op, const Case& c, const Problem<double>& p, const Damping<double>& d) {
  const Index here = left_out(op, c.problem, c.damping), there = left_out(op, p, d);
  return here == there ? Verdict{} : failure(std::to_string(here) + " rows left out, " + std::to_string(there) + " in the other description");
}

Verdict in_turned_axes(const OperatorRow& op, const Case& c) {
  return same_number(op, c, generators::turned(c.problem, c.seed + 1), c.damping);
}

Verdict in_another_order(const OperatorRow& op, const Case& c) {
  const Second<double> second = reordered(c.problem, c.damping, c.seed);
  return same_number(op, c, second.numbers.problem, second.numbers.damping);
}

/// Every row in a unit of its own, from 2⁻²⁰ to 2²⁰, hard ones among them only.
Verdict in_units_by_row(const OperatorRow& op, const Case& c) {
  const Structure& s = *c.problem.structure;
  Problem<double> p = c.problem;
  const auto unit = [&](Index row) { return std::ldexp(1.0, static_cast<int>((static_cast<std::uint64_t>(row) * 7 + c.seed) % 41) - 20); };
  const auto hard = [&](Index row, Index rows) {
    return std::all_of(c.damping.diagonal.begin() + row, c.damping.diagonal.begin() + row + rows, [](double x) { return x == 0; }) &&
           std::none_of(c.damping.blocks.begin(), c.damping.blocks.end(), [&](const auto& b) { return b.row >= row && b.row < row + rows; });
  };
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows && hard(e.row, e.rows); ++r) p.K[static_cast<std::size_t>(link.first + r)] *= unit(e.row + r);
  for (const auto& j : s.joint_constraints)
    for (Index k = 0; k < j.rows * s.dofs(j.body) && hard(j.row, j.rows); ++k)
      p.joint_K[static_cast<std::size_t>(j.first + k)] *= unit(j.row + k / s.dofs(j.body));
  return same_number(op, c, p, c.damping);
}

const char* why_not_answered(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not_rank(op, c)) return reason;
  return why_no_bound(Function::apply, c);
}

/// f of an acceleration that forces can cause; A f by the definition.
Verdict answered_on_all_rows(const OperatorRow& op, const Case& c) {
  const MatrixX<double> x = vectors<double>(c.rows(), 2, c.seed);
  const MatrixX<Quad>& A = definition<double>(Function::apply, c);
  const MatrixX<Quad> caused = reference::product<Quad>(A, converted<Quad>(x));
  const MatrixX<double> a = converted<double>(caused);
  const MatrixX<double> f = Route<double>(op, c.problem, c.damping).narrow(Function::solve, a);
  const MatrixX<Quad> error = reference::product<Quad>(A, converted<Quad>(f)) - converted<Quad>(a);
  MatrixX<Quad> bound = error_bound(Function::apply, op, c, f) + error_bound(Function::apply, op, c, x);
  for (Index k = 0; k < bound.size(); ++k) bound.data()[k] += abs(Quad(a.data()[k]));
  return judge(error, bound, unit_roundoff<double>, "apply_sensitivity");
}

}  // namespace

std::vector<LawRow> rank_laws() {
  constexpr const char* equal = "equality";
  return {
      {"rank in turned axes", "hard rows left out: as many as in axes turned by a random rotation", equal, why_not_rank, in_turned_axes},
      {"rank reordered", "hard rows left out: as many as with constraints in another order", equal, why_not_rank, in_another_order},
      {"rank in other units", "hard rows left out: as many as with every row in a unit of its own", equal, why_not_rank, in_units_by_row},
      {"consistent rows answered", "hard rows, a = A x: A f = a on all rows, those left out too", of_apply, why_not_answered, answered_on_all_rows},
  };
}

}  // namespace delassus::laws
