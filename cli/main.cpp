// The program `delassus`: exit codes 0 ok, 1 a law is broken or a numerical outcome is not ok, 2 bad input or usage,
// 3 slower than the baseline.
#include <cstdio>
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

}  // namespace

int main(int argc, char** argv) {
  using namespace delassus::cli;
  CLI::App app{"Matrix-free Delassus operators of articulated rigid bodies: A = J M⁻¹ Jᵀ + R⁻¹."};
  app.require_subcommand(1);
  app.footer("Exit codes: 0 ok, 1 a law is broken (or a solve did not end well), 2 bad input or usage, "
             "3 slower than the baseline.");
  delassus::laws::count_allocations();
  Run run;
  for (auto* add : {add_list, add_describe, add_check, add_apply, add_export, add_bench, add_report}) add(app, run);
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
  } catch (const std::exception& e) {
    return fail(std::string("internal error: ") + e.what() + "\nPlease report it with the command line.", bad_input);
  }
}
