// The cells of the report under Google Benchmark: `bench --benchmark_filter=go2_standing/lcaba`. Moreover
//   columns_K          K columns at once, one_by_one_K: the same in K calls (K = 2 … 16)
//   one_entry          a vector of zeros but for its first entry, on chains of 10⁴ links: what forces that decay below the
//                      normal numbers cost
#include <benchmark/benchmark.h>

#include "bench/cell.h"
#include "generators/build.h"
#include "generators/families.h"
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

void add_columns(const std::string& scene, const OperatorRow& row, Index k, bool together) {
  const std::string phase = (together ? "columns_" : "one_by_one_") + std::to_string(k);
  benchmark::RegisterBenchmark((scene + "/" + std::string(row.name) + "/" + phase).c_str(),
                               [scene, &row, k, together](benchmark::State& state) {
                                 Fixture f(row, open_scene(scene));
                                 Workspace<double> w(f.op->workspace(k));
                                 const MatrixX<double> in = f.in.replicate(1, k);
                                 MatrixX<double> out = in;
                                 const auto run = [&](ConstRef<double> x, Ref<double> y) { return row.applies ? f.op->apply(x, y, w) : f.op->solve(x, y, w); };
                                 for (auto _ : state)
                                   if (together) benchmark::DoNotOptimize(run(in, out));
                                   else
                                     for (Index c = 0; c < k; ++c) benchmark::DoNotOptimize(run(in.col(c), out.col(c)));
                               })
      ->Unit(benchmark::kMicrosecond);
}

/// The family `chain` or `swimmer` of generators/: constraints at the ends alone.
void add_one_entry(const char* family, const OperatorRow& row) {
  for (const bool one : {false, true})
    benchmark::RegisterBenchmark((std::string(family) + ":10000/" + std::string(row.name) + (one ? "/one_entry" : "/all_entries")).c_str(),
                                 [family, &row, one](benchmark::State& state) {
                                   const auto built = generators::build(generators::find_family(family).make(10000, 1));
                                   const auto op = row.make<double>();
                                   op->analyze(built.problem.structure);
                                   static_cast<void>(op->update(built.problem, built.damping));
                                   Workspace<double> w(op->workspace());
                                   MatrixX<double> in = bench::sample_vector(op->size()), out = in;
                                   if (one) in.setZero(), in(in.rows() - 1, 0) = 1;
                                   for (auto _ : state) benchmark::DoNotOptimize(row.applies ? op->apply(in, out, w) : op->solve(in, out, w));
                                 })
        ->Unit(benchmark::kMicrosecond);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes = scene_names();
  for (const char* swimmer : {"swimmer:10", "swimmer:100"}) scenes.push_back(swimmer);
  for (const std::string& scene : scenes)
    for (const OperatorRow& row : operators()) add_cells(scene, row);
  for (const std::string& scene : scenes)
    for (const char* name : {"aba_sweep", "lcaba", "ladder"})
      for (const Index k : {2, 3, 4, 5, 8, 9, 11, 16})
        for (const bool together : {true, false}) add_columns(scene, find_operator(name), k, together);
  for (const char* family : {"chain", "swimmer"})
    for (const char* name : {"aba_sweep", "lcaba"}) add_one_entry(family, find_operator(name));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
