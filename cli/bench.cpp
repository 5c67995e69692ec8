// `delassus bench`: times, counted operations and memory of operators on scenes; comparison with an earlier run.
#include <cstdio>
#include <fstream>

#include "bench/cell.h"
#include "bench/machine.h"
#include "bench/page/scene_facts.h"
#include "bench/text.h"
#include "cli/bench_results.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct BenchOptions {
  std::vector<std::string> scenes, ops;
  std::string baseline;
  double budget = 0.02, slack = 1.5;
  bool as_json = false, table1 = false, peers = false, simulation = false, swimmers = false, solvers = false, choose = false, calibrate = false, ladders = false;
  std::vector<std::string> compared, ladder_names;
  std::string from, probe, pictures;
  std::int64_t largest = 100000;
  double longest = 1, gigabytes = 1, operations = 5e8;
  SceneOptions opening;
  SolversOptions of_solvers;
};

constexpr const char* phases[] = {"analyze", "update", "new_damping", "apply", "solve"};

json scene_json(const std::string& name, const BenchOptions& o) {
  const Scene scene = open(name, o.opening);
  bench::SceneResult r = bench::facts_of(scene, false);
  const Problem<double> problem = problem_of(scene);
  r.kinematics = bench::time_kinematics(scene.model, scene.q, o.budget);
  for (const OperatorRow* row : chosen_operators(o.ops))
    r.cells.push_back(bench::measure(*row, problem, scene.damping, {o.budget, 0.1}));
  json j = r;
  j["warnings"] = warnings_json(scene);
  return j;
}

std::string lowest(const json& timing) { return timing.is_null() ? "–" : bench::three_digits(timing["lowest"]); }

void print_scene(const json& s) {
  std::printf("%s: %lld dofs, %lld rows; kinematics %s µs\n", s["scene"].get<std::string>().c_str(), s["dof"].get<long long>(),
              s["rows"].get<long long>(), lowest(s["kinematics_microseconds"]).c_str());
  std::printf("  %-18s %10s %10s %12s %10s %10s   [µs]  %12s %10s\n", "operator", "analyze", "update", "new damping", "apply",
              "solve", "operations", "memory");
  for (const json& c : s["operators"]) {
    std::string line = "  " + bench::pad_right(c["operator"], 18);
    for (const char* phase : phases)
      line += " " + bench::pad_left(lowest(c["microseconds"][phase]), phase == std::string("new_damping") ? 12 : 10);
    const json& n = c["operations"]["update"];
    line += "         " + bench::pad_left(n.is_null() ? "–" : bench::short_count(n), 12) + " " +
            bench::pad_left(bench::short_bytes(c["bytes"]), 10);
    if (c["solve_status"] != "ok" && c["solve_status"] != "") line += "  solve: " + c["solve_status"].get<std::string>();
    std::printf("%s\n", line.c_str());
  }
}

json read_baseline(const std::string& file) {
  std::ifstream stream(file);
  const std::string accepted = "the results.json of a report, or what `delassus bench --json` prints; write one of them first";
  if (!stream) throw ModelError(file, "file", "cannot be read", accepted);
  json j = json::parse(stream, nullptr, false);
  if (j.is_discarded() || !j.is_object() || !j.contains("scenes")) throw ModelError(file, "JSON", j.is_discarded() ? "is broken, or holds a number beyond double" : "has no `scenes`", accepted);
  return j["scenes"];
}

/// Prints every phase slower than slack × the baseline, and every count of operations that grew; returns how many.
int compare(const json& now, const json& before, double slack) {
  int worse = 0;
  for (const char* phase : phases) {
    const json &a = now["microseconds"][phase], &b = before["microseconds"][phase];
    if (a.is_null() || b.is_null() || a["lowest"].get<double>() <= slack * b["lowest"].get<double>()) continue;
    ++worse;
    std::fprintf(stderr, "slower: %s %s: %s µs, baseline %s µs\n", now["operator"].get<std::string>().c_str(), phase,
                 lowest(a).c_str(), lowest(b).c_str());
  }
  for (const auto& [phase, n] : now["operations"].items()) {
    const json& b = before["operations"][phase];
    if (n.is_null() || b.is_null() || n <= b) continue;
    ++worse;
    std::fprintf(stderr, "more work: %s %s: %s operations, baseline %s\n", now["operator"].get<std::string>().c_str(),
                 phase.c_str(), n.dump().c_str(), b.dump().c_str());
  }
  return worse;
}

int compare_all(const json& scenes, json baseline, double slack) {
  int worse = 0;
  for (const json& s : scenes)
    for (json& b : baseline) {
      if (b["scene"] != s["scene"]) continue;
      for (const json& c : s["operators"])
        for (json& d : b["operators"])
          if (c["operator"] == d["operator"]) worse += compare(c, d, slack);
    }
  return worse;
}

int run_bench(const BenchOptions& o) {
  if (!o.compared.empty()) return run_compare(o.compared, o.slack, o.as_json);
  if (o.table1) return run_table1({o.scenes, o.ops, o.from, o.probe, o.budget, o.as_json});
  if (o.peers) return run_peers({o.scenes, o.from, o.budget, o.as_json});
  if (o.simulation) return run_simulation({o.scenes, o.from, 50 * o.budget, o.as_json});
  if (o.swimmers) return run_swimmers({o.from, o.pictures, o.budget, o.longest, o.gigabytes, o.largest, o.as_json});
  if (o.ladders) return run_ladders({o.ladder_names, o.ops, o.from, o.pictures, o.operations, o.gigabytes, o.as_json});
  if (!o.pictures.empty() && !o.solvers) throw ModelError("", "--pictures", "given without --swimmers, --ladders or --solvers", "one of these three; the others draw nothing");
  if (o.solvers) {
    SolversOptions s = o.of_solvers;
    s.from = o.from, s.pictures = o.pictures, s.as_json = o.as_json;
    return run_solvers(s);
  }
  if (o.choose || o.calibrate) return run_choose({o.scenes, o.ops, o.budget, o.calibrate});
  json baseline;
  if (!o.baseline.empty()) baseline = read_baseline(o.baseline);
  json out = {{"units", {{"time", "µs per call"}, {"memory", "bytes"}}}, {"scenes", json::array()}};
  const bench::Machine m = bench::this_machine();
  out["machine"] = {{"processor", m.processor}, {"compiler", m.compiler}, {"flags", m.flags}, {"revision", m.revision}, {"date", m.date}};
  for (const std::string& name : o.scenes.empty() ? scene_names() : o.scenes) {
    out["scenes"].push_back(scene_json(name, o));
    if (!o.as_json) print_scene(out["scenes"].back());
  }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  return !o.baseline.empty() && compare_all(out["scenes"], baseline, o.slack) ? slower : good;
}

}  // namespace

void add_bench(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("bench", "time, counted operations and memory of operators on scenes");
  auto o = std::make_shared<BenchOptions>();
  c->add_option("--scene", o->scenes, "only these scenes (also files and swimmer:N)");
  c->add_option("--op", o->ops, "only these operators");
  c->add_option("--budget", o->budget, "seconds of timing per phase")->check(options::above(0, "s"))->capture_default_str();
  options::Option* table1 = c->add_flag("--table1", o->table1, "the paper's Table I: thirteen scenes, every column, every operator, beside the paper's figures (docs/results.md)");
  options::Option* peers = c->add_flag("--peers", o->peers, "beside Pinocchio and MuJoCo, those that this program was built with: results compared, then timed in turn (docs/peers.md)");
  peers->excludes(table1);
  options::Option* simulation = c->add_flag("--simulation", o->simulation, "steps per second of the examples beside MuJoCo's, both judged by one residual; a row gets 50 budgets (docs/simulation_speed.md)");
  simulation->excludes(table1)->excludes(peers);
  options::Option* swimmers = c->add_flag("--swimmers", o->swimmers, "the paper's Fig. 2: every operator on swimmers of growing length, with the slopes");
  swimmers->excludes(table1)->excludes(peers)->excludes(simulation);
  options::Option* ladders = c->add_flag("--ladders", o->ladders, "how counted operations grow on chains, trees, crowds, walls, lattices …: measured order against the declared one, crossovers (docs/ladders.md)");
  ladders->excludes(table1)->excludes(peers)->excludes(simulation)->excludes(swimmers);
  c->add_option("ladder", o->ladder_names, "only these ladders")->needs(ladders);
  c->add_option("--operations", o->operations, "a row is left out where one of its phases would take more")->check(options::above(0, ""))->needs(ladders)->capture_default_str();
  options::Option* solvers = c->add_flag("--solvers", o->solvers, "contact solvers: success over the density of contacts, failures, performance profiles at 1e-4, 1e-8, 1e-12 (docs/solvers.md)");
  solvers->excludes(table1)->excludes(peers)->excludes(simulation)->excludes(swimmers)->excludes(ladders);
  c->add_option("--solver", o->of_solvers.solvers, "only these solvers")->needs(solvers);
  c->add_option("--problems", o->of_solvers.problems, "a folder of contact problems, *.dat, besides the generated ones")->needs(solvers);
  c->add_option("--seeds", o->of_solvers.seeds, "generated problems of each kind")->check(options::whole(1))->needs(solvers)->capture_default_str();
  c->add_option("--iterations", o->of_solvers.iterations, "that a solver has at most")->check(options::whole(1))->needs(solvers)->capture_default_str();
  c->add_option("--from", o->from, "print what --table1, --peers, --simulation, --swimmers, --ladders or --solvers wrote with --json instead of measuring");
  options::Option* choose = c->add_flag("--choose", o->choose, "1, 10 and 1000 answers at one configuration: the row that choose() names (algorithms/operators/choose.h) against the fastest, and from how many on explicit ones win; exit code 3 beyond 1.1");
  choose->excludes(table1)->excludes(peers)->excludes(simulation)->excludes(swimmers)->excludes(ladders);
  c->add_flag("--calibrate", o->calibrate, "print algorithms/operators/kernel_costs.cpp, what choose() counts with, as measured here; how well it fits to standard error")->excludes(table1)->excludes(peers)->excludes(simulation)->excludes(swimmers)->excludes(ladders)->excludes(choose);
  c->add_option("--largest", o->largest, "links of the longest swimmer")->check(options::whole(3))->needs(swimmers)->capture_default_str();
  c->add_option("--longest", o->longest, "an operator is left out where one of its phases would take longer [s]")->check(options::above(0, "s"))->needs(swimmers)->capture_default_str();
  c->add_option("--memory", o->gigabytes, "or it would hold more [GB], with --swimmers or --ladders")->check(options::above(0, "GB"))->capture_default_str();
  c->add_option("--pictures", o->pictures, "directory for the pictures of --swimmers, --ladders or --solvers");
  c->add_option("--compare", o->compared, "two files of results, before and after: what changed by more than its spread explains (nothing is measured)");
  c->add_option("--cache-lines", o->probe, "a phase_probe (scripts/build avx2 phase_probe: build/avx2/bench/phase_probe) to count distinct cache lines with, by valgrind")->check(options::existing_file())->needs(table1);
  c->add_option("--baseline", o->baseline, "JSON of an earlier run on the same machine");
  c->add_option("--slack", o->slack, "how many times slower than the baseline is still accepted")->check(options::above(0, ""))->capture_default_str();
  c->add_flag("--json", o->as_json, "{machine, units, scenes}");
  add_scene_options(*c, o->opening);
  c->footer("Times are the lowest of several batches; medians with --table1, --peers, --simulation and --swimmers. Exit code 1 when a peer disagrees with the definition; 3 when a phase is slower than slack × baseline or needs "
            "more counted operations; with --compare, significantly.");
  c->callback([=, &run] { run = [=] { return run_bench(*o); }; });
}

}  // namespace delassus::cli
