#include "cli/bench_results.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "bench/compare.h"
#include "bench/scaling/figure2.h"
#include "bench/peers/peer_table.h"
#include "bench/phase_times.h"
#include "bench/report.h"
#include "bench/scaling/scaling.h"
#include "bench/simulation/simulation_speed.h"
#include "bench/simulation/solver_profile.h"
#include "bench/table1/table1.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/interrupt.h"
#include "generators/build.h"
#include "generators/families.h"
#include "generators/ladders.h"

namespace delassus::cli {

namespace {

json read_json(const std::string& file, const std::string& accepted) {
  std::ifstream stream(file);
  if (!stream) throw ModelError(file, "file", "cannot be read", accepted);
  json j = json::parse(stream, nullptr, false);
  if (j.is_discarded()) throw ModelError(file, "JSON", "is broken, or holds a number beyond double", accepted);
  return j;
}

template <class Results> Results read_results(const std::string& file, const std::string& accepted) {
  try {
    return read_json(file, accepted).get<Results>();
  } catch (const json::exception& e) {
    throw ModelError(file, "JSON", std::string("holds other results: ") + e.what(), accepted);
  }
}

void say(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

template <class Results> void print(const Results& r, bool as_json, std::string (*text)(const Results&)) {
  std::printf("%s", as_json ? (json(r).dump(1) + "\n").c_str() : text(r).c_str());
}

}  // namespace

int run_table1(const Table1Options& o) {
  if (!o.from.empty()) {
    print(read_results<bench::TableOne>(o.from, "what `delassus bench --table1 --json` prints; write it with > FILE"), o.as_json, bench::table_text);
    return good;
  }
  keep_on_interrupt();
  const bench::TableOptions options{o.scenes, o.ops.empty() ? std::vector<const OperatorRow*>{} : chosen_operators(o.ops), o.budget, o.probe, interrupted};
  print(bench::measure_table(options, say), o.as_json, bench::table_text);
  return end_of_run(good, "scenes are missing");
}

namespace {
/// Ours beside programs from outside: what a run wrote (`from`), or measured now.
template <class Table, class Measure>
int run_beside(const std::string& from, bool as_json, const std::string& option, const char* missing, const Measure& measure, std::string (*text)(const Table&)) {
  if (from.empty()) keep_on_interrupt();
  const Table t = from.empty() ? measure() : read_results<Table>(from, "what `delassus bench " + option + " --json` prints; write it with > FILE");
  print(t, as_json, text);
  return from.empty() ? end_of_run(t.disagreements() > 0 ? law_broken : good, missing) : good;
}
}  // namespace

int run_peers(const PeersOptions& o) {
  return run_beside(o.from, o.as_json, "--peers", "scenes are missing", [&] { return bench::measure_peers(o.scenes, bench::peers(), o.budget, say, interrupted); }, bench::peer_text);
}

int run_simulation(const SimulationOptions& o) {
  return run_beside(o.from, o.as_json, "--simulation", "examples are missing", [&] { return bench::measure_speed(o.scenes, bench::simulators(), o.budget, say, interrupted); },
                    bench::speed_text);
}

int run_swimmers(const SwimmersOptions& o) {
  bench::Figure2 f;
  if (!o.pictures.empty()) bench::check_writable(o.pictures);
  if (!o.from.empty()) {
    f = read_results<bench::Figure2>(o.from, "what `delassus bench --swimmers --json` prints; write it with > FILE");
  } else {
    keep_on_interrupt();
    f = bench::measure_swimmers(o.largest, o.budget, o.longest, 1e9 * o.gigabytes, say, interrupted);
  }
  print(f, o.as_json, bench::figure2_text);
  if (!o.pictures.empty())
    for (const bool solves : {false, true})
      std::ofstream(std::filesystem::path(o.pictures) / (solves ? "swimmers_solve.svg" : "swimmers_product.svg")) << bench::figure2_picture(f, solves);
  return o.from.empty() ? end_of_run(good, "lengths are missing") : good;
}

int run_ladders(const LaddersOptions& o) {
  bench::Scaling s;
  if (!o.pictures.empty()) bench::check_writable(o.pictures);
  if (!o.from.empty()) {
    s = read_results<bench::Scaling>(o.from, "what `delassus bench --ladders --json` prints; write it with > FILE");
  } else {
    std::vector<const generators::LadderRow*> rows;
    for (const std::string& name : o.ladders) rows.push_back(&generators::find_ladder(name));
    for (const generators::LadderRow& row : generators::ladders())
      if (o.ladders.empty()) rows.push_back(&row);
    keep_on_interrupt();
    s = bench::measure_scaling(rows, chosen_operators(o.ops), {o.operations, 1e9 * o.gigabytes, false, say, interrupted});
  }
  print(s, o.as_json, bench::scaling_text);
  const std::pair<const char*, Asks> pictures[] = {{"chain", Asks::product}, {"lattice", Asks::first_solve}, {"crossed", Asks::first_solve}};
  for (const auto& [ladder, what] : pictures)
    if (const std::string svg = o.pictures.empty() ? "" : bench::scaling_picture(s, ladder, what); !svg.empty())
      std::ofstream(std::filesystem::path(o.pictures) / (std::string("ladder_") + ladder + ".svg")) << svg;
  return o.from.empty() ? end_of_run(good, "sizes are missing") : good;
}

int run_solvers(const SolversOptions& o) {
  if (!o.pictures.empty()) bench::check_writable(o.pictures);
  bench::SolverProfile p;
  if (!o.from.empty()) {
    p = read_results<bench::SolverProfile>(o.from, "what `delassus bench --solvers --json` prints; write it with > FILE");
  } else {
    std::vector<simulation::SolverRow> rows;
    for (const std::string& name : o.solvers) rows.push_back(simulation::find_solver(name));
    auto problems = bench::generated_problems(static_cast<int>(o.seeds));
    if (!o.problems.empty())
      for (auto& q : bench::problems_of(o.problems)) problems.push_back(std::move(q));
    keep_on_interrupt();
    p = bench::profile_solvers(problems, rows.empty() ? simulation::solvers() : rows, static_cast<int>(o.iterations), say, interrupted);
  }
  std::printf("%s", (o.as_json ? bench::solver_json(p) : bench::solver_text(p)).c_str());
  for (const std::string& set : o.pictures.empty() ? std::vector<std::string>{} : bench::sets_of(p))
    for (std::size_t k = 0; k < bench::wanted_count; ++k)
      for (const auto by : {bench::Measure::time, bench::Measure::iterations})
        std::ofstream(std::filesystem::path(o.pictures) / bench::format("solvers_%s_%.0e_%s.svg", set.c_str(), bench::wanted_residuals[k], by == bench::Measure::time ? "time" : "iterations"))
            << bench::solver_picture(p, set, k, by);
  return o.from.empty() ? end_of_run(good, "problems are missing") : good;
}

namespace {
/// Swimmers and families beside the scenes, so that few bodies with many rows and many with few have their part.
std::vector<bench::ChoiceRow> calibration(const std::vector<const OperatorRow*>& rows, double budget) {
  std::vector<bench::ChoiceRow> out;
  const auto add = [&](const std::string& name, const Problem<double>& problem) {
    const Index m = problem.structure->rows;
    if (m == 0 || m > 300 || interrupted()) return;
    out.push_back(bench::measure_choice(name, problem, Damping<double>::uniform(m, 1e-4), rows, budget));
  };
  for (const int links : {5, 8, 12, 20, 30, 50, 80, 120, 200, 300})
    add("swimmer:" + std::to_string(links), problem_of(open_scene("swimmer:" + std::to_string(links))));
  for (const generators::FamilyRow& family : generators::families())
    for (const Index n : {8, 16, 32, 64}) add(std::string(family.name) + ":" + std::to_string(n), generators::build(family.make(n, 1)).problem);
  return out;
}
}  // namespace

int run_choose(const ChooseOptions& o) {
  keep_on_interrupt();
  const std::vector<const OperatorRow*> rows = o.calibrate ? bench::calibrated_rows() : chosen_operators(o.ops);
  std::vector<bench::ChoiceRow> measured = o.calibrate ? calibration(rows, o.budget) : std::vector<bench::ChoiceRow>{};
  for (const std::string& name : o.scenes.empty() ? scene_names() : o.scenes) {
    if (interrupted()) break;
    const Scene scene = open(name, {});
    const Problem<double> problem = problem_of(scene);
    if (problem.structure->rows == 0) continue;
    say(name);
    measured.push_back(bench::measure_choice(name, problem, scene.damping, rows, o.budget));
    measured.back().weight = 8;
  }
  std::printf("%s", (o.calibrate ? bench::calibrated(measured) : bench::choices_text(measured)).c_str());
  if (o.calibrate) say(bench::predictions_text(measured));
  const int code = !o.calibrate && bench::worst_ratio(measured) > bench::promised_ratio ? slower : good;
  return end_of_run(code, "scenes are missing");
}

int run_compare(const std::vector<std::string>& files, double slack, bool as_json) {
  const std::string accepted = "what `delassus bench --json` or `delassus bench --table1 --json` prints, or a report's results.json; write it with > FILE";
  if (files.size() != 2) throw ModelError("", "--compare", std::to_string(files.size()) + " files", "two: before and after; name both behind --compare");
  const bench::Comparison c = bench::compare(read_json(files[0], accepted), read_json(files[1], accepted), files[0], files[1]);
  print(c, as_json, bench::comparison_text);
  return c.worse(slack) > 0 ? slower : good;
}

}  // namespace delassus::cli
