#include "algorithms/kit/test_scalars.h"
#include "bench/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/operators/lcaba_refined.h"
#include "bench/stopwatch.h"
#include "bench/text.h"
#include "reference/kkt_cholmod.h"

namespace delassus::accuracy {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Errors no_errors{nan, nan, nan, nan};
constexpr double longest_counted = 0.1;  // [s]: counting takes several times the time of a solve

template <class T> VectorX<Quad> wide(const MatrixX<T>& x) {
  VectorX<Quad> y(x.rows());
  for (Index r = 0; r < x.rows(); ++r) y[r] = scalar_cast<Quad>(x(r, 0));
  return y;
}

/// The motion a refined solve ends with, which is more accurate than M⁻¹Jᵀλ of its rounded λ; empty for other operators.
template <class T> VectorX<Quad> own_motion(const Operator<T>& op, const MatrixX<T>& a, Workspace<T>& workspace) {
  const auto* refined = dynamic_cast<const LcabaRefined<T>*>(&op);
  if (!refined) return {};
  MatrixX<T> f(a.rows(), 1), nu = MatrixX<T>::Constant(op.structure()->dofs(), 1, T(0));
  static_cast<void>(refined->solve_with_motion(a.data(), f.data(), nu.data(), Accuracy::full(), workspace.data()));
  return wide(nu);
}

/// One operator in one scalar on one problem.
template <class T> class PhaseRun {
 public:
  PhaseRun(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a, Accuracy wanted)
      : op_(row.make<T>()), problem_(problem.cast<T>()), damping_(damping.cast<T>()), wanted_(wanted) {
    op_->analyze(problem_.structure);
    workspace_ = std::make_unique<Workspace<T>>(op_->workspace());
    a_.resize(a.size(), 1);
    for (Index r = 0; r < a.size(); ++r) a_(r, 0) = scalar_cast<T>(a[r]);
    f_ = a_;
  }
  Report solve() { return op_->solve(a_, f_, wanted_, *workspace_); }
  Report both() {
    const Report updated = op_->update(problem_, damping_);
    return updated.ok() ? solve() : updated;
  }
  Answer answer() { return {wide(f_), own_motion(*op_, a_, *workspace_)}; }

 private:
  std::unique_ptr<Operator<T>> op_;
  Problem<T> problem_;
  Damping<T> damping_;
  Accuracy wanted_;
  MatrixX<T> a_, f_;
  std::unique_ptr<Workspace<T>> workspace_;
};

template <class T> void time(PhaseRun<T>& run, double budget, Cell& cell) {
  Report ignored;
  cell.time = bench::stopwatch([&] { ignored = run.both(); }, budget).lowest;
  cell.solve = bench::stopwatch([&] { ignored = run.solve(); }, budget).lowest;
}

/// One level of one subject.
struct Question {
  const Problem<double>& problem;
  const Damping<double>& damping;
  const VectorX<double>& a;
  const Truth& truth;
  const Options& options;
};

template <class T> Cell measure(const Rung& rung, const Question& q) {
  Cell cell;
  cell.rung = rung.name;
  cell.style = rung.style;
  PhaseRun<T> run(*rung.row, q.problem, q.damping, q.a, rung.wanted);
  const Report report = run.both();
  cell.status = std::string(name(report.status));
  cell.iterations = report.iterations;
  cell.error_bound = report.error_bound;
  cell.error_estimate = report.error_estimate;
  const bool answered = report.ok() || report.status == Status::not_converged;
  cell.errors = answered ? q.truth.errors_of(run.answer()) : no_errors;
  cell.time = cell.solve = std::nan("");
  if (!answered || q.options.budget == 0) return cell;
  time(run, q.options.budget, cell);
  if (rung.arithmetic == Arithmetic::in_double && 1e-6 * cell.time < longest_counted)
    cell.operations = operations(*rung.row, q.problem, q.damping, q.a, rung.wanted, report);
  return cell;
}

Cell measure_sparse(const Rung& rung, const Question& q) {
  Cell cell;
  cell.rung = rung.name;
  cell.style = rung.style;
  cell.time = cell.solve = std::nan("");
  reference::SparseKkt sparse(q.problem, q.damping);
  const bool factored = sparse.update(q.problem, q.damping);
  cell.status = std::string(name(factored ? Status::ok : Status::lost_pivot));
  cell.errors = factored ? q.truth.errors_of({sparse.solve(q.a).cast<Quad>(), {}}) : no_errors;
  if (!factored || q.options.budget == 0) return cell;
  const auto solve = [&] { static_cast<void>(sparse.solve(q.a)); };
  const auto both = [&] {
    static_cast<void>(sparse.update(q.problem, q.damping));
    solve();
  };
  cell.time = bench::stopwatch(both, q.options.budget).lowest;
  cell.solve = bench::stopwatch(solve, q.options.budget).lowest;
  cell.operations = static_cast<std::int64_t>(sparse.operations());
  return cell;
}

Cell measure(const Rung& rung, const Subject& subject, const Question& q) {
  switch (rung.arithmetic) {
    case Arithmetic::in_float: return measure<float>(rung, q);
    case Arithmetic::in_quad: return measure<Quad>(rung, q);
    case Arithmetic::about_world_origin: {
      const Question in_world{subject.world, q.damping, q.a, q.truth, q.options};
      return measure<double>(rung, in_world);
    }
    case Arithmetic::by_cholmod: return measure_sparse(rung, q);
    case Arithmetic::in_double: break;
  }
  return measure<double>(rung, q);
}

}  // namespace

std::int64_t operations(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a,
                        Accuracy wanted, const Report& in_double) {
  if (!std::get<Maker<Counted>>(row.makers)) return -1;
  PhaseRun<Counted> run(row, problem, damping, a, {wanted.error, in_double.iterations});
  const std::int64_t before = operation_count.total();
  const Report report = run.both();
  return (report.ok() || report.status == Status::not_converged) && report.iterations == in_double.iterations && report.rung == in_double.rung ? operation_count.total() - before : -1;
}

std::vector<Rung> rungs(const std::vector<std::string>& names) {
  std::vector<Rung> all;
  int style = 0;
  for (const OperatorRow& row : operators())
    if (row.solves) all.push_back({std::string(row.name), &row, Arithmetic::in_double, style++});
  const OperatorRow* lcaba = &find_operator(fast_rung);
  all.push_back({"lcaba, float", lcaba, Arithmetic::in_float, style++});
  all.push_back({"lcaba, quad", lcaba, Arithmetic::in_quad, style++});
  all.push_back({world_rung, lcaba, Arithmetic::about_world_origin, style++});
  all.push_back({sparse_rung, nullptr, Arithmetic::by_cholmod, style++});
  const OperatorRow* asked = &find_operator(default_rung);
  for (const double error : {1e-12, 1e-8, 1e-4})
    all.push_back({bench::format("%s to %g", default_rung, error), asked, Arithmetic::in_double, -1, {error}});
  all.push_back({std::string(default_rung) + ", fastest", asked, Arithmetic::in_double, -1, Accuracy::fastest()});
  if (names.empty()) return all;
  std::vector<Rung> chosen;
  for (const std::string& wanted : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Rung& r) { return r.name == wanted; });
    if (found == all.end()) throw ModelError("", "--op", "there is no rung " + in_quotes(wanted), accepted_names(wanted, all) + "; quote names that hold blanks");
    chosen.push_back(*found);
  }
  return chosen;
}

const Cell* Level::find(std::string_view rung) const {
  for (const Cell& c : cells)
    if (c.rung == rung) return &c;
  return nullptr;
}

std::vector<double> dampings_up_to(double largest) {
  std::vector<double> d;
  for (int decade = -14; std::pow(10.0, decade) <= largest * 1.000001; decade += 2) d.push_back(std::stod(bench::format("1e%d", decade)));
  return d;
}

Table measure(const Subject& subject, const std::vector<Rung>& rungs, const Options& options) {
  Table table{subject.name, subject.is_scene, subject.dofs(), subject.rows(), subject.away, {}};
  const VectorX<double> a = options.random_right_side ? random_acceleration(subject.rows(), options.seed)
                                                      : consistent_acceleration(subject.problem, options.seed);
  std::set<std::string> too_slow;
  for (const double d : options.dampings) {
    if (options.stop && options.stop()) break;
    const Damping<double> damping = d == own_damping ? subject.damping : Damping<double>::uniform(subject.rows(), d);
    const Truth truth(subject.problem, damping, a);
    Level level{d, truth.largest_eigenvalue(), truth.condition(), truth.bound(), truth.disagreement(), truth.why_not(), {}};
    const Question question{subject.problem, damping, a, truth, options};
    for (const Rung& rung : rungs) {
      if (too_slow.count(rung.name) || (options.stop && options.stop())) continue;
      const auto start = std::chrono::steady_clock::now();
      level.cells.push_back(measure(rung, subject, question));
      if (rung.name != default_rung && bench::seconds_since(start) > options.longest + 4 * options.budget) too_slow.insert(rung.name);
    }
    table.levels.push_back(std::move(level));
  }
  return table;
}

}  // namespace delassus::accuracy
