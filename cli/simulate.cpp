// `delassus simulate SCENE`: a scene that moves, with the effects it calls for and no others.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "algorithms/errors/message.h"
#include "bench/page/plot.h"
#include "bench/text.h"
#include "cli/capture.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/simulate_explain.h"
#include "cli/simulate_page.h"
#include "cli/program/options.h"
#include "simulation/observe.h"
#include "simulation/step.h"

namespace delassus::cli {

namespace {

using Clock = std::chrono::steady_clock;

struct SimulateCommand {
  std::string scene, duration = "1s", record, plot, capture;
  bool as_json = false, as_markdown = false, explain = false;
  std::optional<double> gravity;
  std::int64_t every = 0;  ///< 0: every step, or 60 pictures a second
  simulation::Settings settings;
  SceneOptions opening;
};

/// What is written of a step: columns of the CSV.
struct Sample {
  double time;
  VectorX<double> q, nu;
  double kinetic, potential;
  Index rows, islands;
  int iterations;
  double residual, drift;
};

struct Ran {
  std::vector<Sample> samples;
  std::vector<Frame3D> frames;
  std::int64_t steps = 0;
  double seconds = 0;           ///< of stepping alone
  simulation::StepReport last;
  std::int64_t problems = 0;               ///< written
  std::vector<std::string> unsolved;       ///< files of what no solver could do
  Index most_rows = 0, most_islands = 0;
  std::int64_t iterations = 0, taken = 0, rejected = 0;
  double residual = 0, drift = 0, left = 0, error = 0;
  simulation::Observed<double> begin, end;
};

std::vector<std::string> columns(const Model& model) {
  std::vector<std::string> out{"time"};
  for (const char* what : {"q", "nu"})
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const auto& first = *what == 'q' ? model.first_q : model.first_dof;
      const std::string& joint = model.bodies[i].joint.name.empty() ? model.bodies[i].name : model.bodies[i].joint.name;
      const Index n = first[i + 1] - first[i];
      for (Index k = 0; k < n; ++k) out.push_back(std::string(what) + " " + joint + (n > 1 ? " " + std::to_string(k) : ""));
    }
  for (const char* name : {"kinetic", "potential", "rows", "islands", "iterations", "residual", "drift"}) out.emplace_back(name);
  return out;
}

std::vector<double> numbers(const Sample& s) {
  std::vector<double> out{s.time};
  out.insert(out.end(), s.q.begin(), s.q.end());
  out.insert(out.end(), s.nu.begin(), s.nu.end());
  out.insert(out.end(), {s.kinetic, s.potential, static_cast<double>(s.rows), static_cast<double>(s.islands), static_cast<double>(s.iterations), s.residual, s.drift});
  return out;
}

Sample sample_of(const simulation::Simulation<double>& s, const simulation::Observed<double>& o) {
  const auto& r = s.last();
  return {s.time(), s.state().q, s.state().nu, o.kinetic, o.potential, r.rows, r.islands, r.iterations, r.residual, r.drift};
}

Ran run_scene(const SimulateCommand& o, const Scene& scene) {
  simulation::Simulation<double> s(scene, o.settings);
  simulation::Observer<double> observe(scene);
  const auto wanted = static_cast<std::int64_t>(std::llround(options::seconds_of(o.duration) / o.settings.step));
  const bool page = o.record.ends_with(".html"), keeps = (!o.record.empty() && !page) || !o.plot.empty(), tells = isatty(STDERR_FILENO) != 0;
  const std::int64_t every = o.every > 0 ? o.every : 1, pictures = o.every > 0 ? o.every : std::max<std::int64_t>(1, std::llround(1 / (60 * o.settings.step)));
  Ran out;
  out.begin = observe(s.state());
  if (keeps) out.samples.push_back(sample_of(s, out.begin));
  if (page) out.frames.push_back(frame_of(scene, s, out.begin));
  keep_on_interrupt();
  auto told = Clock::now();
  while (out.steps < wanted && !interrupted()) {
    const auto start = Clock::now();
    const auto& r = s.step();
    const auto end = Clock::now();
    out.seconds += std::chrono::duration<double>(end - start).count();
    if (!o.capture.empty() && r.ok() && (out.steps + 1) % every == 0) out.problems += static_cast<std::int64_t>(capture(o.capture, scene, s, true).size());
    if (!r.ok()) break;
    ++out.steps;
    out.most_rows = std::max(out.most_rows, r.rows);
    out.most_islands = std::max(out.most_islands, r.islands);
    out.iterations += r.iterations;
    out.taken += r.taken;
    out.rejected += r.rejected;
    out.error = std::max(out.error, r.error);
    out.residual = std::max(out.residual, r.residual);
    out.drift = std::max(out.drift, r.drift);
    out.left = std::max(out.left, r.left);
    if (page && out.steps % pictures == 0) out.frames.push_back(frame_of(scene, s, observe(s.state())));
    if (keeps && out.steps % every == 0) out.samples.push_back(sample_of(s, observe(s.state())));
    if (tells && end - told > std::chrono::milliseconds(500)) {
      std::fprintf(stderr, "\r%.3f s of %s, %lld steps, %.0f a second   ", s.time(), o.duration.c_str(), static_cast<long long>(out.steps), static_cast<double>(out.steps) / out.seconds);
      told = end;
    }
  }
  if (tells) std::fprintf(stderr, "\r%60s\r", "");
  out.last = s.last();
  try {
    if (!out.last.ok()) out.unsolved = capture(o.capture.empty() ? "." : o.capture, scene, s, false);
  } catch (const ModelError& e) {
    std::fprintf(stderr, "%s\n", e.what());  // what was computed is still to be written
  }
  out.end = observe(s.state());
  return out;
}

/// Before anything is computed.
void check_writable(const char* option, const std::string& file) {
  if (!file.empty() && !std::ofstream(file, std::ios::app))
    throw ModelError(file, option, "cannot be written", "a file in a folder that exists; make the folder first");
}

void record(const SimulateCommand& o, const Scene& scene, const Ran& ran) {
  if (o.record.empty()) return;
  if (o.record.ends_with(".html")) return write_page(o.record, scene, o.settings.step, ran.frames);
  std::ofstream out(o.record);
  const std::vector<std::string> names = columns(scene.model);
  if (o.record.ends_with(".json")) {
    json rows = json::array();
    for (const Sample& s : ran.samples) rows.push_back(numbers(s));
    out << json{{"scene", scene.name}, {"step", o.settings.step}, {"columns", names}, {"rows", rows}}.dump() << "\n";
  } else {
    for (std::size_t k = 0; k < names.size(); ++k) out << (k ? "," : "") << names[k];
    out << "\n";
    for (const Sample& s : ran.samples) {
      const std::vector<double> x = numbers(s);
      for (std::size_t k = 0; k < x.size(); ++k) out << (k ? "," : "") << number_text(x[k]);
      out << "\n";
    }
  }
  if (!out.flush()) throw ModelError(o.record, "--record", "cannot be written", "a .csv, .json or .html file in a folder that exists; make room, or the folder first");
}

void draw(const SimulateCommand& o, const Ran& ran) {
  if (o.plot.empty()) return;
  std::vector<bench::Series> series{{"kinetic", {}, 0, false}, {"potential", {}, 1, false}, {"sum", {}, 2, false}};
  for (const Sample& s : ran.samples) {
    series[0].points.emplace_back(s.time, s.kinetic);
    series[1].points.emplace_back(s.time, s.potential);
    series[2].points.emplace_back(s.time, s.kinetic + s.potential);
  }
  const std::string svg = bench::plot("energy", "energy over time", "time [s]", "energy [J]", series, bench::Axes::linear);
  if (svg.empty()) throw ModelError(o.plot, "--plot", "gnuplot is not installed or failed", "gnuplot; --record FILE.csv for another tool");
  std::ofstream out(o.plot);
  out << bench::standalone(svg);
  if (!out.flush()) throw ModelError(o.plot, "--plot", "cannot be written", "a .svg file in a folder that exists; make room, or the folder first");
}

json energy_json(const simulation::Observed<double>& o) {
  const auto three = [](const Vector3<double>& x) { return std::vector<double>(x.begin(), x.end()); };
  return {{"kinetic", o.kinetic}, {"potential", o.potential}, {"linear_momentum", three(o.linear)}, {"angular_momentum", three(o.angular)}, {"centre", three(o.centre)}};
}

json ran_json(const SimulateCommand& o, const Scene& scene, const Ran& r) {
  json out = {{"scene", scene.name}, {"step", o.settings.step}, {"steps", r.steps}, {"time", static_cast<double>(r.steps) * o.settings.step},
          {"seconds", r.seconds}, {"begin", energy_json(r.begin)}, {"end", energy_json(r.end)}, {"most_rows", r.most_rows}, {"most_islands", r.most_islands},
          {"iterations", r.iterations}, {"residual", r.residual}, {"drift", r.drift}, {"left", r.left}, {"path", r.last.path},
          {"status", name(r.last.report.status)}, {"message", r.last.message}, {"captured", r.problems}, {"unsolved", r.unsolved}, {"interrupted", interrupted()}};
  if (o.settings.error > 0) out["error_control"] = {{"accuracy", o.settings.error}, {"largest", r.error}, {"taken", r.taken}, {"rejected", r.rejected}};
  return out;
}

void print_ran(const SimulateCommand& o, const Ran& r) {
  std::printf("%s  %lld steps of %g s, %.4g s; %s a step (%.0f steps a second)\n", o.scene.c_str(), static_cast<long long>(r.steps), o.settings.step,
              static_cast<double>(r.steps) * o.settings.step, r.steps ? bench::format("%.3g µs", 1e6 * r.seconds / static_cast<double>(r.steps)).c_str() : "–",
              r.seconds > 0 ? static_cast<double>(r.steps) / r.seconds : 0.0);
  std::printf("energy    %.8g J → %.8g J (kinetic %.6g → %.6g)\n", r.begin.energy(), r.end.energy(), r.begin.kinetic, r.end.kinetic);
  std::printf("centre    (%.6g, %.6g, %.6g) m → (%.6g, %.6g, %.6g) m\n", r.begin.centre[0], r.begin.centre[1], r.begin.centre[2], r.end.centre[0], r.end.centre[1], r.end.centre[2]);
  if (o.settings.error > 0)
    std::printf("accuracy  %lld steps taken, %lld rejected; largest error %.2g of %g a second [m, rad, m/s, rad/s]\n", static_cast<long long>(r.taken),
                static_cast<long long>(r.rejected), r.error, o.settings.error);
  if (r.drift > 0) std::printf("drift     at most %.2g m or rad a step, %.2g after closing\n", r.drift, r.left);
  const double iterations = r.steps ? static_cast<double>(r.iterations) / static_cast<double>(r.steps) : 0.0;
  if (simulation::find_integrator(o.settings.integrator).tableau != nullptr) {
    if (r.most_rows > 0) std::printf("rows      at most %lld\n", static_cast<long long>(r.most_rows));
    if (r.iterations > 0)
      std::printf("stages    %.1f iterations a step; last changes at most %.1g of the largest velocity (or of 1 m/s or rad/s)\n", iterations, r.residual);
  } else if (r.most_rows > 0) {
    std::printf("rows      at most %lld, in at most %lld island%s; solver %.1f iterations a step, residual at most %.2g m/s\n", static_cast<long long>(r.most_rows),
                static_cast<long long>(r.most_islands), r.most_islands == 1 ? "" : "s", iterations, r.residual);
  }
  if (r.problems > 0) std::printf("captured  %lld contact problems in %s\n", static_cast<long long>(r.problems), o.capture.c_str());
  for (const std::string& file : r.unsolved) std::printf("unsolved  %s: the problem that no solver could do; docs/solvers.md says how to replay it\n", file.c_str());
  if (!r.last.ok())
    std::printf("ended     at step %lld: %s%s%s\n", static_cast<long long>(r.steps) + 1, std::string(name(r.last.report.status)).c_str(), r.last.message.empty() ? "" : "; ", r.last.message.c_str());
}

std::vector<std::string> solver_names() {
  std::vector<std::string> out;
  for (const auto& row : simulation::solvers()) out.emplace_back(row.name);
  return out;
}

int simulate(const SimulateCommand& o) {
  Scene scene = open(o.scene, o.opening);
  if (o.gravity) scene.has_gravity = true, scene.gravity = {0, 0, -*o.gravity}, scene.motion.where["gravity"] = "--gravity";
  if (o.explain) {
    const json j = explain_json(scene, o.settings);
    if (o.as_json) std::printf("%s\n", j.dump(1).c_str());
    else if (o.as_markdown) print_prices(j);
    else print_explain(j);
    return good;
  }
  check_writable("--record", o.record);
  check_writable("--plot", o.plot);
  if (!o.capture.empty()) check_folder(o.capture);
  const Ran ran = run_scene(o, scene);
  record(o, scene, ran);
  draw(o, ran);
  if (o.as_json) std::printf("%s\n", ran_json(o, scene, ran).dump(1).c_str());
  else print_ran(o, ran);
  return end_of_run(ran.last.ok() ? good : law_broken, "the steps until then are written and counted");
}

}  // namespace

void add_simulate(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("simulate", "let a scene move, with the effects it calls for and no others");
  auto o = std::make_shared<SimulateCommand>();
  c->add_option("scene", o->scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  c->add_option("--duration", o->duration, "simulated time: 10, 10s, 5m, 1h")->check(options::duration())->capture_default_str();
  const options::Option* step = c->add_option("--step", o->settings.step, "step [s]; with --accuracy where steps land, 1/60 or less when left out")->check(options::above(0, "s"))->capture_default_str();
  std::vector<std::string> integrators;
  for (const auto& row : simulation::integrators()) integrators.emplace_back(row.name);
  const options::Option* integrator = c->add_option("--integrator", o->settings.integrator, "euler: semi-implicit, every scene; runge_kutta, dormand_prince: explicit, of orders 4 and 5; implicit_midpoint, sdirk4: implicit, of orders 2 and 4, springs and dampers of any stiffness; all but euler for scenes without rows in cones (see `delassus list integrators`)")->check(options::one_of(integrators))->capture_default_str();
  c->add_option("--accuracy", o->settings.error, "the steps follow their error: at most this much in a second of them [m, rad, m/s, rad/s]; by dormand_prince, or by sdirk4 where it is named; for scenes without rows in cones")->check(options::above(0, ""));
  c->add_option("--gravity", o->gravity, "acceleration along −z instead of the scene's [m/s²]: a robot's file has none")->check(options::at_least(0, "m/s²"));
  c->add_option("--record", o->record, "FILE.csv or FILE.json: q, ν, energies, rows, residual and drift of every step; FILE.html: a page that plays the run");
  c->add_option("--every", o->every, "record every so many steps (default: 1; 60 a second for a page)")->check(options::whole(1));
  c->add_option("--plot", o->plot, "FILE.svg: energies over time");
  c->add_option("--capture", o->capture, "FOLDER: every contact problem of every step (or as --every says) as a file that replays; what no solver could do is always written");
  auto* const explain = c->add_flag("--explain", o->explain, "do not run: per effect called for by which line, or skipped and why; bytes, operations a step");
  c->add_flag("--markdown", o->as_markdown, "the explanation as a table of prices of the effects that are in")->needs(explain);
  c->add_option("--without", o->settings.without, "an effect that is left out (see `delassus list effects`); may be repeated");
  c->add_flag("--everything", o->settings.everything, "all effects, also those that provably vanish");
  c->add_option("--solver", o->settings.solver, "of contacts, limits and dry friction: direct, newton_convex, proximal, admm, pgs; proximal, then admm, then pgs when left out")->check(options::one_of(solver_names()));
  c->add_option_function("--friction", [o](const std::string& text) { o->settings.friction = text == "exact" ? simulation::FrictionLaw::exact : simulation::FrictionLaw::relaxed; },
                         "exact: Coulomb's law; relaxed: its convex relaxation, which lifts what slides (default: exact)")->check(options::one_of({"exact", "relaxed"}));
  c->add_option("--residual", o->settings.residual, "asked of the solver: natural residual [m/s]")->check(options::at_least(0, "m/s"))->capture_default_str();
  c->add_option("--op", o->settings.op, "operator of equations (see `delassus list operators`)")->capture_default_str();
  c->add_flag("--json", o->as_json, "the summary, or the explanation, as JSON");
  add_scene_options(*c, o->opening);
  c->footer("Ctrl-C ends after the step; what was computed is written. Exit code 1 when a step does not end well: no impulse is used that misses the residual.");
  c->callback([=, &run] {
    if (o->settings.error > 0 && integrator->count() == 0) o->settings.integrator = "dormand_prince";
    const double duration = options::seconds_of(o->duration);
    if (o->settings.error > 0 && step->count() == 0) o->settings.step = duration / std::ceil(60 * duration);
    run = [=] { return simulate(*o); };
  });
}

}  // namespace delassus::cli
