// `delassus accuracy`: what accuracy costs in time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "algorithms/errors/message.h"
#include "bench/accuracy/accuracy_campaign.h"
#include "bench/accuracy/accuracy_digest.h"
#include "bench/page/plot.h"
#include "bench/text.h"
#include "cli/accuracy_simulation.h"
#include "cli/accuracy_steps.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/interrupt.h"
#include "generators/families.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

using namespace accuracy;
using bench::format;
using bench::pad_left;
using bench::pad_right;

struct AccuracyOptions {
  std::vector<std::string> subjects, ops;
  std::vector<double> dampings, away{0};
  std::string rhs = "consistent", out, claim = default_rung;
  Index n = 0;
  std::uint64_t seed = 1;
  double seconds = 1200;
  bool all = false, no_time = false, steps = false, simulate = false, as_json = false;
  SimulateOptions simulated;
  SceneOptions opening;
};

bool is_family(const std::string& name) {
  const auto& table = generators::families();
  return std::any_of(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
}

Subject open_subject(const std::string& name, const AccuracyOptions& o, double away, json& warnings) {
  if (is_family(name)) return subject_of(name, o.n > 0 ? o.n : middle_size(name), o.seed, away);
  const Scene scene = open(name, o.opening);
  warnings = warnings_json(scene);
  return subject_of(scene, away);
}


json to_json(const Cell& c) {
  return {{"rung", c.rung}, {"status", c.status}, {"iterations", c.iterations}, {"motion_error", finite_json(c.errors.motion)},
          {"lambda_error", finite_json(c.errors.lambda)}, {"backward_error", finite_json(c.errors.backward)},
          {"energy_error", finite_json(c.errors.energy)}, {"error_bound", known_json(c.error_bound)},
          {"error_estimate", known_json(c.error_estimate)},
          {"bound_holds", c.error_bound < 0 ? json(nullptr) : json(c.certificate_true())},
          {"microseconds", {{"update_and_solve", finite_json(c.time)}, {"solve", finite_json(c.solve)}}},
          {"operations", c.operations < 0 ? json(nullptr) : json(c.operations)}};
}

json to_json(const Table& t) {
  json levels = json::array();
  for (const Level& l : t.levels) {
    json cells = json::array();
    for (const Cell& c : l.cells) cells.push_back(to_json(c));
    levels.push_back({{"damping", l.damping == own_damping ? json("own") : json(l.damping)}, {"largest_eigenvalue", finite_json(l.largest_eigenvalue)},
                      {"condition", finite_json(l.condition)}, {"reference_bound", known_json(l.reference_bound)},
                      {"reference_against_definition", finite_json(l.disagreement)},
                      {"no_reference", l.no_reference.empty() ? json(nullptr) : json(l.no_reference)}, {"rungs", cells}});
  }
  return {{"subject", t.name}, {"dof", t.dofs}, {"rows", t.rows}, {"away", t.away}, {"levels", levels}};
}

std::string decade_text(double x) { return std::isnan(x) ? "–" : x == 0 ? "0" : format("%.0e", x); }
std::string exponent(double x) { return std::isnan(x) ? "–" : x == 0 ? "exact" : format("%.1f", std::log10(x)); }

void print_cell(const Cell& c, std::size_t width) {
  const bool has_bound = c.error_bound >= 0;
  const std::string holds = !has_bound || std::isnan(c.errors.energy) ? "–" : c.certificate_true() ? "yes" : "NO";
  std::string line = "  " + pad_right(c.rung, width);
  for (const double e : {c.errors.motion, c.errors.lambda, c.errors.backward}) line += pad_left(exponent(e), 9);
  line += pad_left(has_bound ? exponent(c.error_bound) : "–", 9) + pad_left(holds, 6) + format("%7d", c.iterations);
  line += pad_left(bench::three_digits(c.time), 9) + pad_left(bench::three_digits(c.solve), 9);
  std::printf("%s%s  %s\n", line.c_str(), pad_left(bench::short_count(c.operations), 11).c_str(), c.status.c_str());
}

void print_level(const Level& l, std::size_t width) {
  if (l.damping == own_damping) std::printf("\nown damping");
  else std::printf("\nR⁻¹ = %g 1/kg, R λmax = %.0e", l.damping, l.largest_eigenvalue / l.damping);
  std::printf(", κ %s; ", decade_text(l.condition).c_str());
  if (!l.no_reference.empty()) std::printf("%s\n", l.no_reference.c_str());
  else
    std::printf("reference within %s, against the definition %s\n", l.reference_bound < 0 ? "–" : decade_text(l.reference_bound).c_str(),
                decade_text(l.disagreement).c_str());
  std::printf("  %s   motion        λ backward    bound  true  steps  time µs solve µs operations  status\n",
              pad_right("log10 of errors", width).c_str());
  for (const Cell& c : l.cells) print_cell(c, width);
}

void print(const Table& t) {
  std::printf("%s: %d dofs, %d rows", t.name.c_str(), static_cast<int>(t.dofs), static_cast<int>(t.rows));
  std::printf(t.away == 0 ? "\n" : ", %g m away\n", t.away);
  std::size_t width = 0;
  for (const Level& l : t.levels)
    for (const Cell& c : l.cells) width = std::max(width, c.rung.size());
  for (const Level& l : t.levels) print_level(l, std::max<std::size_t>(width, 15));
  std::printf("\n");
}

void write(const std::filesystem::path& path, const std::string& text) {
  if (text.empty()) throw ModelError(path.string(), "plot", "needs gnuplot, which cannot be run", "a machine with gnuplot; install gnuplot, or leave --out away");
  std::filesystem::create_directories(path.parent_path());
  if (!(std::ofstream(path) << text << std::flush))
    throw ModelError(path.string(), "file", "cannot be written", "a directory with write permission; choose another --out");
}

void write_pictures(const Table& t, const std::filesystem::path& out) {
  const std::string stem = t.name + (t.away == 0 ? "" : format("_%g_m_away", t.away));
  write(out / (stem + ".svg"), bench::standalone(picture(t, Price::time)));
  if (const std::string svg = picture(t, Price::operations); !svg.empty()) write(out / (stem + "_operations.svg"), bench::standalone(svg));
}

bool all_hold(const std::vector<Claim>& made) {
  return std::all_of(made.begin(), made.end(), [](const Claim& c) { return c.holds(); });
}

accuracy::Options settings(const AccuracyOptions& o) {
  accuracy::Options s;
  s.dampings = o.dampings.empty() ? dampings_up_to(claimed_to) : o.dampings;
  s.random_right_side = o.rhs == "random";
  s.seed = o.seed;
  if (o.no_time) s.budget = 0;
  s.stop = interrupted;
  return s;
}

int some(const AccuracyOptions& o) {
  std::vector<Table> tables;
  json out = json::array();
  for (const std::string& name : o.subjects)
    for (const double away : o.away) {
      if (interrupted()) break;
      json warnings;
      tables.push_back(measure(open_subject(name, o, away, warnings), rungs(o.ops), settings(o)));
      out.push_back(to_json(tables.back()));
      if (!warnings.is_null()) out.back()["warnings"] = warnings;
      if (!o.as_json) print(tables.back());
      if (!o.out.empty() && !o.no_time) write_pictures(tables.back(), o.out);
    }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  const std::vector<Claim> made = claims(tables, o.claim);
  if (!o.as_json && !made.empty())
    std::printf("Motion error below %g, λ error below %.1e, certificates true; R⁻¹ from %g to %g:\n\n%s\n", claimed_motion,
                claimed_lambda, claimed_from, claimed_to, markdown(claims_grid(made)).c_str());
  return all_hold(made) ? good : law_broken;
}

int steps(const AccuracyOptions& o) {
  json out = json::array();
  for (const std::string& name : o.subjects)
    for (const double away : o.away)
      for (const double damping : o.dampings.empty() ? std::vector<double>{own_damping} : o.dampings) {
        if (interrupted()) break;
        json warnings;
        const Convergence c = converge(open_subject(name, o, away, warnings), rungs(o.ops), damping, settings(o));
        if (o.as_json) {
          out.push_back(steps_json(c));
          if (!warnings.is_null()) out.back()["warnings"] = warnings;
        } else {
          print_steps(c);
        }
        if (!o.out.empty()) write(std::filesystem::path(o.out) / (name + "_steps.svg"), bench::standalone(picture(c)));
      }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  return good;
}

/// Whole simulations.
int simulations(const AccuracyOptions& o) {
  accuracy::SimulationOptions measured = o.simulated.measured;
  measured.duration = options::seconds_of(o.simulated.duration);
  measured.ops = o.ops;
  measured.stop = interrupted;
  if (o.no_time) measured.budget = 0;
  if (!o.simulated.picture.empty() && (o.no_time || o.subjects.size() != 1))
    throw ModelError(o.simulated.picture, "--picture", o.no_time ? "is given with --no-time" : "is given with several scenes", "one scene, and its times");
  if (const std::string& file = o.simulated.picture; !file.empty() && !std::ofstream(file, std::ios::app))
    throw ModelError(file, "--picture", "cannot be written", "a .svg file in a folder that exists; make the folder first");
  json out = json::array();
  for (const std::string& name : o.subjects) {
    if (interrupted()) break;
    if (is_family(name)) throw ModelError("", "--simulate", "is given with the family " + in_quotes(name) + ", which does not move", "scenes; `delassus list scenes`");
    const Scene scene = open(name, o.opening);
    const SimulatedScene s = measure_simulation(scene, measured);
    out.push_back(simulated_json(s));
    if (const json warnings = warnings_json(scene); !warnings.empty()) out.back()["warnings"] = warnings;
    if (!o.as_json) print_simulated(s);
    if (o.simulated.picture.empty()) continue;
    const std::string svg = picture(s);
    if (svg.empty()) throw ModelError(o.simulated.picture, "--picture", "has nothing to show, or gnuplot cannot be run", "a scene of which a run ends well, and a machine with gnuplot");
    write(std::filesystem::absolute(o.simulated.picture), bench::standalone(svg));
  }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  return good;
}

/// The figures of docs/accuracy.md.
int all(const AccuracyOptions& o) {
  accuracy::Options timed = settings(o);
  if (o.dampings.empty()) timed.dampings = dampings_up_to(1e14);
  const auto progress = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  const Campaign c = run_campaign({{}, rungs(o.ops), timed, true, o.seconds}, progress);
  std::vector<Table> scenes = c.here;
  scenes.insert(scenes.end(), c.away.begin(), c.away.end());
  const std::vector<Claim> made = claims(scenes, o.claim);
  std::string text = "## Claims\n" + markdown(claims_grid(made)) + "\n## Costs\n" + markdown(costs_grid(costs(c.here))) +
                     "\n## Digits kept\n" + markdown(digits_grid(c.families)) + "\n## Left out\n";
  for (const std::string& line : c.left_out) text += "- " + line + "\n";
  std::printf("%s", text.c_str());
  if (!o.out.empty()) {
    const std::filesystem::path out = o.out;
    json j = json::array();
    for (const std::vector<Table>* tables : {&std::as_const(scenes), &c.families})
      for (const Table& t : *tables) j.push_back(to_json(t));
    write(out / "accuracy.json", j.dump(1) + "\n");
    write(out / "tables.md", text);
    write(out / "overview.svg", bench::standalone(overview(c.here, Price::time)));
    write(out / "overview_operations.svg", bench::standalone(overview(c.here, Price::operations)));
    for (const Table& t : c.here) write_pictures(t, out);
  }
  return all_hold(made) ? good : law_broken;
}

int run_accuracy(const AccuracyOptions& o) {
  if (o.all != o.subjects.empty())
    throw ModelError("", "accuracy", o.all ? "--all and a subject are given" : "no subject is given", "scenes and families, or --all; give one of the two");
  for (const double d : o.dampings)
    if (!(std::isfinite(d) && (d > 0 || (o.steps && d == 0))))
      throw ModelError("", "--damping", number_text(d) + " 1/kg", "a finite number above 0 [1/kg]; with --steps also 0");
  if (o.all && o.steps) throw ModelError("", "accuracy", "--all and --steps are given", "--steps with subjects; leave one of the two away");
  static_cast<void>(rungs({o.claim}));  // throws, listing the names
  keep_on_interrupt();
  return end_of_run(o.all ? all(o) : o.steps ? steps(o) : o.simulate ? simulations(o) : some(o), "what follows was not measured");
}

}  // namespace

void add_accuracy(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("accuracy", "error against time and operations for every rung and damping");
  auto o = std::make_shared<AccuracyOptions>();
  c->add_option("SUBJECT", o->subjects, "scenes (also files and swimmer:N) and families");
  const options::Option* simulate = c->add_flag("--simulate", o->simulate, "whole simulations of scenes: integrators, solvers, tolerances and steps");
  c->add_option("--n", o->n, "size of families; when left out, the middle one")->check(options::whole(1))->excludes(simulate);
  c->add_option("--seed", o->seed, "of families and of the right-hand side")->check(options::whole(0))->capture_default_str()->excludes(simulate);
  c->add_option("--damping", o->dampings, "R⁻¹ of every row [1/kg]; when left out, 1e-14, 1e-12, … 1e-2")->check(options::at_least(0, "1/kg"))->excludes(simulate);
  c->add_option("--op", o->ops, "only these rungs; with --simulate, these operators of equations");
  c->add_option("--away", o->away, "move scenes by this along x before their kinematics [m]")->check(options::any_number("m"))->capture_default_str()->excludes(simulate);
  c->add_option("--rhs", o->rhs, "consistent: a = J ν; random: any a")->check(options::one_of({"consistent", "random"}))->capture_default_str()->excludes(simulate);
  c->add_option("--claim", o->claim, "the rung the claim is about")->capture_default_str()->excludes(simulate);
  c->add_option("--out", o->out, "directory for the pictures (SVG)")->excludes(simulate);
  c->add_option("--seconds", o->seconds, "with --all: what is not begun by then is left out")->check(options::above(0, "s"))->capture_default_str()->excludes(simulate);
  c->add_flag("--all", o->all, "every scene at its place and 1000 km away, every family at its own damping; to 1e14 where timed")->excludes(simulate);
  c->add_flag("--steps", o->steps, "the error after each step of refinement, proximal and Krylov iterations, at --damping (0: hard rows) or the own one")->excludes(simulate);
  c->add_flag("--no-time", o->no_time, "no times, no counted operations, no pictures");
  c->add_flag("--json", o->as_json, "an array of {subject, dof, rows, away, levels, of scenes also warnings}");
  add_simulate_options(*c, o->simulated, simulate);
  add_scene_options(*c, o->opening);
  c->footer("Errors are against an answer in Quad: max|δλ|/max|λ|, ‖δν‖/‖ν‖ in the norm of M, backward. The motion of lcaba_refined "
            "is its own ν, that of others M⁻¹Jᵀλ. The claim: on scenes, from 1e-14 to 1e-2, a rung's motion error is "
            "below 1e-10, its λ error below 30 roundings and its certificate true. Ctrl-C keeps what was measured. Exit code 1 when it is false.");
  c->callback([=, &run] { run = [=] { return run_accuracy(*o); }; });
}

}  // namespace delassus::cli
