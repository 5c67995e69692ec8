#include "bench/simulation/simulation_speed.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "algorithms/delassus.h"
#include "algorithms/mechanism/kinematics.h"
#include "bench/machine.h"
#include "bench/simulation/own_simulator.h"
#include "bench/peers/peer_table.h"
#include "bench/stopwatch.h"
#include "bench/text.h"
#include "reference/definition.h"

namespace delassus::bench {
namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

/// The definition is dense: of what is too large nothing is judged.
int judged_steps(Index dofs, std::int64_t rows) { return dofs + rows > 2000 ? 0 : dofs + rows > 1000 ? 2 : 30; }
constexpr StepResidual not_judged{NAN, NAN, NAN, NAN, NAN};

/// A state beside the scene's, what is held at rest. M by the definition; ν̇ by ours, which it shares nothing with.
struct Expected {
  Vector held, nu, q, acceleration;
  Matrix M;

  Expected(const Scene& scene, Simulator& ours, const Vector& theirs_held) : held(theirs_held), nu(scene.model.dofs()) {
    if (held.size() == 0) held = Vector::Zero(nu.size());
    for (Index k = 0; k < nu.size(); ++k) nu[k] = held[k] != 0 ? 0 : 0.5 * std::sin(1 + static_cast<double>(k));
    Model model = scene.model;
    model.constraints.clear();
    q = integrate<double>(model, scene.q, 0.1 * nu);
    M = reference::mass_matrix(kinematics<double>(model, q));
    acceleration = ours.free_acceleration(q, nu);
    if ((held.array() != 0).any()) acceleration = Matrix(M + Matrix(held.asDiagonal())).ldlt().solve(Vector(M * acceleration));
  }
  [[nodiscard]] double of_M(const Matrix& theirs) const {
    if (theirs.rows() != M.rows() || theirs.hasNaN()) return INFINITY;
    double worst = 0;
    for (Index j = 0; j < M.cols(); ++j)
      for (Index i = 0; i < M.rows(); ++i)
        if (held[i] == 0 && held[j] == 0) worst = std::max(worst, std::fabs(theirs(i, j) - M(i, j)) / std::sqrt(M(i, i) * M(j, j)));
    return worst;
  }
  /// Each by itself, down to a thousandth of the largest: joints of a hand accelerate a thousand times faster than a body.
  [[nodiscard]] double of_acceleration(const Vector& theirs) const {
    double worst = 0;
    for (Index k = 0; k < nu.size(); ++k) {
      if (held[k] != 0) continue;
      if (std::isnan(theirs[k])) return INFINITY;
      worst = std::max(worst, std::fabs(theirs[k] - acceleration[k]) / (std::fabs(acceleration[k]) + 1e-3 * acceleration.cwiseAbs().maxCoeff()));
    }
    return worst;
  }
};

void compare(Simulator& s, const Scene& scene, Simulator& ours, SpeedEntry& entry) {
  const Expected e(scene, ours, s.held());
  entry.M_error = e.of_M(s.M(e.q));
  if (!(entry.M_error <= same)) entry.disagrees = format("M: relative error %.1e, above %.1e", entry.M_error, same);
  if (!entry.disagrees.empty()) return;
  entry.free_error = e.of_acceleration(s.free_acceleration(e.q, e.nu));
  if (!(entry.free_error <= same)) entry.disagrees = format("accelerations without rows: relative error %.1e, above %.1e", entry.free_error, same);
}

constexpr double StepResidual::*residuals[] = {&StepResidual::natural, &StepResidual::approach, &StepResidual::cone, &StepResidual::momentum, &StepResidual::depth};

/// A run from the start: how far it comes, and its residuals on the way.
void judge(Simulator& s, const Model& model, int steps, SpeedEntry& entry) {
  std::vector<StepResidual> seen;
  std::int64_t iterations = 0;
  s.reset();
  for (entry.steps = 0; entry.steps < steps; ++entry.steps) {
    if (!s.step()) {
      entry.ended = format("step %lld: ", static_cast<long long>(entry.steps) + 1) + s.why_not();
      break;
    }
    iterations += s.iterations();
    entry.contacts = std::max(entry.contacts, static_cast<std::int64_t>(s.contacts()));
    entry.rows = std::max(entry.rows, static_cast<std::int64_t>(s.row_count()));
    const int judged = judged_steps(model.dofs(), entry.rows);
    if (judged > 0 && (entry.steps + 1) % std::max(1, steps / judged) == 0) seen.push_back(residual_of(model, s.last(), speed_step));
  }
  if (entry.steps > 0) entry.iterations = static_cast<double>(iterations) / static_cast<double>(entry.steps);
  entry.median = entry.worst = not_judged;
  if (seen.empty()) return;
  for (const auto number : residuals) {
    std::vector<double> all;
    for (const StepResidual& r : seen) all.push_back(std::isnan(r.*number) ? INFINITY : r.*number);
    std::sort(all.begin(), all.end());
    entry.median.*number = all[all.size() / 2], entry.worst.*number = all.back();
  }
}

std::string in_a_line(std::string s) {
  std::replace(s.begin(), s.end(), '\n', ' ');
  return s;
}

SpeedExample example_of(const std::string& name) {
  for (const SpeedExample& e : speed_examples())
    if (e.name == name) return e;
  return {name, name};
}

}  // namespace

const std::vector<SpeedExample>& speed_examples() {
  static const std::vector<SpeedExample> all{
      {"go2", "docs/moving/go2.yaml", 1e-10, 1000, true, {"wrenches"}},
      {"go2 pushed", "docs/moving/go2.yaml", 1e-10, 1000, true},
      {"g1", "g1_standing", 1e-8, 2000, true},
      {"cassie", "docs/moving/cassie.yaml", 1e-10, 2000, true},
      {"hand", "docs/moving/hand.yaml", 1e-10, 2000, true},
      {"four_bar", "docs/moving/four_bar.yaml"},
      {"slider_crank", "docs/moving/slider_crank.yaml"},
      {"boxes_tower", "boxes_tower", 1e-10, 200},
      {"box_pyramid", "box_pyramid", 1e-10, 50},
      {"card_house", "docs/moving/card_house.yaml", 1e-10, 500},
      {"swimmer:1000", "swimmer:1000", 1e-10, 200},
      {"hammer", "docs/hammer.yaml"},
  };
  return all;
}

std::string own_name_at(const std::string& other) { return std::string(own_name) + " at that of " + other; }

const SpeedEntry* SpeedScene::find(const std::string& name) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const SpeedEntry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

const SpeedEntry* SpeedScene::as_accurate_as(const std::string& theirs) const {
  const SpeedEntry *t = find(theirs), *best = nullptr;
  if (t == nullptr || !t->time.measured()) return nullptr;
  for (const SpeedEntry& e : entries)
    if (e.ours() && e.time.measured() && e.median.natural <= std::max(t->median.natural, example.residual) && (best == nullptr || e.time.median < best->time.median)) best = &e;
  return best;
}

int SimulationSpeed::disagreements() const {
  int n = 0;
  for (const SpeedScene& s : scenes) n += static_cast<int>(std::count_if(s.entries.begin(), s.entries.end(), [](const SpeedEntry& e) { return !e.disagrees.empty(); }));
  return n;
}

SpeedScene measure_speed(const SpeedExample& example, const std::vector<SimulatorRow>& rows, double budget) {
  Scene scene = open_scene(example.scene);
  for (const std::string& effect : example.without) {
    if (effect != "wrenches") throw ModelError("", "example " + example.name, "is without " + effect, "wrenches: other programs leave out nothing else");
    scene.motion.wrenches.clear();
  }
  SpeedScene out{example, scene.model.dofs(), {}};
  out.entries.reserve(2 * rows.size() + 1);
  std::vector<std::unique_ptr<Simulator>> all;
  std::vector<SpeedEntry*> of;
  const auto enter = [&](const SpeedEntry& e, std::unique_ptr<Simulator> s) {
    out.entries.push_back(e), of.push_back(&out.entries.back()), all.push_back(std::move(s));
    return std::pair<SpeedEntry&, Simulator*>(out.entries.back(), all.back().get());
  };
  const auto own = [&](const std::string& name, double residual) {
    SpeedEntry e;
    e.name = name, e.asked = residual, e.what = format("natural residual asked: %.0e m/s", residual);
    return enter(e, own_simulator(scene, speed_step, residual));
  };
  const auto [first, ours] = own(own_name, example.residual);
  compare(*ours, scene, *ours, first);
  judge(*ours, scene.model, example.steps, first);
  for (const SimulatorRow& row : rows) {
    SpeedEntry e;
    e.name = row.name, e.program = row.program, e.what = row.what;
    std::unique_ptr<Simulator> made;
    try {
      made = row.make(scene, speed_step);
    } catch (const ModelError& refusal) {
      e.cannot = in_a_line(refusal.what());
    }
    const auto [theirs, s] = enter(e, std::move(made));
    if (s == nullptr) continue;
    compare(*s, scene, *ours, theirs);
    if (theirs.disagrees.empty()) judge(*s, scene.model, example.steps, theirs);
  }
  for (std::size_t k = 1; k <= rows.size(); ++k) {
    const SpeedEntry& theirs = out.entries[k];
    if (theirs.steps == 0 || !(theirs.median.natural > example.residual)) continue;
    const auto [at, s] = own(own_name_at(theirs.name), std::min(theirs.median.natural, most_asked));
    compare(*s, scene, *ours, at);
    judge(*s, scene.model, example.steps, at);
  }

  std::vector<std::function<void()>> tasks;
  std::vector<SpeedEntry*> timed;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!of[k]->disagrees.empty() || of[k]->steps == 0) continue;
    timed.push_back(of[k]);
    tasks.emplace_back([&s = *all[k], steps = of[k]->steps] {
      s.reset();
      for (std::int64_t i = 0; i < steps; ++i) static_cast<void>(s.step());
    });
  }
  const auto times = in_rounds(tasks, budget);
  for (std::size_t k = 0; k < times.size(); ++k) {
    std::vector<double> a_step;
    for (const double t : times[k]) a_step.push_back(t / static_cast<double>(timed[k]->steps));
    timed[k]->time = spread_of(a_step);
  }
  return out;
}

SimulationSpeed measure_speed(const std::vector<std::string>& examples, const std::vector<SimulatorRow>& rows, double budget, const std::function<void(const std::string&)>& progress,
                              const std::function<bool()>& stop) {
  if (rows.empty())
    throw ModelError("", "--simulation", "no simulator from outside is compiled into this program",
                     "MuJoCo 2 (libmujoco-dev), found when the program is built: docs/simulation_speed.md; --from prints the results of a run");
  SimulationSpeed t;
  std::vector<SpeedExample> wanted;
  for (const std::string& name : examples) wanted.push_back(example_of(name));
  if (wanted.empty()) wanted = speed_examples();
  measure_scenes(t, wanted, budget, [&](const SpeedExample& e) { return measure_speed(e, rows, budget); }, [](const SpeedExample& e) { return e.name; }, progress, stop);
  return t;
}

}  // namespace delassus::bench
