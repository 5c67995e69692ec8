// `delassus report --out DIR`: the main job.
#include <cstdio>

#include "bench/report.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "property_tests/options.h"

namespace delassus::cli {

namespace {

int report(const bench::ReportOptions& options, const std::string& directory) {
  bench::Results results = bench::run_report(options, [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  });
  bench::write_report(results, directory);
  std::printf("\n%s\n%d law checks, %d failed; %.0f s\n%s\n", bench::text_table(results).c_str(), results.checked(),
              results.failed(), results.seconds, (std::filesystem::path(directory) / "index.html").c_str());
  return results.failed() ? 1 : 0;
}

}  // namespace

void add_report(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("report", "check and time every operator on every scene; write a page and the numbers");
  auto options = std::make_shared<bench::ReportOptions>();
  auto directory = std::make_shared<std::string>();
  c->add_option("--out", *directory, "directory for index.html and results.json")->required();
  c->add_option("--scene", options->scenes, "only these scenes (repeat, or several names)");
  c->add_flag("--quick", options->quick, "shorter timings, swimmers to 1000 links, large scenes timed but not checked");
  c->add_flag("!--no-check", options->check, "time only");
  c->add_flag("!--no-ladder", options->ladder, "leave out the swimmers of growing length");
  add_scene_options(*c, options->opening);
  c->footer("Exit code 1 when a law is broken.");
  c->callback([=, &run] { run = [=] { return report(*options, *directory); }; });
}

}  // namespace delassus::cli
