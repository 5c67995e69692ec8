// `delassus report --out DIR`: the main job.
#include <cstdio>

#include "bench/report.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/interrupt.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct ReportCommand {
  std::string directory, defect;
  std::vector<std::string> ops;
};

int report(bench::ReportOptions options, const ReportCommand& o) {
  if (!o.ops.empty() || !o.defect.empty()) options.ops = chosen_operators(o.ops, o.defect);
  bench::check_writable(o.directory);
  keep_on_interrupt();
  options.stop = interrupted;
  const bench::Results results = bench::run_report(options, [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  });
  bench::write_report(results, o.directory);
  const std::string left = results.left_out() == 0 ? "" : bench::format(", %d left out (`delassus check SCENE --op NAME` checks them)", results.left_out());
  std::printf("\n%s\n%d law checks, %d failed%s; %.0f s\n%s\n", bench::text_table(results).c_str(), results.checked(),
              results.failed(), left.c_str(), results.seconds, (std::filesystem::path(o.directory) / "index.html").c_str());
  return end_of_run(bench::exit_code(results), "the page holds what was done until then");
}

}  // namespace

void add_report(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("report", "check and time every operator on every scene; write a page and the numbers");
  auto options = std::make_shared<bench::ReportOptions>();
  auto o = std::make_shared<ReportCommand>();
  c->add_option("--out", o->directory, "directory for index.html and results.json")->required();
  c->add_option("--scene", options->scenes, "only these scenes, without swimmers of growing length and families (repeat, or several names)");
  c->add_option("--op", o->ops, "only these operators, without swimmers of growing length (repeat, or several names)");
  c->add_option("--defect", o->defect, "a wrong operator (see `delassus list defects`), likewise");
  c->add_flag("--quick", options->quick, "shorter timings, swimmers to 1000 links, 5 s per scene instead of 60 for laws but those against the definitions");
  c->add_flag("!--no-check", options->check, "time only");
  c->add_flag("!--no-swimmers,!--no-ladder", options->ladder, "leave out the swimmers of growing length");
  add_scene_options(*c, options->opening);
  c->footer("First every operator is held against the definitions and the default against every law, then law by law; what time leaves out is "
            "said. Ctrl-C writes the page of what was done. Exit code 1 when a law is broken.");
  c->callback([=, &run] { run = [=] { return report(*options, *o); }; });
}

}  // namespace delassus::cli
