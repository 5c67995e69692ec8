// The cells of the report under Google Benchmark: `bench --benchmark_filter=go2_standing/lcaba`.
#include <benchmark/benchmark.h>

#include "bench/cell.h"
#include "models/swimmer.h"

namespace {

using namespace delassus;

/// One operator on one scene, made anew for each benchmark.
struct Fixture {
  Fixture(const OperatorRow& row, const Scene& scene)
      : problem(problem_of(scene)), damping(scene.damping), other(bench::other_damping(damping)), op(row.make<double>()) {
    op->analyze(problem.structure);
    static_cast<void>(op->update(problem, damping));
    in = bench::sample_vector(op->size());
    out = in;
  }
  Problem<double> problem;
  Damping<double> damping, other;
  std::unique_ptr<Operator<double>> op;
  MatrixX<double> in, out;
};

using Body = void (*)(benchmark::State&, Fixture&, Workspace<double>&);

void add(const std::string& scene, const OperatorRow& row, const char* phase, Body body) {
  benchmark::RegisterBenchmark((scene + "/" + std::string(row.name) + "/" + phase).c_str(),
                               [scene, &row, body](benchmark::State& state) {
                                 Fixture f(row, open_scene(scene));
                                 Workspace<double> workspace(f.op->workspace());
                                 body(state, f, workspace);
                                 state.counters["rows"] = static_cast<double>(f.op->size());
                               })
      ->Unit(benchmark::kMicrosecond);
}

void add_cells(const std::string& scene, const OperatorRow& row) {
  add(scene, row, "update", [](benchmark::State& s, Fixture& f, Workspace<double>&) {
    for (auto _ : s) benchmark::DoNotOptimize(f.op->update(f.problem, f.damping));
  });
  add(scene, row, "new_damping", [](benchmark::State& s, Fixture& f, Workspace<double>&) {
    bool odd = false;
    for (auto _ : s) benchmark::DoNotOptimize(f.op->update_damping((odd = !odd) ? f.other : f.damping));
  });
  if (row.applies)
    add(scene, row, "apply", [](benchmark::State& s, Fixture& f, Workspace<double>& w) {
      for (auto _ : s) benchmark::DoNotOptimize(f.op->apply(f.in, f.out, w));
    });
  if (row.solves)
    add(scene, row, "solve", [](benchmark::State& s, Fixture& f, Workspace<double>& w) {
      for (auto _ : s) benchmark::DoNotOptimize(f.op->solve(f.in, f.out, w));
    });
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes = scene_names();
  for (const char* swimmer : {"swimmer:10", "swimmer:100"}) scenes.push_back(swimmer);
  for (const std::string& scene : scenes)
    for (const OperatorRow& row : operators()) add_cells(scene, row);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
