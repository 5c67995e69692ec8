#include "algorithms/kit/test_scalars.h"
#include "bench/cell.h"

#include "algorithms/mechanism/mechanism.h"

namespace delassus::bench {

namespace {

/// Runs the timings of one cell; the operator and its vectors live here.
class Stand {
 public:
  Stand(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping)
      : row_(row), problem_(problem), damping_(damping), other_(other_damping(damping)), op_(row.make<double>()) {}

  Cell run(const Limits& limits) {
    Cell cell;
    cell.op = std::string(row_.name);
    cell.time.analyze = stopwatch([&] { row_.make<double>()->analyze(problem_.structure); }, limits.budget);
    op_->analyze(problem_.structure);
    cell.bytes = op_->bytes();
    cell.workspace_bytes = op_->workspace() * static_cast<Index>(sizeof(double));
    Report report;
    cell.time.update = stopwatch([&] { report = op_->update(problem_, damping_); }, limits.budget);
    cell.update_status = std::string(name(report.status));
    vectors(cell, limits);
    return cell;
  }

 private:
  void vectors(Cell& cell, const Limits& limits) {
    const Index m = op_->size();
    const MatrixX<double> in = sample_vector(m);
    MatrixX<double> out = MatrixX<double>::Zero(m, 1);
    Workspace<double> workspace(op_->workspace());
    Report report;
    if (row_.applies) cell.time.apply = stopwatch([&] { report = op_->apply(in, out, workspace); }, limits.budget);
    if (row_.solves) {
      cell.time.solve = stopwatch([&] { report = op_->solve(in, out, workspace); }, limits.budget);
      cell.solve_status = std::string(name(report.status));
      if (row_.solve_error == ErrorClass::refined)
        cell.time.unrefined = stopwatch([&] { static_cast<void>(op_->solve(in, out, Accuracy::fastest(), workspace)); }, limits.budget);
    }
    bool odd = false;  // two dampings in turn, so that no call finds the numbers it already has
    cell.time.new_damping =
        stopwatch([&] { report = op_->update_damping((odd = !odd) ? other_ : damping_); }, limits.budget);
  }

  const OperatorRow& row_;
  const Problem<double>& problem_;
  const Damping<double>& damping_;
  const Damping<double> other_;
  std::unique_ptr<Operator<double>> op_;
};

template <class F> std::int64_t counted(F&& f) {
  const std::int64_t before = operation_count.total();
  f();
  return operation_count.total() - before;
}

}  // namespace

Operations count_operations(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping) {
  if (!std::get<Maker<Counted>>(row.makers)) return {};
  const Problem<Counted> p = problem.cast<Counted>();
  const Damping<Counted> d = damping.cast<Counted>();
  const Damping<Counted> d2 = other_damping(damping).cast<Counted>();
  const auto op = row.make<Counted>();
  op->analyze(p.structure);
  const Index m = op->size();
  const MatrixX<Counted> in = sample_vector(m).unaryExpr([](double x) { return Counted(x); });
  MatrixX<Counted> out = MatrixX<Counted>::Zero(m, 1);
  Workspace<Counted> workspace(op->workspace());
  Operations n;
  Report report;
  n.update = counted([&] { report = op->update(p, d); });
  if (row.applies) n.apply = counted([&] { report = op->apply(in, out, workspace); });
  if (row.solves) n.solve = counted([&] { report = op->solve(in, out, workspace); });
  n.new_damping = counted([&] { report = op->update_damping(d2); });
  return n;
}

Cell measure(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping,
             const Limits& limits) {
  Cell cell = Stand(row, problem, damping).run(limits);
  const Phases& t = cell.time;
  double total = t.update.lowest;
  for (const Timing& x : {t.apply, t.solve})
    if (x.measured()) total += x.lowest;
  if (1e-6 * total < limits.longest_counted) cell.operations = count_operations(row, problem, damping);
  return cell;
}

Timing time_kinematics(const Model& model, const VectorX<double>& q, double budget) {
  Mechanism<double> mechanism(model);
  Problem<double> problem(mechanism.structure());
  return stopwatch([&] {
    mechanism.update(q);
    mechanism.fill(problem);
  }, budget);
}

}  // namespace delassus::bench
