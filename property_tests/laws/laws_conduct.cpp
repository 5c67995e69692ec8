#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_conduct.h"

#include <cmath>
#include <limits>

#include "property_tests/laws/route.h"

namespace delassus::laws {

std::int64_t (*allocation_count)() = nullptr;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Both within the bound of one of them.
Verdict close(Function f, const OperatorRow& op, const Case& c, const MatrixX<double>& x, const MatrixX<double>& first,
              const MatrixX<double>& second) {
  return agree<double>(converted<Quad>(first), converted<Quad>(second), bound_name(f, op),
                       [&] { return error_bound(f, op, c, x); });
}

const Case& hard(const Case& c) {
  return variant(c, "first constraint hard", [](const Case& of) {
    return Variant<double>{of.problem, first_constraint_hard(*of.problem.structure, of.damping)};
  }, Data::given);
}

/// The rows of the first constraint, in order of rows: [0, end).
Index first_constraint_rows(const Structure& s) {
  for (const auto& e : s.link_constraints)
    if (e.row == 0) return e.rows;
  for (const auto& e : s.joint_constraints)
    if (e.row == 0) return e.rows;
  return 0;
}

Report call(Function f, const Operator<double>& op, const MatrixX<double>& x, MatrixX<double>& y, Workspace<double>& w) {
  return f == Function::apply ? op.apply(x, y, w) : op.solve(x, y, w);
}

}  // namespace

template <Function F> Verdict multi_column(const OperatorRow& op, const Case& c) {
  const Route<double> route(op, c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 5, c.seed);
  MatrixX<double> single(x.rows(), x.cols());
  for (Index k = 0; k < x.cols(); ++k) single.col(k) = route.narrow(F, x.col(k));
  return close(F, op, c, x, route.narrow(F, x), single);
}

template <Function F> Verdict update_twice(const OperatorRow& op, const Case& c) {
  const Variant<double> other = other_numbers(c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  Route<double> used(op, other.problem, other.damping);
  static_cast<void>(used.run(F, x));
  used.updated() = used.get().update(c.problem, c.damping);
  return judge_runs(used.run(F, x), Route<double>(op, c.problem, c.damping).run(F, x));
}

template <Function F> Verdict damping_update(const OperatorRow& op, const Case& c) {
  const Damping<double> other = other_damping(*c.problem.structure, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  Route<double> used(op, c.problem, other);
  used.updated() = used.get().update_damping(c.damping);
  return close(F, op, c, x, used.narrow(F, x), Route<double>(op, c.problem, c.damping).narrow(F, x));
}

template <Function F> Verdict poisoned_workspace(const OperatorRow& op, const Case& c) {
  Route<double> route(op, c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 5, c.seed);  // more than go one by one
  Workspace<double> w(route.get().workspace(5));
  w.fill(0);
  const Ran<double> clean = route.run(F, x, w);
  w.fill(nan);
  Ran<double> poisoned{route.updated(), {}, MatrixX<double>::Constant(x.rows(), x.cols(), nan)};
  const MatrixX<double> copy = x;
  poisoned.called = call(F, route.get(), x, poisoned.y, w);
  return worst(judge_runs(clean, poisoned), judge_bits(copy, x));
}

template <Function F> Verdict nan_stays(const OperatorRow& op, const Case& c) {
  Route<double> route(op, c.problem, c.damping);
  const Index m = c.rows(), at = static_cast<Index>(c.seed % static_cast<std::uint64_t>(m));
  MatrixX<double> x = vectors<double>(m, 1, c.seed), y = MatrixX<double>::Zero(m, 1);
  x(at, 0) = nan;
  Workspace<double> w(route.get().workspace(1));
  if (call(F, route.get(), x, y, w).ok()) return failure("status ok for a NaN in the vector");
  if (!std::isnan(y(at, 0))) return failure("a NaN in row " + std::to_string(at) + " gives a number there");

  Problem<double> p = c.problem;
  if (p.K.empty()) return {0, "NaN", -1, {}};
  const Structure& s = *p.structure;
  Index freedoms = 0;  // of the body K[0] acts on: one that nothing moves never reads its K
  for (Index i = s.link_constraints[0].links[0].body; i != ground; i = s.parent[i]) freedoms += s.dofs(i);
  if (freedoms == 0) return {0, "NaN", -1, {}};
  p.K[0][static_cast<Index>(c.seed % 6)] = nan;
  const Report updated = route.get().update(p, c.damping);
  const Report r = call(F, route.get(), vectors<double>(m, 1, c.seed), y, w);
  if (updated.ok() && r.ok()) return failure("status ok for a NaN in K");
  const Index row = c.problem.structure->link_constraints[0].row;
  return std::isnan(y(row, 0)) ? Verdict{0, "NaN", -1, {}} : failure("a NaN in K gives a number in its row");
}

namespace {
std::string outcome(const Report& r) { return std::string(name(r.status)) + " after " + std::to_string(r.iterations); }
}  // namespace

Verdict few_steps(const OperatorRow& op, const Case& c) {
  Route<double> route(op, c.problem, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  Workspace<double> w(route.get().workspace(1));
  const auto solved = [&](int steps) {
    MatrixX<double> y = MatrixX<double>::Constant(x.rows(), 1, nan);
    const Report report = route.get().solve(x, y, {0, steps}, w);
    return std::pair(report, y);
  };
  const auto [report, y] = solved(std::numeric_limits<int>::max());
  const auto [enough, same] = solved(report.iterations);
  if (enough.status != report.status || enough.iterations != report.iterations)
    return failure(outcome(report) + "; with as many steps allowed: " + outcome(enough));
  const Verdict bits = judge_bits(y, same);
  if (report.iterations == 0 || !bits.passed()) return bits;
  const auto [fewer, other] = solved(report.iterations - 1);
  if (fewer.iterations >= report.iterations) return failure("takes more steps than it may");
  if (fewer.status == Status::not_converged || !report.ok()) return bits;
  if (!fewer.ok()) return failure("one step fewer: " + std::string(name(fewer.status)));
  if (why_not<double>(Function::solve, op, c)) return bits;
  return worst(bits, close(Function::solve, op, c, x, y, other));
}

const char* why_not_allocation(const OperatorRow& op, const Case& c) {
  if (!allocation_count) return "this program does not count allocations";
  if (c.rows() == 0) return "no rows";
  return op.applies || op.solves ? nullptr : "has no function";
}

Verdict no_allocation(const OperatorRow& op, const Case& c) {
  const auto operation = op.make<double>();
  operation->analyze(c.problem.structure);
  const Damping<double> other = other_damping(*c.problem.structure, c.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 5, c.seed);
  MatrixX<double> y(c.rows(), 5);
  Workspace<double> w(operation->workspace(5));
  const MatrixX<double> r1 = vectors<double>(c.problem.structure->dofs(), 5, c.seed + 1);
  MatrixX<double> nu = r1;
  Workspace<double> of_pairs(operation->kkt_workspace());
  const char* phases[] = {"update", "update_rows", "update_damping", "apply", "solve", "solve_kkt"};
  for (int step = op.grows ? -6 : 0; step < 6; ++step) {  // who grows is asked twice
    const int phase = (step + 6) % 6;
    const std::int64_t before = allocation_count();
    if (phase == 0) static_cast<void>(operation->update(c.problem, c.damping));
    if (phase == 1) static_cast<void>(operation->update_rows(c.problem, c.damping));
    if (phase == 2) static_cast<void>(operation->update_damping(other));
    if (phase == 3 && op.applies) static_cast<void>(operation->apply(x, y, w));
    if (phase == 4 && op.solves) static_cast<void>(operation->solve(x, y, w));
    if (phase == 5 && op.solves) static_cast<void>(operation->solve_kkt(r1, x, nu, y, Accuracy::full(), of_pairs));
    const std::int64_t count = allocation_count() - before;
    if (step >= 0 && count != 0) return failure(std::string(phases[phase]) + " allocates " + std::to_string(count) + " times", "zero");
  }
  return {0, "zero", -1, {}};
}

const char* why_not_zero_columns(const OperatorRow& op, const Case&) {
  return op.applies || op.solves ? nullptr : "has no function";
}

Verdict empty_sizes(const OperatorRow& op, const Case& c) {
  Route<double> route(op, c.problem, c.damping);
  if (c.rows() == 0 && !route.updated().ok()) throw Broken("update without rows", route.updated());
  if (route.get().size() != c.rows()) return failure("size is not the number of rows");
  for (const Index columns : {Index(0), Index(2)}) {
    if (columns > 0 && c.rows() > 0) continue;
    const MatrixX<double> x(c.rows(), columns);
    MatrixX<double> y(c.rows(), columns);
    Workspace<double> w(route.get().workspace(columns));
    if (op.applies && !route.get().apply(x, y, w).ok()) return failure("apply of nothing is not ok");
    if (op.solves && !route.get().solve(x, y, w).ok()) return failure("solve of nothing is not ok");
  }
  return {0, "zero", -1, {}};
}

const char* why_not_zero_damping(const OperatorRow& op, const Case& c) {
  if (c.rows() == 0) return "no rows";
  if (!op.solves) return "has no solve";
  if (!op.zero_damping) return nullptr;
  return why_not<double>(Function::solve, op, hard(c));
}

Verdict zero_damping(const OperatorRow& op, const Case& c) {
  const Case& h = hard(c);
  if (op.zero_damping) return is_definition<double, Function::solve>(op, h);
  Route<double> route(op, h.problem, h.damping);
  const MatrixX<double> x = vectors<double>(c.rows(), 1, c.seed);
  MatrixX<double> y = MatrixX<double>::Zero(c.rows(), 1);
  Workspace<double> w(route.get().workspace(1));
  const Report solved = route.get().solve(x, y, w);
  const Report& r = route.updated().ok() ? solved : route.updated();
  if (r.status != Status::zero_damping || solved.ok()) return failure("zero damping gives " + std::string(name(r.status)));
  const Index named = static_cast<Index>(r.where);
  if (named < 0 || named >= c.rows()) return failure("zero damping refused without naming a row");
  if (damped(c) && named >= first_constraint_rows(*c.problem.structure)) return failure("zero damping names another row");
  return y.array().isNaN().all() ? Verdict{0, "refused by name", -1, {}} : failure("refused, but the result is not NaN");
}

#define DELASSUS_LAWS(F)                                                          \
  template Verdict multi_column<F>(const OperatorRow&, const Case&);              \
  template Verdict update_twice<F>(const OperatorRow&, const Case&);              \
  template Verdict damping_update<F>(const OperatorRow&, const Case&);            \
  template Verdict poisoned_workspace<F>(const OperatorRow&, const Case&);        \
  template Verdict nan_stays<F>(const OperatorRow&, const Case&);
DELASSUS_LAWS(Function::apply)
DELASSUS_LAWS(Function::solve)
#undef DELASSUS_LAWS

}  // namespace delassus::laws
