#include "bench/table1/cache_lines.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "algorithms/errors/status.h"
#include "bench/table1/table1.h"

namespace delassus::bench {

namespace {

constexpr const char* how = "a phase_probe without AVX-512, and valgrind: scripts/setup, scripts/build avx2 phase_probe, then --cache-lines build/avx2/bench/phase_probe";

std::string quoted(const std::string& s) {
  std::string out = "'";
  for (const char c : s) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "delassus-probe-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw ModelError(name, "directory", "cannot be made", "a temporary directory with write permission");
    path = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

/// Of one dump: the reason it was asked for, and its totals by event.
std::pair<std::string, std::map<std::string, long long>> read_dump(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string reason;
  std::vector<std::string> events;
  std::map<std::string, long long> totals;
  const std::string trigger = "desc: Trigger: Client Request: ";
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(trigger, 0) == 0) reason = line.substr(trigger.size());
    std::istringstream words(line.substr(line.find(':') + 1));
    if (line.rfind("events:", 0) == 0)
      for (std::string e; words >> e;) events.push_back(e);
    if (line.rfind("totals:", 0) == 0) {  // of this dump; `summary` is not, where instrumentation was stopped before
      long long n = 0;
      for (std::size_t i = 0; i < events.size() && words >> n; ++i) totals[events[i]] = n;
    }
  }
  return {reason, totals};
}

}  // namespace

std::vector<ProbeCount> run_probe(const std::string& probe, const std::string& scene, const std::vector<std::string>& pairs, std::string* kernels) {
  const Folder folder;
  // Caches of one gigabyte and 64-byte lines: nothing is ever evicted.
  std::string command = "valgrind -q --tool=callgrind --instr-atstart=no --cache-sim=yes --I1=1073741824,16,64 --D1=1073741824,16,64 --LL=1073741824,16,64 --callgrind-out-file=" +
                        quoted((folder.path / "out").string()) + " " + quoted(probe) + " " + quoted(scene);
  for (const std::string& pair : pairs) command += " " + quoted(pair);
  command += " 2>" + quoted((folder.path / "errors").string());
  std::string said;
  int code = -1;
  if (std::FILE* pipe = popen(command.c_str(), "r")) {
    char buffer[256];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) said.append(buffer, n);
    code = pclose(pipe);
  }
  if (code != 0) {
    std::ostringstream why;
    why << std::ifstream(folder.path / "errors").rdbuf();
    throw ModelError(probe, "phase_probe", "could not be run under valgrind: " + why.str().substr(0, 300), how);
  }
  if (kernels != nullptr) *kernels = said.substr(0, said.find('\n'));
  std::vector<ProbeCount> counts;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path)) {
    const auto [reason, totals] = read_dump(entry.path());
    const std::size_t slash = reason.find('/');
    if (slash == std::string::npos) continue;
    counts.push_back({reason.substr(0, slash), reason.substr(slash + 1), totals.at("Ir"), totals.at("D1mr") + totals.at("D1mw")});
  }
  if (counts.size() != pairs.size()) throw ModelError(probe, "phase_probe", "counted " + std::to_string(counts.size()) + " of " + std::to_string(pairs.size()) + " uses", how);
  return counts;
}

std::string count_cache_lines(const std::string& probe, TableRow& row) {
  std::vector<std::string> pairs;
  for (const Entry& e : row.entries)
    for (const Use u : {Use::first_apply, Use::first_solve})
      if (e.has(u)) pairs.push_back(e.op + "/" + name(u));
  std::string kernels;
  for (const ProbeCount& c : run_probe(probe, row.scene, pairs, &kernels))
    for (Entry& e : row.entries)
      for (std::size_t u = 0; u < use_count; ++u)
        if (e.op == c.op && name(use(u)) == c.use) e.lines[u] = c.lines;
  return kernels;
}

}  // namespace delassus::bench
