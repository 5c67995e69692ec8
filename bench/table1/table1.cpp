#include "bench/table1/table1.h"

#include <algorithm>
#include <cstdlib>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/mechanism.h"
#include "bench/accuracy/accuracy_truth.h"
#include "bench/table1/cache_lines.h"
#include "bench/machine.h"
#include "bench/page/scene_facts.h"
#include "bench/table1/table1_paper.h"
#include "bench/text.h"
#include "reference/reference.h"

namespace delassus::bench {

double Entry::worst_error() const {
  double worst = NAN;
  for (const double e : {product_error, force_error, motion_error})
    if (!std::isnan(e)) worst = std::isnan(worst) ? e : std::max(worst, e);
  return worst;
}

const Entry* TableRow::find(const std::string& op) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.op == op; });
  return found == entries.end() ? nullptr : &*found;
}

const Entry* TableRow::best(Use use, bool is_explicit) const {
  const Entry* best = nullptr;
  for (const Entry& e : entries)
    if (e.is_explicit == is_explicit && e.has(use) && (!best || e.median(use) < best->median(use))) best = &e;
  return best;
}

double crossover(const TableRow& row, Use first, Use again) {
  double least = NAN;
  for (const Entry& e : row.entries) {
    if (!e.is_explicit || !e.has(first) || !e.has(again)) continue;
    double from = 1;  // where it beats every matrix-free one
    for (const Entry& m : row.entries) {
      if (m.is_explicit || !m.has(first) || !m.has(again)) continue;
      const double more = e.median(first) - m.median(first), saved = m.median(again) - e.median(again);
      const double beats = more <= 0 ? (saved >= 0 ? 1 : NAN) : saved > 0 ? 1 + more / saved : NAN;
      from = std::isnan(beats) ? NAN : std::max(from, beats);
      if (std::isnan(from)) break;
    }
    if (!std::isnan(from)) least = std::isnan(least) ? from : std::min(least, from);
  }
  return std::isnan(least) ? least : std::ceil(least);
}

namespace {

using Operators = std::vector<const OperatorRow*>;

VectorX<Quad> in_quad(const MatrixX<double>& x) { return x.col(0).unaryExpr([](double e) { return Quad(e); }); }

double relative_largest(const MatrixX<double>& x, const MatrixX<Quad>& truth) {
  Quad off(0), most(0);
  for (Index i = 0; i < truth.rows(); ++i) {
    off = std::max(off, abs(Quad(x(i, 0)) - truth(i, 0)));
    most = std::max(most, abs(truth(i, 0)));
  }
  return off == Quad(0) ? 0 : static_cast<double>(off / most);
}

struct Subject {
  Problem<double> problem;
  const Damping<double>& damping;
  MatrixX<double> x;
};

/// Errors of the answers taken before anything was timed.
void judge(const std::vector<std::unique_ptr<Asked>>& asked, const Subject& s, TableRow& row) {
  MatrixX<Quad> product;
  for (const auto& reference : reference::references()) {
    if (!reference.trusts(s.problem, s.damping)) continue;
    product = reference.apply(s.problem, s.damping, s.x);
    row.product_reference = std::string(reference.name);
    break;
  }
  const accuracy::Truth truth(s.problem, s.damping, s.x.col(0));
  row.truth_unknown = truth.why_not();
  row.condition = truth.condition();
  for (std::size_t i = 0; i < asked.size(); ++i) {
    Entry& e = row.entries[i];
    if (asked[i]->why_not(Use::apply).empty() && product.size() > 0) e.product_error = relative_largest(asked[i]->product(), product);
    if (!asked[i]->why_not(Use::solve).empty()) continue;
    e.bound = asked[i]->solved().error_bound;
    if (!truth.known()) continue;
    const accuracy::Errors errors = truth.errors_of({in_quad(asked[i]->solution()), {}});
    e.force_error = errors.lambda;
    e.motion_error = errors.motion;
  }
}

void time_all(const std::vector<std::unique_ptr<Asked>>& asked, double budget, Mechanism<double>& mechanism, const VectorX<double>& q, TableRow& row) {
  Problem<double> problem(mechanism.structure());
  std::vector<std::function<void()>> tasks{[&] { mechanism.update(q), mechanism.fill(problem); }};
  std::vector<Spread*> to{&row.kinematics};
  for (std::size_t i = 0; i < asked.size(); ++i)
    for (std::size_t u = 0; u < use_count; ++u) {
      row.entries[i].why_not[u] = asked[i]->why_not(use(u));
      if (!row.entries[i].why_not[u].empty()) continue;
      tasks.push_back([&op = *asked[i], u] { op.ask(use(u)); });
      to.push_back(&row.entries[i].time[u]);
    }
  const auto times = in_rounds(tasks, budget);
  for (std::size_t k = 0; k < to.size(); ++k) *to[k] = spread_of(times[k]);
  const auto rounds_of = [&](const Entry& e, Use use) { return std::find(to.begin(), to.end(), &e.time[static_cast<std::size_t>(use)]) - to.begin(); };
  for (Entry& e : row.entries)
    if (e.has(Use::first_apply) && e.has(Use::first_solve))  // the factor of A is none of a product's
      e.time[static_cast<std::size_t>(Use::first_apply)] = difference(times[rounds_of(e, Use::first_apply)], times[rounds_of(e, Use::damping_alone)]);
}

}  // namespace

TableRow measure_row(const Scene& scene, const Operators& ops, double budget) {
  const SceneResult facts = facts_of(scene, false);
  TableRow row;
  row.scene = scene.name;
  row.dofs = facts.dofs;
  row.rows = facts.rows;
  row.loops = facts.has_loops;
  row.provisional_pose = facts.provisional_pose;
  row.smallest_damping = facts.smallest_damping;
  row.largest_damping = facts.largest_damping;
  Subject s{problem_of(scene), scene.damping, {}};
  s.x = accuracy::consistent_acceleration(s.problem, 1);
  std::vector<std::unique_ptr<Asked>> asked;
  for (const OperatorRow* op : ops) {
    asked.push_back(std::make_unique<Asked>(*op, s.problem, s.damping, s.x));
    Entry& e = row.entries.emplace_back();
    e.op = std::string(op->name);
    e.is_explicit = op->holds != Holds::sparse;
    e.bytes = asked.back()->bytes();
  }
  judge(asked, s, row);
  Mechanism<double> mechanism(scene.model);
  time_all(asked, budget, mechanism, scene.q, row);
  return row;
}

TableOne measure_table(const TableOptions& options, const std::function<void(const std::string&)>& progress) {
  TableOne t;
  t.machine = this_machine();
  t.kernels = std::string(kernels());
  t.budget = options.budget;
  if (double load[1]; getloadavg(load, 1) == 1) t.load = load[0];
  Operators ops = options.ops;
  if (ops.empty())
    for (const OperatorRow& row : operators()) ops.push_back(&row);
  std::vector<std::string> names = options.scenes;
  if (names.empty())
    for (const PaperRow& row : paper_rows()) names.emplace_back(row.scene);
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& name : names) {
    if (options.stop && options.stop()) {
      t.interrupted = true;
      break;
    }
    t.rows.push_back(measure_row(open_scene(name), ops, options.budget));
    if (!options.probe.empty()) t.lines_counted_with = count_cache_lines(options.probe, t.rows.back());
    progress(format("%2zu/%zu  %s  %zu operators  %.0f s", t.rows.size(), names.size(), pad_right(name, 26).c_str(), ops.size(), seconds_since(start)));
  }
  return t;
}

}  // namespace delassus::bench
