// The program `delassus`: exit codes 0 ok, 1 a law is broken or a numerical outcome is not ok, 2 bad input or usage,
// 3 slower than the baseline.
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <new>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "algorithms/status.h"
#include "cli/commands.h"
#include "property_tests/allocations.h"

namespace {

int fail(const std::string& message, int code) {
  std::fprintf(stderr, "delassus: %s\n", message.c_str());
  return code;
}

/// Lets an allocation beyond the machine's memory fail instead of filling it: an explicit operator on a long swimmer
/// asks for terabytes. Not under the address sanitizer, whose own mappings are larger.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__)
  const auto bytes = static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(sysconf(_SC_PAGE_SIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && (limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur > bytes)) {
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_AS, &limit);
  }
#endif
}

/// Whether the first argument is meant as a subcommand but is none.
bool unknown_subcommand(const CLI::App& app, const std::string& first) {
  const auto known = app.get_subcommands([&](const CLI::App* c) { return c->get_name() == first; });
  return !first.empty() && first[0] != '-' && known.empty();
}

std::string subcommand_names(const CLI::App& app) {
  std::string names;
  for (const CLI::App* c : app.get_subcommands([](const CLI::App*) { return true; }))
    names += (names.empty() ? "" : ", ") + c->get_name();
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace delassus::cli;
  CLI::App app{"Matrix-free Delassus operators of articulated rigid bodies: A = J M⁻¹ Jᵀ + R⁻¹."};
  app.require_subcommand(1);
  app.footer("Exit codes: 0 ok, 1 a law is broken (or a solve did not end well), 2 bad input or usage, "
             "3 slower than the baseline.");
  limit_memory();
  delassus::laws::count_allocations();
  Run run;
  for (auto* add : {add_list, add_describe, add_check, add_apply, add_export, add_bench, add_accuracy, add_report, add_stress, add_survey, add_replay}) add(app, run);
  if (argc > 1 && unknown_subcommand(app, argv[1]))
    return fail("there is no subcommand " + std::string(argv[1]) + " (accepted: " + subcommand_names(app) + ")", bad_input);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help
  } catch (const CLI::ParseError& e) {
    return fail(std::string(e.what()) + "\nRun with --help for what is accepted.", bad_input);
  }
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
