// `delassus check`: the laws against the references; the worst ratio per law.
#include <cstdio>
#include <map>

#include "bench/text.h"
#include "cli/check_digits.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/interrupt.h"
#include "property_tests/defects/defects.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct CheckOptions {
  std::string scene, family;
  std::vector<std::string> ops;
  std::string defect;
  Index n = 0;
  std::uint64_t seed = 1;
  bool as_json = false, digits = false, all = false;
  std::optional<double> damping;
  std::string picture;
  SceneOptions opening;
};

/// The cases the options ask for: a scene; one family; or every family at the middle of its sizes.
std::vector<laws::Case> cases(const CheckOptions& o, json& warnings) {
  if (!o.scene.empty()) {
    const Scene scene = open(o.scene, o.opening);
    warnings = warnings_json(scene);
    return {laws::make_case(problem_of(scene), scene.damping, scene.name, o.seed)};
  }
  std::vector<laws::Case> out;
  for (const generators::FamilyRow& f : generators::families()) {
    if (!o.family.empty() && o.family != f.name) continue;
    out.push_back(laws::make_case(f.name, o.n > 0 ? o.n : f.sizes[f.sizes.size() / 2], o.seed));
  }
  if (out.empty()) static_cast<void>(generators::find_family(o.family));  // throws, listing the names
  return out;
}

/// Worst outcome of one law over the cases.
struct Line {
  int checked = 0, failed = 0, skipped = 0;
  double ratio = -1;
  std::string bound, label, note, why_skipped;

  void add(const laws::Outcome& o) {
    if (o.skipped) {
      ++skipped;
      why_skipped = o.skipped;
      return;
    }
    ++checked;
    failed += o.failed();
    if (o.verdict.ratio <= ratio) return;
    ratio = o.verdict.ratio;
    bound = o.verdict.bound;
    label = o.label;
    note = o.verdict.note;
  }
};

json line_json(std::string_view law, const Line& l) {
  json j = {{"law", law}, {"checked", l.checked}, {"failed", l.failed}, {"skipped", l.skipped}};
  if (l.checked)
    j.update({{"worst_ratio", std::isfinite(l.ratio) ? json(l.ratio) : json("infinity")}, {"bound", l.bound}, {"case", l.label}});
  if (!l.note.empty()) j["note"] = l.note;
  if (l.skipped) j["why_skipped"] = l.why_skipped;
  return j;
}

void print_line(std::string_view law, const Line& l) {
  const std::string name = bench::pad_right(std::string(law), 34);
  if (!l.checked) {
    std::printf("  - %s not checked: %s\n", name.c_str(), l.why_skipped.c_str());
    return;
  }
  std::printf("  %s %s %8s  %3d checked%s  %s%s%s\n", l.failed ? "✗" : "✓", name.c_str(), bench::three_digits(l.ratio).c_str(),
              l.checked, l.skipped ? bench::format(", %d skipped", l.skipped).c_str() : "", l.label.c_str(),
              l.note.empty() ? "" : ": ", l.note.c_str());
}

/// One line per operator: laws held, broken, not applicable, the worst ratio and where; what is broken follows.
void print_summary(std::string_view op, const std::vector<std::pair<std::string_view, Line>>& laws) {
  int checked = 0, failed = 0, rest = 0;
  const std::pair<std::string_view, Line>* worst = nullptr;
  for (const auto& law : laws) {
    checked += law.second.checked > 0;
    failed += law.second.failed > 0;
    rest += law.second.checked == 0;
    if (law.second.checked && (!worst || !(law.second.ratio <= worst->second.ratio))) worst = &law;
  }
  std::printf("%s %5d %7d %12d", bench::pad_right(std::string(op), 24).c_str(), checked, failed, rest);
  if (worst) std::printf("  %8s  %s (%s)", bench::three_digits(worst->second.ratio).c_str(), std::string(worst->first).c_str(), worst->second.label.c_str());
  std::printf("\n");
  for (const auto& [law, line] : laws)
    if (line.failed) print_line(law, line);
  std::fflush(stdout);
}

/// What is about to be checked, so that large problems are seen to be under way.
void print_cases(const std::vector<laws::Case>& all) {
  if (all.size() == 1) {
    const Structure& s = *all[0].problem.structure;
    std::printf("%s: %lld bodies, %lld freedoms, %lld rows\n", all[0].label.c_str(), static_cast<long long>(s.bodies()),
                static_cast<long long>(s.dofs()), static_cast<long long>(s.rows));
  } else {
    std::printf("%zu cases\n", all.size());
  }
  std::fflush(stdout);
}

int check(const CheckOptions& o) {
  if (!o.family.empty() && !o.scene.empty())
    throw ModelError("", "check", "both --family and --scene are given", "one of them, or none; without either every family is checked");
  const auto ops = chosen_operators(o.ops, o.defect);
  const std::string_view left_out = o.defect.empty() ? "" : laws::left_out(laws::find_defect(o.defect));
  json warnings;
  const std::vector<laws::Case> all = cases(o, warnings);
  int failed = 0, checked = 0;
  json out = json::array();
  if (!o.as_json) print_cases(all);
  if (!o.as_json && !o.all) std::printf("%s  laws  failed  not checked     worst  where (--all: every law)\n", bench::pad_right("operator", 23).c_str());
  keep_on_interrupt();
  for (const OperatorRow* op : ops) {
    json rows = json::array();
    std::vector<std::pair<std::string_view, Line>> lines;
    if (!o.as_json && o.all) std::printf("%s\n", std::string(op->name).c_str());
    for (const laws::LawRow& law : laws::laws()) {
      if (interrupted()) break;
      Line line;
      if (law.name == left_out) line.why_skipped = "its right operator breaks it too";
      else
        for (const laws::Case& c : all)
          if (!interrupted()) line.add(laws::check(law, *op, c));
      if (line.checked + line.skipped == 0 && line.why_skipped.empty()) break;  // Ctrl-C before the first case
      failed += line.failed;
      checked += line.checked;
      if (o.as_json) rows.push_back(line_json(law.name, line));
      else if (o.all) print_line(law.name, line), std::fflush(stdout);
      lines.emplace_back(law.name, std::move(line));
    }
    if (lines.empty()) break;
    if (!o.as_json && !o.all) print_summary(op->name, lines);
    out.push_back({{"name", op->name}, {"laws", rows}});
    if (!warnings.is_null()) out.back()["warnings"] = warnings;
  }
  if (o.as_json) std::printf("%s\n", out.dump(1).c_str());
  else std::printf("%zu cases, %d failed of %d checks; a law holds below ratio %g\n", all.size(), failed, checked, laws::pass_below);
  return end_of_run(failed ? law_broken : good, "the operators and laws that follow were not checked");
}

int digits_of(const CheckOptions& o) {
  if (o.ops.size() > 1) throw ModelError("", "--op", "is given more than once with --digits", "one of aba_sweep, lcaba; run it twice for both");
  return check_digits({o.scene, o.family, o.n, o.seed, o.damping, o.ops.empty() ? "lcaba" : o.ops.front(), o.picture, o.as_json, o.opening});
}

}  // namespace

void add_check(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("check", "hold the laws against the references; worst error ratio per law");
  auto o = std::make_shared<CheckOptions>();
  c->add_option("--op", o->ops, "only these operators");
  c->add_option("--defect", o->defect, "a wrong operator (see `delassus list defects`)");
  c->add_option("--family", o->family, "one family of random problems (see `delassus list families`)");
  c->add_option("scene,--scene", o->scene, "a scene instead of families");
  c->add_option("--n", o->n, "size, about the number of bodies; when left out, the middle size of the family")->check(options::whole(1));
  c->add_option("--seed", o->seed, "of the problem and its vectors")->check(options::whole(0))->capture_default_str();
  c->add_flag("--all", o->all, "a line for every law, also of those that were not checked and why, instead of one per operator");
  c->add_flag("--json", o->as_json, "an array of {name, laws, of scenes also warnings}; with --digits an object");
  auto* digits = c->add_flag("--digits", o->digits, "instead: digits lost by every link, by random rounding (docs/digits.md); --op lcaba or aba_sweep");
  c->add_option("--damping", o->damping, "with --digits: R⁻¹ of every row [1/kg]")->check(options::at_least(0, "1/kg"))->needs(digits);
  c->add_option("--picture", o->picture, "with --digits: SVG of the scene, or of digits against link for a family")->needs(digits);
  add_scene_options(*c, o->opening);
  c->footer("Without --family and --scene: every family. Ctrl-C keeps what was checked. Exit code 1 when a law is broken.");
  c->callback([=, &run] { run = [=] { return o->digits ? digits_of(*o) : check(*o); }; });
}

}  // namespace delassus::cli
