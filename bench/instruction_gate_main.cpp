// The gate of instruction_gate.h.
//   instruction_gate PROBE BASELINE.json [--renew]      PROBE: a phase_probe that valgrind can run
// The baseline holds counts by kernels and compiler of the probe; without an entry for this one the gate is skipped, and says so.
// Exit code 0: within 2 %, or skipped; 1: not; 2: cannot be run.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/table1/cache_lines.h"
#include "bench/instruction_gate.h"

int main(int argc, char** argv) {
  using namespace delassus::bench;
  using nlohmann::json;
  const bool renew = argc == 4 && std::strcmp(argv[3], "--renew") == 0;
  if (argc != 3 && !renew) return std::fprintf(stderr, "usage: instruction_gate PROBE BASELINE.json [--renew]\n"), 2;
  try {
    std::ifstream file(argv[2]);
    json baseline = file ? json::parse(file) : json::object();
    json counted = json::object();
    std::string kernels;
    for (const auto& [scene, pairs] : gated_cells())
      for (const ProbeCount& c : run_probe(argv[1], scene, pairs, &kernels)) counted[scene + " " + c.op + "/" + c.use] = c.instructions;
    if (renew) {
      baseline[kernels] = counted;
      std::ofstream(argv[2]) << baseline.dump(1) << "\n";
      return std::printf("%zu cells written for %s\n", counted.size(), kernels.c_str()), 0;
    }
    if (!baseline.contains(kernels)) return std::printf("skipped: no baseline for %s; --renew writes one\n", kernels.c_str()), 0;
    const InstructionVerdict v = judge_instructions(baseline[kernels], counted);
    std::printf("%s\n", kernels.c_str());
    for (const std::string& line : v.lines) std::printf("%s\n", line.c_str());
    return v.off > 0 ? 1 : 0;
  } catch (const std::exception& e) {
    return std::fprintf(stderr, "instruction_gate: %s\n", e.what()), 2;
  }
}
