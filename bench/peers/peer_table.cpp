#include "bench/peers/peer_table.h"

#include <algorithm>
#include <optional>

#include "algorithms/mechanism/mechanism.h"
#include "bench/accuracy/accuracy_truth.h"
#include "bench/machine.h"
#include "bench/page/scene_facts.h"
#include "bench/text.h"
#include "bench/table1/uses.h"
#include "reference/definition.h"
#include "reference/reference.h"

namespace delassus::bench {

namespace {

using Vector = VectorX<double>;
using accuracy::Truth;

std::size_t at(Step s) { return static_cast<std::size_t>(s); }
bool is_first(Step s) { return s == Step::first_product || s == Step::first_solve; }
bool is_product(Step s) { return s == Step::first_product || s == Step::product; }

VectorX<Quad> in_quad(const Vector& x) { return x.unaryExpr([](double e) { return Quad(e); }); }

/// What the answers are held to.
struct Expected {
  Problem<double> problem;
  const Damping<double>& damping;
  const Damping<double> other;
  Vector x;
  MatrixX<Quad> M, product;
  Truth solution, other_solution;
  double product_limit = 0, force_limit = 0;

  explicit Expected(const Scene& scene)
      : problem(problem_of(scene)), damping(scene.damping), other(other_damping(damping)), x(accuracy::consistent_acceleration(problem, 1)),
        M(reference::mass_matrix(problem.cast<Quad>())), solution(problem, damping, x), other_solution(problem, other, x) {
    for (const auto& reference : reference::references())
      if (product.size() == 0 && reference.trusts(problem, damping)) product = reference.apply(problem, damping, x);
    if (product.size() == 0 || !solution.known()) throw ModelError("", "scene " + scene.name, "has no reference: " + solution.why_not(), "a scene with one; give every row a damping");
    product_limit = of_product(product_otherwise()) / 30;
    force_limit = of_solution(solved_otherwise(), solution) / 30;
  }

  // With the other damping.
  [[nodiscard]] Vector product_otherwise() const {
    Vector a = product.unaryExpr([](const Quad& e) { return static_cast<double>(e); });
    for (Index r = 0; r < a.size(); ++r) a[r] += (other.diagonal[static_cast<std::size_t>(r)] - damping.diagonal[static_cast<std::size_t>(r)]) * x[r];
    for (std::size_t k = 0; k < damping.blocks.size(); ++k) {
      const MatrixX<double> more = other.blocks[k].R_inverse - damping.blocks[k].R_inverse;
      a.segment(damping.blocks[k].row, more.rows()) += more * x.segment(damping.blocks[k].row, more.rows());
    }
    return a;
  }
  [[nodiscard]] Vector solved_otherwise() const {
    const auto op = find_operator(certified_default).make<double>();
    op->analyze(problem.structure);
    Workspace<double> workspace(op->workspace());
    MatrixX<double> lambda = MatrixX<double>::Zero(x.size(), 1);
    if (!op->update(problem, other).ok() || !op->solve(MatrixX<double>(x), lambda, workspace).ok()) return x * NAN;
    return lambda;
  }

  /// NaN is an error, too, and the largest.
  [[nodiscard]] double of_product(const Vector& a) const {
    Quad off(0), most(0);
    for (Index r = 0; r < a.size(); ++r) {
      if (std::isnan(a[r])) return INFINITY;
      off = std::max(off, abs(Quad(Quad(a[r]) - product(r, 0))));
      most = std::max(most, abs(product(r, 0)));
    }
    return static_cast<double>(off / most);
  }
  [[nodiscard]] double of_solution(const Vector& lambda, const Truth& truth) const {
    return lambda.hasNaN() ? INFINITY : truth.errors_of({in_quad(lambda), {}}).lambda;
  }
  [[nodiscard]] double of_M(const MatrixX<double>& theirs) const {
    if (theirs.rows() != M.rows() || theirs.cols() != M.cols() || theirs.hasNaN()) return INFINITY;
    double worst = 0;
    for (Index j = 0; j < M.cols(); ++j)
      for (Index i = 0; i < M.rows(); ++i) {
        const Quad off = abs(Quad(Quad(theirs(i, j)) - M(i, j)));
        worst = std::max(worst, static_cast<double>(off) / std::sqrt(static_cast<double>(M(i, i)) * static_cast<double>(M(j, j))));
      }
    return worst;
  }
};

struct Turn {
  Step step;
  bool other;  ///< damping
};
/// What is compared, in this order.
template <class Row> std::vector<Turn> turns(const Row& row) {
  std::vector<Turn> all;
  if (!row.product.empty()) all = {{Step::first_product, false}, {Step::product, false}};
  if (!row.solve.empty())
    for (const Turn t : {Turn{Step::first_solve, false}, {Step::solve, false}, {Step::new_damping, true}, {Step::solve, true}, {Step::new_damping, false}, {Step::first_solve, false}}) all.push_back(t);
  return all;
}

/// An answer that is not near enough.
struct Wrong {
  std::size_t turns = 0;  ///< up to it; none: it is M
  Vector answer;
  double error = 0;
};

/// Fills the errors; the first that is too large ends it.
std::optional<Wrong> compare(Peer& peer, const Expected& e, PeerEntry& entry) {
  const auto agrees = [&](const char* what, double error, double most, double& worst) {
    worst = std::isnan(worst) ? error : std::max(worst, error);
    if (!(error <= most)) entry.disagrees = format("%s: relative error %.1e, above %.1e", what, error, most);
    return entry.disagrees.empty();
  };
  peer.take(Step::kinematics);
  if (!agrees("M", e.of_M(peer.M()), M_limit, entry.M_error)) return Wrong{};
  std::size_t taken = 0;
  for (const Turn t : turns(entry)) {
    peer.take(t.step), ++taken;
    const Vector answer = peer.answer();
    const double error = is_product(t.step) ? e.of_product(answer) : e.of_solution(answer, t.other ? e.other_solution : e.solution);
    if (!(is_product(t.step) ? agrees(name(t.step), error, e.product_limit, entry.product_error) : agrees(name(t.step), error, e.force_limit, entry.force_error))) return Wrong{taken, answer, error};
  }
  return std::nullopt;
}

/// At every q the next number: who solves our problem answers nearly as before, however far another problem is; a formula that loses digits
/// moves as far as it is off.
Scene next_to(Scene scene) {
  for (Index i = 0; i < scene.q.size(); ++i) scene.q[i] = std::nextafter(scene.q[i], INFINITY);
  return scene;
}
bool is_rounding(const Vector& answer, const Vector& next, double error) {
  return std::isfinite(error) && (answer - next).lpNorm<Eigen::Infinity>() > error / 30 * answer.lpNorm<Eigen::Infinity>();
}
bool loses_digits(const PeerRow& row, const Scene& scene, const Vector& x, const Wrong& wrong) {
  if (wrong.turns == 0 || !std::isfinite(wrong.error)) return false;
  const Scene next = next_to(scene);
  const std::unique_ptr<Peer> peer = row.make(next, next.damping, x);
  peer->take(Step::kinematics);
  const std::vector<Turn> all = turns(row);
  for (std::size_t k = 0; k < wrong.turns; ++k) peer->take(all[k].step);
  return is_rounding(wrong.answer, peer->answer(), wrong.error);
}
/// The same of ours.
bool loses_digits(const OperatorRow& op, const Scene& scene, const MatrixX<double>& x, const Asked& asked, const PeerEntry& e, double product_limit) {
  const Problem<double> problem = problem_of(next_to(scene));
  const Asked next(op, problem, scene.damping, x);
  const bool product = e.product_error > product_limit;
  return is_rounding(product ? asked.product() : asked.solution(), product ? next.product() : next.solution(), product ? e.product_error : e.force_error);
}

PeerEntry entry_of(const PeerRow& row) {
  PeerEntry e;
  e.name = row.name, e.program = row.program, e.what = row.what, e.product = row.product, e.solve = row.solve, e.from_q = row.from_q;
  return e;
}

/// The operators that the peers name, and the default, in the order of the table of operators.
std::vector<const OperatorRow*> counterparts(const std::vector<PeerRow>& rows) {
  std::vector<const OperatorRow*> out;
  for (const OperatorRow& op : operators()) {
    const auto names = [&](const PeerRow& r) { return r.product == op.name || r.solve == op.name; };
    if (op.name == certified_default || std::any_of(rows.begin(), rows.end(), names)) out.push_back(&op);
  }
  return out;
}

/// Our operator's use that is the step.
Use use_of(Step s) {
  switch (s) {
    case Step::first_product: return Use::first_apply;
    case Step::product: return Use::apply;
    case Step::first_solve: return Use::first_solve;
    case Step::solve: return Use::solve;
    default: return Use::new_damping;
  }
}

/// All that is timed, and where the times go.
struct PeerRun {
  std::vector<std::function<void()>> tasks;
  std::vector<Spread*> to;

  std::size_t add(std::function<void()> task, Spread* spread) {
    tasks.push_back(std::move(task)), to.push_back(spread);
    return tasks.size() - 1;
  }
};

constexpr Step own_steps[] = {Step::first_product, Step::product, Step::first_solve, Step::solve, Step::new_damping};

}  // namespace

const PeerEntry* PeerScene::find(const std::string& name) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const PeerEntry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

double PeerScene::ratio(const PeerEntry& peer, Step step, const std::string& ours) const {
  const PeerEntry* o = find(ours);
  if (!o) return NAN;
  const double added = peer.from_q && is_first(step) ? o->of(Step::kinematics).median : 0;
  return peer.of(step).median / (o->of(step).median + added);
}

int PeerTable::disagreements() const {
  int n = 0;
  for (const PeerScene& s : scenes) n += static_cast<int>(std::count_if(s.entries.begin(), s.entries.end(), [](const PeerEntry& e) { return !e.disagrees.empty() && !e.loses_digits; }));
  return n;
}

void check_found(const std::vector<PeerRow>& rows) {
  if (rows.empty())
    throw ModelError("", "--peers", "no peer is compiled into this program",
                     "Pinocchio 4 or MuJoCo 2 (libmujoco-dev), found when the program is built: docs/peers.md; --from prints the results of a run");
}

std::vector<std::string> peer_scenes() {
  return {"go2_standing", "go2_fallen", "cassie", "g1_standing", "g1_fallen", "boxes_tower", "box_pyramid", "swimmer:30", "swimmer:90"};
}

PeerScene measure_peers(const Scene& scene, const std::vector<PeerRow>& rows, double budget) {
  const SceneResult facts = facts_of(scene, false);
  const Expected expected(scene);
  PeerScene out{scene.name, facts.dofs, facts.rows, facts.has_loops, facts.smallest_damping, facts.largest_damping, expected.product_limit, expected.force_limit, {}};
  const std::vector<const OperatorRow*> ops = counterparts(rows);
  out.entries.reserve(rows.size() + ops.size());
  PeerRun run;

  std::vector<std::unique_ptr<Peer>> peers;
  for (const PeerRow& row : rows) {
    PeerEntry& e = out.entries.emplace_back(entry_of(row));
    try {
      peers.push_back(row.make(scene, scene.damping, expected.x));
    } catch (const ModelError& refusal) {
      e.cannot = refusal.what();
      std::replace(e.cannot.begin(), e.cannot.end(), '\n', ' ');
      continue;
    }
    Peer& peer = *peers.back();
    if (const std::optional<Wrong> wrong = compare(peer, expected, e)) {
      e.loses_digits = loses_digits(row, scene, expected.x, *wrong);
      continue;
    }
    if (!e.from_q) run.add([&peer] { peer.take(Step::kinematics); }, &e.time[at(Step::kinematics)]);
    for (const Step s : own_steps)
      if (!(is_product(s) ? e.product : e.solve).empty()) run.add([&peer, s] { peer.take(s); }, &e.time[at(s)]);
  }

  Mechanism<double> mechanism(scene.model);
  Problem<double> again(mechanism.structure());
  Spread kinematics;
  run.add([&] { mechanism.update(scene.q), mechanism.fill(again); }, &kinematics);
  std::vector<std::unique_ptr<Asked>> asked;
  const MatrixX<double> x = expected.x;
  std::vector<std::array<std::size_t, 2>> less_factor;  // first product and factor of A
  for (const OperatorRow* op : ops) {
    PeerEntry& e = out.entries.emplace_back();
    e.name = std::string(op->name), e.what = std::string(op->summary);
    asked.push_back(std::make_unique<Asked>(*op, expected.problem, scene.damping, x));
    Asked& a = *asked.back();
    if (a.why_not(Use::apply).empty()) e.product_error = expected.of_product(a.product());
    if (a.why_not(Use::solve).empty()) e.force_error = expected.of_solution(a.solution(), expected.solution);
    if (e.product_error > expected.product_limit || e.force_error > expected.force_limit) {
      e.disagrees = format("relative errors %.1e of a, %.1e of λ", e.product_error, e.force_error);
      e.loses_digits = loses_digits(*op, scene, x, a, e, expected.product_limit);
      continue;
    }
    for (const Step s : own_steps) {
      if (!a.why_not(use_of(s)).empty()) continue;
      const std::size_t task = run.add([&a, s] { a.ask(use_of(s)); }, &e.time[at(s)]);
      if (s == Step::first_product && a.why_not(Use::first_solve).empty()) less_factor.push_back({task, run.add([&a] { a.ask(Use::damping_alone); }, nullptr)});
    }
  }

  const auto times = in_rounds(run.tasks, budget);
  for (std::size_t k = 0; k < times.size(); ++k)
    if (run.to[k]) *run.to[k] = spread_of(times[k]);
  for (const auto& [product, factor] : less_factor) *run.to[product] = difference(times[product], times[factor]);
  for (PeerEntry& e : out.entries)
    if (e.ours()) e.time[at(Step::kinematics)] = kinematics;
  return out;
}

PeerTable measure_peers(const std::vector<std::string>& scenes, const std::vector<PeerRow>& rows, double budget, const std::function<void(const std::string&)>& progress,
                        const std::function<bool()>& stop) {
  check_found(rows);
  PeerTable t;
  measure_scenes(t, scenes.empty() ? peer_scenes() : scenes, budget, [&](const std::string& scene) { return measure_peers(open_scene(scene), rows, budget); },
                 [](const std::string& scene) { return scene; }, progress, stop);
  return t;
}

}  // namespace delassus::bench
