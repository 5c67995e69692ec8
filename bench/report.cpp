#include "bench/report.h"

#include <fstream>

#include <nlohmann/json.hpp>

#include "bench/accuracy_campaign.h"
#include "bench/accuracy_digest.h"
#include "bench/ladder.h"
#include "bench/machine.h"
#include "bench/page.h"
#include "bench/scene_facts.h"
#include "bench/text.h"
#include "bench/verify.h"
#include "property_tests/laws.h"
#include "reference/reference.h"

namespace delassus::bench {

namespace {

constexpr double check_limit = 60;         // seconds per scene for all laws
constexpr std::int64_t quick_rows = 120;   // scenes above are not checked in a quick run

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
  if (checked == 0) return "no law could be checked";
  return format("%d checks, worst ratio ", checked) + ratio_text(worst) +
         (failed ? format(", %d FAILED", failed) : std::string(", all hold"));
}

void check_scenes(const std::vector<Scene>& scenes, const Ops& ops, bool quick, Results& r, const Progress& progress) {
  std::vector<Scene> chosen;
  std::vector<SceneResult> results;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (quick && r.scenes[i].rows > quick_rows) continue;
    chosen.push_back(scenes[i]);
    results.push_back(std::move(r.scenes[i]));
    index.push_back(i);
  }
  int n = 0;
  verify(chosen, ops, check_limit, results, [&](const SceneResult& s) {
    progress(format("check %2d/%zu  %s  ", ++n, chosen.size(), pad_right(s.name, 26).c_str()) + verdict_line(s));
  });
  for (std::size_t k = 0; k < index.size(); ++k) r.scenes[index[k]] = std::move(results[k]);
}

constexpr double accuracy_time = 10;  // seconds; what has not begun by then is left out

AccuracyResult accuracy_of(const ReportOptions& options, const Progress& progress) {
  accuracy::Options timed{.dampings = accuracy::dampings_up_to(1e-2), .budget = 0.001, .longest = 0.02};
  const accuracy::Campaign c =
      accuracy::run_campaign({options.scenes, accuracy::rungs(), timed, false, options.quick ? accuracy_time / 2 : accuracy_time}, progress);
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
  const Ops ops = chosen(options);
  copy_tables(ops, r);
  std::vector<Scene> scenes;
  for (const std::string& name : options.scenes.empty() ? scene_names() : options.scenes) scenes.push_back(open_scene(name, options.opening));
  int n = 0;
  for (const Scene& scene : scenes) {
    r.scenes.push_back(facts_of(scene));
    SceneResult& s = r.scenes.back();
    for (const Warning& w : scene.warnings) s.notes.push_back("warning: " + w.text);
    time_scene(scene, ops, limits, s);
    progress(format("time  %2d/%zu  %s  %lld dofs, %lld rows", ++n, scenes.size(), pad_right(s.name, 26).c_str(),
                    static_cast<long long>(s.dofs), static_cast<long long>(s.rows)));
  }
  r.accuracy = accuracy_of(options, progress);
  if (options.ladder && options.ops.empty())
    r.ladder = climb(ladder_sizes(options.quick ? 1000 : 10000), limits, options.quick ? 0.2 : 1.0, 5e8,
                     [&](const std::string& line) { progress("size  " + line); });
  if (options.check) check_scenes(scenes, ops, options.quick, r, progress);
  r.seconds = seconds_since(start);
  return r;
}

void write_report(const Results& results, const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw ModelError(directory.string(), "directory", error.message(), "a directory that can be made and written; choose another --out");
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
           "\n";
    }
  for (const SceneResult& scene : r.scenes)
    for (const Cell& c : scene.cells)
      for (const LawResult& l : c.laws)
        if (l.skipped.empty() && !l.passed) s += "FAILED  " + scene.name + "  " + c.op + "  " + l.law + "  ratio " + ratio_text(l.ratio) + "  " + l.note + "\n";
  return s;
}

}  // namespace delassus::bench
