// `delassus replay`: a failure found by `stress`, or any spec, built again and held against the laws.
#include <algorithm>
#include <cstdio>

#include "bench/text.h"
#include "cli/commands.h"
#include "cli/stress_json.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct ReplayOptions {
  std::string file, law, defect;
  std::vector<std::string> ops;
  bool all = false, as_json = false;
};

/// What a file asks for: a spec, and the law and operator that were broken when it is a failure.
struct Asked {
  generators::Spec spec;
  std::string law, op;
};

Asked read(const std::string& file) {
  const std::string content = read_text(file);
  const json j = json::parse(content, nullptr, false);
  if (!j.is_object() || !j.contains("spec")) return {generators::from_json(content, file), {}, {}};
  const laws::Failure f = read_failure(j, file);
  return {f.spec, f.law, f.op};
}

json outcome_json(const laws::Outcome& o) {
  if (o.skipped) return {{"law", o.law}, {"operator", o.op}, {"skipped", o.skipped}};
  return {{"law", o.law}, {"operator", o.op}, {"ratio", std::isfinite(o.verdict.ratio) ? json(o.verdict.ratio) : json("infinity")},
          {"bound", o.verdict.bound}, {"note", o.verdict.note}, {"holds", o.passed()}};
}

void print(const laws::Outcome& o, std::size_t width) {
  const std::string what = bench::pad_right(std::string(o.op), width) + "  " + bench::pad_right(std::string(o.law), 36);
  if (o.skipped) std::printf("- %s not checked: %s\n", what.c_str(), o.skipped);
  else
    std::printf("%s %s %8s  %s\n", o.failed() ? "✗" : "✓", what.c_str(), bench::three_digits(o.verdict.ratio).c_str(),
                o.verdict.note.c_str());
}

int replay(const ReplayOptions& o) {
  const Asked asked = read(o.file);
  const std::string law = o.all ? std::string() : o.law.empty() ? asked.law : o.law;
  std::vector<std::string> ops = o.ops;
  if (ops.empty() && !o.all && !asked.op.empty() && o.defect.empty()) ops.push_back(asked.op);
  if (!law.empty()) static_cast<void>(laws::find_law(law));  // throws, listing the names
  const laws::Case c = laws::make_case(asked.spec);
  int failed = 0, checked = 0;
  json out = json::array();
  const std::vector<const OperatorRow*> chosen = chosen_operators(ops, o.defect);
  std::size_t width = 0;
  for (const OperatorRow* op : chosen) width = std::max(width, op->name.size());
  for (const OperatorRow* op : chosen)
    for (const laws::LawRow& row : laws::laws()) {
      if (!law.empty() && row.name != law) continue;
      const laws::Outcome x = laws::check(row, *op, c);
      failed += x.failed() ? 1 : 0;
      checked += x.skipped ? 0 : 1;
      out.push_back(outcome_json(x));
      if (!o.as_json) print(x, width);
    }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  else std::printf("%s: %d checked, %d failed\n", c.label.c_str(), checked, failed);
  return failed ? law_broken : good;
}

}  // namespace

void add_replay(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("replay", "build a failure found by `stress`, or any spec, again and check it");
  auto o = std::make_shared<ReplayOptions>();
  c->add_option("FILE", o->file, "a failure written by `stress`, or a spec as JSON")->required();
  c->add_option("--law", o->law, "this law instead of the one that failed");
  c->add_option("--op", o->ops, "these operators instead of the one that failed");
  c->add_option("--defect", o->defect, "a wrong operator (see `delassus list defects`)");
  c->add_flag("--all", o->all, "every law");
  c->add_flag("--json", o->as_json, "an array of {law, operator, ratio, bound, note, holds} or {law, operator, skipped}");
  c->footer("A failure: its law on its operator. A spec: every law on every operator. Exit code 1 when a law is broken.");
  c->callback([=, &run] { run = [=] { return replay(*o); }; });
}

}  // namespace delassus::cli
