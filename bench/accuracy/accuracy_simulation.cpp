#include "bench/accuracy/accuracy_simulation.h"

#include <algorithm>
#include <cmath>

#include "algorithms/errors/message.h"
#include "bench/text.h"

namespace delassus::accuracy {
namespace {

using simulation::FrictionLaw;
using simulation::Settings;

/// What of a scene decides which lines there are.
struct Kind {
  bool equations = false, cones = false, friction = false, hard = true;
};

Kind kind_of(const Scene& scene) {
  const simulation::Plan<double> plan(scene, Settings{});
  Kind out{plan.mechanism->structure()->rows > 0, !plan.rows.empty()};
  out.hard = plan.damping.blocks.empty() && std::all_of(plan.damping.diagonal.begin(), plan.damping.diagonal.end(), [](double x) { return x == 0; });
  for (const simulation::PlanLine& l : plan.lines) out.friction = out.friction || (l.in && l.effect->name == "contact friction");
  return out;
}

bool takes(const simulation::IntegratorRow& row, const Kind& kind) {
  using simulation::Takes;
  return row.takes == Takes::cones || (!kind.cones && (!kind.equations || (kind.hard && row.takes == Takes::equations)));
}

std::vector<const simulation::IntegratorRow*> integrators_of(const std::vector<std::string>& names) {
  std::vector<const simulation::IntegratorRow*> out;
  for (const std::string& n : names) out.push_back(&simulation::find_integrator(n));
  if (names.empty())
    for (const auto& row : simulation::integrators()) out.push_back(&row);
  return out;
}

std::vector<double> or_else(const std::vector<double>& given, std::vector<double> usual) { return given.empty() ? std::move(usual) : given; }

/// A solver of the table by a law; the relaxation only where it is not the exact one already, of exact solvers by the first alone.
void add_solvers(const SimulationOptions& o, const Kind& kind, std::vector<SimulatedLine>& out) {
  std::vector<const simulation::SolverRow*> rows;
  for (const std::string& n : o.solvers) rows.push_back(&simulation::find_solver(n));
  if (rows.empty())
    for (const auto& row : simulation::solvers())
      if (row.half_lines || row.boxes) rows.push_back(&row);
  const std::string& first = simulation::usual_solvers().front();
  for (const bool relaxed : {false, true})
    for (const simulation::SolverRow* row : rows) {
      if (relaxed ? !kind.friction || !row->relaxed || (o.solvers.empty() && row->exact && row->name != first) : kind.friction && !row->exact) continue;
      for (const double tolerance : or_else(o.tolerances, {1e-6, 1e-10})) {
        SimulatedLine line;
        line.name = (relaxed ? "relaxed " : "") + std::string(row->name) + bench::format(" %g", tolerance);
        line.relaxed = relaxed;
        line.settings.solver = row->name, line.settings.residual = tolerance;
        line.settings.friction = relaxed ? FrictionLaw::relaxed : FrictionLaw::exact;
        out.push_back(std::move(line));
      }
    }
}

Run run_of(const SimulationOptions& o, const Settings& settings, int level, int instants) {
  Run run{settings, instants, std::int64_t{1} << level, o.longest};
  run.settings.step = std::ldexp(o.step, -level);
  return run;
}

/// Runs by the usual solvers or operator, tight, at every step: their limits are the references.
struct Base {
  Settings settings;
  std::string name;
  int order = 1;
  std::vector<Trajectory> at;  // by level
};

Base base_of(const Kind& kind, const SimulationOptions& o) {
  Base out;
  const simulation::IntegratorRow* best = nullptr;
  for (const auto& row : simulation::integrators())
    if (takes(row, kind) && (best == nullptr || row.order > best->order)) best = &row;
  out.settings.integrator = best->name, out.order = best->order;
  out.name = best->name;
  const double tightest = o.tolerances.empty() ? 1e-10 : std::min(1e-10, *std::min_element(o.tolerances.begin(), o.tolerances.end()));
  if (kind.cones) {
    out.settings.residual = tightest;
    for (const std::string& n : simulation::usual_solvers()) out.name += (n == simulation::usual_solvers().front() ? ", " : " else ") + n;
    out.name += bench::format(" to %g m/s", tightest);
  } else if (kind.equations) {
    out.settings.accuracy = tightest;
    out.name += bench::format(", ladder to %g", tightest);
  }
  return out;
}

bool stopped(const SimulationOptions& o) { return o.stop && o.stop(); }

/// Reference from the three finest runs; runs that are not needed at other levels are left out.
Reference refine(const Scene& scene, const SimulationOptions& o, Base& base, int instants, bool all_levels) {
  const int finest = o.halvings + 2;
  base.at.assign(static_cast<std::size_t>(finest) + 1, {});
  for (int level = 0; level <= finest; ++level) {
    Trajectory& t = base.at[static_cast<std::size_t>(level)];
    if (level < o.halvings && !all_levels) {
      t.why_not = "not asked for";
      continue;
    }
    if (stopped(o)) {
      t.why_not = "interrupted";
      continue;
    }
    Run run = run_of(o, base.settings, level, instants);
    run.longest *= 8;
    t = o.runner(scene, run);
  }
  const auto at = [&](int level) -> const Trajectory& { return base.at[static_cast<std::size_t>(level)]; };
  return reference_of(at(finest), at(finest - 1), at(finest - 2), base.order);
}

std::vector<Run> runs_of(const SimulatedLine& line, const SimulationOptions& o, int instants) {
  std::vector<Run> out;
  if (line.controlled) {
    for (const double tolerance : or_else(o.tolerances, {1e-3, 1e-5, 1e-7, 1e-9, 1e-11})) {
      out.push_back(run_of(o, line.settings, 0, instants));
      out.back().settings.error = tolerance;
    }
  } else {
    for (int level = 0; level <= o.halvings; ++level) out.push_back(run_of(o, line.settings, level, instants));
  }
  return out;
}

struct Timed {
  SimulatedCell* cell;
  Run run;
};

void measure_line(const Scene& scene, const SimulationOptions& o, const SimulatedScene& s, const std::vector<Trajectory>& exact, SimulatedLine& line,
                  std::vector<Timed>& timed) {
  const Reference &own = line.relaxed ? s.relaxed : s.reference, &right = s.reference;
  std::string too_long;
  const std::vector<Run> runs = runs_of(line, o, s.instants);
  line.cells.reserve(runs.size());
  for (const Run& run : runs) {
    if (stopped(o)) return;
    SimulatedCell& c = line.cells.emplace_back();
    c.step = run.settings.step, c.tolerance = run.settings.error;
    if (!too_long.empty()) {
      c.why_not = too_long;
      continue;
    }
    const Trajectory t = o.runner(scene, run);
    if (t.refused) {
      line.why_not = t.why_not;
      line.cells.clear();
      return;
    }
    c.why_not = t.why_not;
    c.steps = t.steps, c.rejected = t.rejected, c.iterations = t.iterations;
    if (t.too_long) too_long = "not tried: the run before took too long";
    if (!t.ok()) continue;
    c.error = distance(t, right.limit);
    c.numerical = distance(t, own.limit);
    if (line.relaxed) c.modelling = distance(t, exact[line.cells.size() - 1]);
    if (o.budget > 0) c.seconds = t.seconds, timed.push_back({&c, run});
    if (line.cells.size() < 2 || line.controlled) continue;
    const SimulatedCell& before = line.cells[line.cells.size() - 2];
    const double floor = 3 * own.error.size();
    if (c.numerical.size() > floor && before.numerical.size() > floor) c.order = std::log2(before.numerical.size() / c.numerical.size());
  }
}

}  // namespace

std::vector<SimulatedLine> simulated_lines(const Scene& scene, const SimulationOptions& o) {
  const Kind kind = kind_of(scene);
  if (!o.solvers.empty() && !kind.cones) throw ModelError(scene.file, "--solver", "is given, and the scene has no contacts, limits or dry friction", "a scene with them; leave it away");
  if (!o.ops.empty() && (kind.cones || !kind.equations))
    throw ModelError(scene.file, "--op", "is given, and the scene has " + std::string(kind.cones ? "rows in cones" : "no rows"), "a scene with equations alone; leave it away");
  std::vector<SimulatedLine> out;
  for (const simulation::IntegratorRow* integrator : integrators_of(o.integrators)) {
    std::vector<SimulatedLine> of;
    if (kind.cones && takes(*integrator, kind)) {
      add_solvers(o, kind, of);
    } else if (kind.equations && takes(*integrator, kind)) {
      for (const std::string& op : o.ops.empty() ? std::vector<std::string>{Settings{}.op} : o.ops)
        for (const double tolerance : or_else(o.tolerances, {1e-6, 1e-10})) {
          SimulatedLine& line = of.emplace_back();
          line.name = std::string(find_operator(op).name) + bench::format(" %g", tolerance);
          line.settings.op = op, line.settings.accuracy = tolerance;
        }
    } else {
      of.emplace_back();
    }
    if (integrator->controlled && takes(*integrator, kind)) of.emplace_back().controlled = true;
    for (SimulatedLine& line : of) {
      line.settings.integrator = integrator->name;
      line.order = integrator->order;
      if (line.controlled) line.name = "controlled";
      if (!kind.cones || line.name.empty()) line.name = std::string(integrator->name) + (line.name.empty() ? "" : ", ") + line.name;  // one takes cones
      out.push_back(std::move(line));
    }
  }
  const bool takes = kind.cones || kind.equations || std::any_of(out.begin(), out.end(), [](const SimulatedLine& l) { return l.controlled; });
  if (!o.tolerances.empty() && !takes) throw ModelError(scene.file, "--tolerance", "is given, and nothing that is run has one", "dormand_prince among the integrators, or a scene with rows; leave it away");
  return out;
}

SimulatedScene measure_simulation(const Scene& scene, const SimulationOptions& o) {
  const double intervals = std::round(o.duration / o.step);
  if (!(o.step > 0 && intervals >= 1 && std::abs(intervals * o.step - o.duration) <= 1e-9 * o.duration && intervals < 1e6))
    throw ModelError(scene.file, "--duration", number_text(o.duration) + " s is no whole number of steps of " + number_text(o.step) + " s", "a whole number below a million of the largest step; another --duration or --step");
  SimulatedScene out;
  out.name = scene.name, out.duration = o.duration, out.instants = static_cast<int>(intervals);
  out.bodies = static_cast<Index>(scene.model.bodies.size()), out.dofs = scene.model.dofs();
  out.lines = simulated_lines(scene, o);
  const Kind kind = kind_of(scene);
  out.has_relaxed = std::any_of(out.lines.begin(), out.lines.end(), [](const SimulatedLine& l) { return l.relaxed; });
  Base base = base_of(kind, o), relaxed = base;
  out.reference_by = base.name;
  out.reference_step = std::ldexp(o.step, -o.halvings - 2);
  out.reference = refine(scene, o, base, out.instants, out.has_relaxed);
  if (out.has_relaxed) {
    relaxed.settings.friction = FrictionLaw::relaxed;
    out.relaxed = refine(scene, o, relaxed, out.instants, false);
    out.between_laws = distance(out.relaxed.limit, out.reference.limit);
  }
  std::vector<Timed> timed;
  for (SimulatedLine& line : out.lines) measure_line(scene, o, out, base.at, line, timed);
  for (int round = 1; round < 5; ++round)  // in rounds: a slow phase of the machine meets all of them
    for (const Timed& t : timed)
      if (!stopped(o) && round * t.cell->seconds < o.budget) {
        const Trajectory again = o.runner(scene, t.run);
        if (again.ok()) t.cell->seconds = std::min(t.cell->seconds, again.seconds);
      }
  return out;
}

}  // namespace delassus::accuracy
