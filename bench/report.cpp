#include "bench/report.h"

#include <fstream>
#include <numeric>

#include <nlohmann/json.hpp>

#include "bench/accuracy/accuracy_campaign.h"
#include "bench/accuracy/accuracy_digest.h"
#include "bench/scaling/ladder.h"
#include "bench/machine.h"
#include "bench/page/page.h"
#include "bench/page/scene_facts.h"
#include "bench/text.h"
#include "bench/verify.h"
#include "property_tests/laws/laws.h"
#include "reference/reference.h"

namespace delassus::bench {

namespace {

constexpr double check_limit = 60, quick_limit = 5;   // seconds per scene for what does not come first (verify.h)

using Ops = std::vector<const OperatorRow*>;

Ops chosen(const ReportOptions& options) {
  if (!options.ops.empty()) return options.ops;
  Ops all;
  for (const OperatorRow& o : operators()) all.push_back(&o);
  return all;
}

void copy_tables(const Ops& ops, Results& r) {
  for (const OperatorRow* o : ops)
    r.operators.push_back({std::string(o->name), std::string(o->summary), std::string(o->formula), std::string(o->source),
                           std::string(o->cost), std::string(name(o->apply_error)), std::string(name(o->solve_error)),
                           o->applies, o->solves, o->zero_damping});
  for (const laws::LawRow& l : laws::laws())
    r.laws.push_back({std::string(l.name), std::string(l.identity), std::string(l.bound)});
  for (const reference::ReferenceRow& f : reference::references())
    r.references.push_back({std::string(f.name), std::string(f.summary), std::string(f.trusted_where)});
}

void time_scene(const Scene& scene, const Ops& ops, const Limits& limits, SceneResult& out) {
  const Problem<double> problem = problem_of(scene);
  out.kinematics = time_kinematics(scene.model, scene.q, limits.budget);
  for (const OperatorRow* row : ops) out.cells.push_back(measure(*row, problem, scene.damping, limits));
}

std::string verdict_line(const SceneResult& s) {
  int checked = 0, failed = 0;
  double worst = 0;
  for (const Cell& c : s.cells) {
    checked += c.checked();
    failed += c.failed();
    if (const LawResult* w = c.worst(); w && !(w->ratio <= worst)) worst = w->ratio;
  }
  const int left = std::accumulate(s.cells.begin(), s.cells.end(), 0, [](int n, const Cell& c) { return n + c.left_out(); });
  if (checked == 0) return "no law could be checked";
  return format("%d checks, worst ratio ", checked) + ratio_text(worst) +
         (failed ? format(", %d FAILED", failed) : std::string(left ? ", hold" : ", all hold")) + (left ? format(", %d left out", left) : std::string());
}

void check_scenes(const std::vector<Scene>& scenes, const Ops& ops, const ReportOptions& options, Results& r, const Progress& progress) {
  int n = 0;
  const double seconds = options.quick ? quick_limit : check_limit;
  verify(scenes, ops, {seconds, options.stop, !options.quick}, r.scenes, [&](const SceneResult& s) {
    progress(format("check %2d/%zu  %s  ", ++n, scenes.size(), pad_right(s.name, 26).c_str()) + verdict_line(s));
  });
}

constexpr double accuracy_time = 10;  // seconds; what has not begun by then is left out

AccuracyResult accuracy_of(const ReportOptions& options, const Progress& progress) {
  accuracy::Options timed{.dampings = accuracy::dampings_up_to(1e-2), .budget = 0.001, .stop = options.stop, .longest = 0.02};
  const accuracy::Campaign c =
      accuracy::run_campaign({options.scenes, accuracy::rungs(), timed, false, options.quick ? accuracy_time / 2 : accuracy_time, options.scenes.empty()}, progress);
  return {accuracy::overview(c.here, accuracy::Price::time), accuracy::digits_grid(c.families), c.left_out};
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw ModelError(path.string(), "file", "cannot be written", "a directory with write permission; choose another --out");
}

}  // namespace

Results run_report(const ReportOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Limits limits{options.quick ? 0.004 : 0.02, options.quick ? 0.02 : 0.1};
  Results r;
  r.machine = this_machine();
  r.quick = options.quick;
  r.chosen = !options.scenes.empty();
  const auto stopped = [&] { return options.stop && options.stop(); };
  const Ops ops = chosen(options);
  copy_tables(ops, r);
  std::vector<Scene> scenes;
  for (const std::string& name : options.scenes.empty() ? scene_names() : options.scenes) scenes.push_back(open_scene(name, options.opening));
  int n = 0;
  for (const Scene& scene : scenes) {
    if (stopped()) break;
    r.scenes.push_back(facts_of(scene));
    SceneResult& s = r.scenes.back();
    for (const Warning& w : scene.warnings) s.notes.push_back("warning: " + w.text);
    time_scene(scene, ops, limits, s);
    progress(format("time  %2d/%zu  %s  %lld dofs, %lld rows", ++n, scenes.size(), pad_right(s.name, 26).c_str(),
                    static_cast<long long>(s.dofs), static_cast<long long>(s.rows)));
  }
  r.accuracy = accuracy_of(options, progress);
  if (options.ladder && options.ops.empty() && !r.chosen)
    r.ladder = climb(ladder_sizes(options.quick ? 1000 : 10000), limits, options.quick ? 0.2 : 1.0, 5e8,
                     [&](const std::string& line) { progress("size  " + line); }, options.stop);
  scenes.resize(r.scenes.size());
  if (options.check) check_scenes(scenes, ops, options, r, progress);
  r.interrupted = stopped();
  r.seconds = seconds_since(start);
  return r;
}

void check_writable(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!error) {
    const std::filesystem::path probe = directory / ".delassus-can-write";
    write_file(probe, "");
    std::filesystem::remove(probe, error);
  }
  if (error) throw ModelError(directory.string(), "directory", error.message(), "a directory that can be made and written; choose another --out");
}

void write_report(const Results& results, const std::filesystem::path& directory) {
  check_writable(directory);
  write_file(directory / "index.html", page(results));
  write_file(directory / "results.json", nlohmann::json(results).dump(1) + "\n");
}

int exit_code(const Results& results) { return results.failed() > 0 ? 1 : 0; }

std::string text_table(const Results& r) {
  std::string s = pad_right("scene", 28) + pad_right("operator", 17) + pad_left("rows", 6) + pad_left("update µs", 12) +
                  pad_left("apply µs", 11) + pad_left("solve µs", 15) + "  laws\n";
  for (const SceneResult& scene : r.scenes)
    for (const Cell& c : scene.cells) {
      const LawResult* w = c.worst();
      const bool solved = c.solve_status.empty() || c.solve_status == "ok";
      s += pad_right(scene.name, 28) + pad_right(c.op, 17) + pad_left(std::to_string(scene.rows), 6) +
           pad_left(three_digits(c.time.update.lowest), 12) + pad_left(three_digits(c.time.apply.lowest), 11) +
           pad_left(solved ? three_digits(c.time.solve.lowest) : c.solve_status, 15) + "  " +
           (!w ? "not checked" : (c.failed() ? format("%d FAILED, ", c.failed()) : std::string("hold, ")) + "worst " + ratio_text(w->ratio)) +
           (c.left_out() ? format(", %d left out", c.left_out()) : std::string()) +
           "\n";
    }
  for (const SceneResult& scene : r.scenes)
    for (const Cell& c : scene.cells)
      for (const LawResult& l : c.laws)
        if (l.skipped.empty() && !l.passed) s += "FAILED  " + scene.name + "  " + c.op + "  " + l.law + "  ratio " + ratio_text(l.ratio) + "  " + l.note + "\n";
  return s;
}

}  // namespace delassus::bench
