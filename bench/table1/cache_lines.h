// Distinct cache lines and instructions of one use of an operator, counted by valgrind (callgrind).
//
// The program phase_probe asks once for each use, between CALLGRIND_START_INSTRUMENTATION and a dump. The simulated first cache
// is larger than everything the program has and starts empty, so that each miss is a line touched for the first time.
// valgrind (3.19) knows no AVX-512: the probe must be built without, as `scripts/build avx2 phase_probe` does.
#pragma once

#include <string>
#include <vector>

namespace delassus::bench {

struct TableRow;

struct ProbeCount {
  std::string op, use;
  long long instructions = -1, lines = -1;
};

/// Fills `lines` of every use that has a time; returns the kernels of the probe. @throws ModelError when it cannot be run.
std::string count_cache_lines(const std::string& probe, TableRow& row);

/// Runs the probe on a scene for pairs `operator/use`. `kernels`, when given, receives those of the probe. @throws ModelError.
[[nodiscard]] std::vector<ProbeCount> run_probe(const std::string& probe, const std::string& scene, const std::vector<std::string>& pairs,
                                              std::string* kernels = nullptr);

}  // namespace delassus::bench
