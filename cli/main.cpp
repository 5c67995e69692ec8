// The program `delassus`: exit codes 0 ok, 1 a law is broken or a numerical outcome is not ok, 2 bad input or usage,
// 3 slower than the baseline, 130 ended by Ctrl-C with nothing broken so far.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <new>
#include <stdexcept>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"
#include "cli/commands.h"
#include "property_tests/unit/allocations.h"
#include "cli/program/options.h"

namespace {

int fail(const std::string& message, int code) {
  std::fprintf(stderr, "delassus: %s\n", message.c_str());
  return code;
}

/// What the machine has left, or what it has where that is not told [B].
rlim_t memory() {
  std::ifstream told("/proc/meminfo");
  for (std::string line; std::getline(told, line);) {
    unsigned long long kilobytes = 0;
    if (std::sscanf(line.c_str(), "MemAvailable: %llu kB", &kilobytes) == 1) return kilobytes << 10;
  }
  return static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(sysconf(_SC_PAGE_SIZE));
}

/// Lets an allocation beyond the memory that is left fail instead of filling it: an explicit operator on a long swimmer
/// asks for terabytes. Not under the address sanitizer, whose own mappings are larger.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__)
  const rlim_t bytes = memory();
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && (limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur > bytes)) {
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_AS, &limit);
  }
#endif
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace delassus::cli;
  namespace options = delassus::options;
  options::Command app{"Matrix-free Delassus operators of articulated rigid bodies: A = J M⁻¹ Jᵀ + R⁻¹."};
  app.require_subcommand();
  app.footer("Exit codes: 0 ok, 1 a law is broken (or a solve did not end well), 2 bad input or usage, "
             "3 slower than the baseline, 130 ended by Ctrl-C (what was computed is printed).");
  limit_memory();
  delassus::laws::count_allocations();
  Run run;
  for (auto* add : {add_list, add_describe, add_check, add_apply, add_dynamics, add_export, add_bench, add_accuracy, add_report, add_simulate, add_stress, add_survey, add_replay}) add(app, run);
  const std::vector<std::string> known = app.subcommands();
  if (argc > 1 && argv[1][0] != '-' && std::find(known.begin(), known.end(), argv[1]) == known.end())
    return fail("there is no subcommand " + delassus::in_quotes(argv[1]) + " (accepted: " + delassus::did_you_mean(argv[1], known) + listed(known) + "; --help says what each does)", bad_input);
  std::string error;
  if (const std::optional<int> exit = app.parse(argc, argv, error)) return *exit == 0 ? good : fail(error, bad_input);
  try {
    return run();
  } catch (const delassus::ModelError& e) {
    return fail(e.what(), bad_input);
  } catch (const std::bad_alloc&) {
    return fail("this needs more memory than the machine has (explicit operators need rows² numbers)", bad_input);
  } catch (const std::exception& e) {
    return fail(std::string("internal error: ") + e.what() + "\nPlease report it with the command line.", bad_input);
  }
}
