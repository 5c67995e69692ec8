// `delassus survey DIR`: which robots of a folder load, which with warnings, which not and why; M, J and J M⁻¹ Jᵀ of each
// against an independent reading.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "bench/text.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/survey_file.h"
#include "cli/program/isolated.h"
#include "cli/program/options.h"
#include "property_tests/laws/verdict.h"

namespace delassus::cli {

namespace {

namespace fs = std::filesystem;

struct SurveyCommand {
  std::string folder;
  SurveyOptions file;
  double limit = 60;
  bool as_json = false, all = false;
};


std::vector<std::string> files_under(const std::string& folder) {
  std::error_code error;
  if (fs::is_regular_file(folder, error)) return {folder};
  if (!fs::is_directory(folder, error)) throw ModelError("", "survey", "'" + folder + "' is no folder", "a folder with robots (.urdf, .sdf, MJCF .xml), or one such file; check the path");
  std::vector<std::string> out;
  for (auto it = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error); it != fs::end(it); it.increment(error)) {
    if (error) break;
    if (it->is_regular_file(error) && is_robot_file(it->path().string())) out.push_back(it->path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// One file in a process of its own: whatever happens there is that file's finding.
json survey_one(const std::string& file, const SurveyCommand& o) {
  json urdfdom = nullptr;
  if (fs::path(file).extension() == ".urdf" || fs::path(file).extension() == ".URDF") {
    const Outcome asked = isolated([&](const Progress&) { return urdfdom_says(file).dump(-1, ' ', false, json::error_handler_t::replace); }, o.limit);
    urdfdom = asked.end == Outcome::End::returned ? json::parse(asked.result, nullptr, false) : json("urdfdom: " + describe(asked));
  }
  const Outcome outcome = isolated([&](const Progress&) { return survey_file(file, urdfdom, o.file).dump(-1, ' ', false, json::error_handler_t::replace); }, o.limit);
  json j = outcome.end == Outcome::End::returned ? json::parse(outcome.result, nullptr, false) : json();
  if (j.is_object()) return j;
  return {{"file", file}, {"state", "failed"}, {"urdfdom", urdfdom}, {"differs", describe(outcome)}, {"said", outcome.said}};
}

bool has_warnings(const json& j) { return j["state"] == "loads" && !j["warnings"].empty(); }

double largest_ratio(const json& j) {
  double largest = 0;
  for (const auto& [name, r] : j["ratios"].items()) largest = std::max(largest, r.is_number() ? r.get<double>() : HUGE_VAL);
  return largest;
}

/// A kind of refusal or warning: in how many files, how often, where first.
struct Kind {
  int files = 0, times = 0;
  std::string first;
  void add(const std::string& file, int count = 1) {
    if (files++ == 0) first = file;
    times += count;
  }
};

struct Totals {
  int files = 0, loads = 0, warned = 0, refused = 0, failed = 0;   ///< loads without warning, with; failed: crash or time limit
  int articulated = 0, fixed_only = 0, differ = 0;
  int right = 0, look = 0;              ///< refusals that are right, that need a look
  int readable = 0, readable_load = 0;  ///< articulated, read by urdfdom, M regular by the witness; and of these loaded
  std::map<std::string, double> worst;
  std::map<std::string, Kind> warnings, refusals, right_because;

  void add(const json& j) {
    ++files;
    const std::string file = j["file"];
    const bool loaded = j["state"] == "loads";
    if (loaded) (has_warnings(j) ? warned : loads)++;
    if (j["state"] == "refused") ++refused, refusals[j["kind"]].add(file), j["right"].is_null() ? ++look : ++right;
    if (j["state"] == "refused" && !j["right"].is_null()) right_because[j["right"]].add(file);
    if (j["state"] == "failed") ++failed;
    differ += j.contains("differs");
    fixed_only += j.contains("free_base");
    const bool moving = j.contains("moving") ? j["moving"].get<int>() > 0 : loaded && j["dof"].get<int>() > 6;
    articulated += moving;
    if (moving && j.contains("regular") && !j["urdfdom"].is_string() && (j["regular"]["free"].get<bool>() || j["regular"]["fixed"].get<bool>()))
      ++readable, readable_load += loaded;
    if (!loaded) return;
    std::map<std::string, int> here;
    for (const json& w : j["warnings"]) ++here[w["kind"]];
    for (const auto& [kind, count] : here) warnings[kind].add(file, count);
    if (!j.contains("ratios")) return;
    for (const auto& [name, r] : j["ratios"].items()) worst[name] = std::max(worst[name], r.is_number() ? r.get<double>() : HUGE_VAL);
  }
};

json kinds_json(const std::map<std::string, Kind>& kinds) {
  json out = json::array();
  for (const auto& [kind, k] : kinds) out.push_back({{"kind", kind}, {"files", k.files}, {"times", k.times}, {"first", k.first}});
  return out;
}

json totals_json(const Totals& t) {
  json worst = json::object();
  for (const auto& [name, r] : t.worst) worst[name] = std::isfinite(r) ? json(r) : json("infinity");
  return {{"files", t.files}, {"articulated", t.articulated}, {"loads", t.loads}, {"loads_with_warnings", t.warned}, {"refused", t.refused},
          {"refused_rightly", t.right}, {"refused_needs_a_look", t.look}, {"failed", t.failed}, {"differ", t.differ},
          {"fixed_base_only", t.fixed_only}, {"readable", t.readable}, {"readable_load", t.readable_load}, {"worst_ratios", worst},
          {"warnings", kinds_json(t.warnings)}, {"refusals", kinds_json(t.refusals)}};
}

void print_kinds(const char* title, const std::map<std::string, Kind>& kinds) {
  if (kinds.empty()) return;
  std::vector<std::pair<std::string, Kind>> sorted(kinds.begin(), kinds.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second.files > b.second.files; });
  std::printf("\n%s\n files  times  kind (first file)\n", title);
  for (const auto& [kind, k] : sorted) std::printf("%6d %6d  %s (%s)\n", k.files, k.times, kind.c_str(), k.first.c_str());
}

std::string row(const json& j) {
  if (j["state"] == "failed") return "FAILED    " + j["file"].get<std::string>() + ": " + j["differs"].get<std::string>();
  if (j["state"] == "refused")
    return "refused   " + j["why"].get<std::string>() + (j["right"].is_null() ? "" : " [right: " + j["right"].get<std::string>() + "]");
  std::string text = bench::format("%s %s: %lld bodies, %lld freedoms, %s base", has_warnings(j) ? "warnings " : "loads    ", j["file"].get<std::string>().c_str(),
                                   static_cast<long long>(j["bodies"].get<Index>()), static_cast<long long>(j["dof"].get<Index>()), j["base"].get<std::string>().c_str());
  if (j.contains("ratios")) text += ", worst ratio " + bench::ratio_text(largest_ratio(j));
  if (j.contains("differs")) text += ", DIFFERS: " + j["differs"].get<std::string>();
  if (has_warnings(j)) text += bench::format("; %zu warnings", j["warnings"].size());
  return text;
}

void print_rows(const json& all, bool every) {
  const auto group = [&](const char* title, const auto& in) {
    bool any = false;
    for (const json& j : all)
      if (in(j)) {
        if (!any) std::printf("\n%s\n", title);
        any = true;
        std::printf("  %s\n", row(j).c_str());
      }
  };
  if (every) group("loads", [](const json& j) { return j["state"] == "loads" && !has_warnings(j) && !j.contains("differs"); });
  if (every) group("loads with warnings", [](const json& j) { return has_warnings(j) && !j.contains("differs"); });
  group("refused, rightly", [](const json& j) { return j["state"] == "refused" && !j["right"].is_null(); });
  group("refused, needs a look", [](const json& j) { return j["state"] == "refused" && j["right"].is_null(); });
  group("differs from the independent reading, or failed", [](const json& j) { return j.contains("differs"); });
}

void print_totals(const Totals& t, bool compared) {
  if (compared) std::printf("\nlargest ratios (below %g passes):", laws::pass_below);
  for (const auto& [name, r] : t.worst)
    if (compared) std::printf("  %s %s", name.c_str(), bench::ratio_text(r).c_str());
  std::printf("\n%d files, %d with moving joints: %d load, %d load with warnings, %d refused (%d rightly, %d need a look), %d failed, %d differ\n", t.files,
              t.articulated, t.loads, t.warned, t.refused, t.right, t.look, t.failed, t.differ);
  if (t.fixed_only > 0) std::printf("%d load on a fixed base only\n", t.fixed_only);
  if (t.readable > 0)
    std::printf("with moving joints, read by urdfdom, M regular: %d of %d load (%.1f %%)\n", t.readable_load, t.readable, 100.0 * t.readable_load / t.readable);
}

int survey(const SurveyCommand& o) {
  const std::vector<std::string> files = files_under(o.folder);
  if (files.empty()) throw ModelError("", "survey", "'" + o.folder + "' holds no robot", "files .urdf, .sdf or MJCF .xml in it or below; expand .xacro files first");
  std::fprintf(stderr, "%zu files\n", files.size());
  keep_on_interrupt();
  json all = json::array();
  Totals totals;
  for (const std::string& file : files) {
    json j = survey_one(file, o);
    if (interrupted()) break;
    std::fprintf(stderr, "\r%zu of %zu", all.size() + 1, files.size());
    totals.add(j);
    all.push_back(std::move(j));
  }
  std::fprintf(stderr, "\n");
  if (interrupted()) std::fprintf(stderr, "stopped: what follows is about the first %zu files\n", all.size());
  if (o.as_json) std::printf("%s\n", json({{"files", all}, {"totals", totals_json(totals)}, {"stopped", interrupted()}}).dump(1, ' ', false, json::error_handler_t::replace).c_str());
  else {
    print_rows(all, o.all);
    print_kinds("warnings by kind", totals.warnings);
    print_kinds("refusals by kind", totals.refusals);
    print_totals(totals, o.file.poses > 0);
  }
  return end_of_run(totals.differ > 0 ? law_broken : good, "files are left");
}

}  // namespace

void add_survey(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("survey", "robots of a folder: which load, with which warnings, which not and why; M, J, J M⁻¹ Jᵀ against a second reading");
  auto o = std::make_shared<SurveyCommand>();
  c->add_option("folder", o->folder, "searched for .urdf, .sdf and MJCF .xml, with all below it; or one file")->required();
  c->add_option("--base", o->file.base, "auto: free, or fixed where M is regular only then")->check(options::one_of({"auto", "free", "fixed"}))->capture_default_str();
  c->add_option("--armature", o->file.armature, "of joints that are given none [kg m² or kg]")->check(options::at_least(0, "kg m² or kg"));
  c->add_option("--poses", o->file.poses, "random configurations at which matrices are compared")->check(options::whole(0))->capture_default_str();
  c->add_option("--limit", o->limit, "time for one file [s]")->check(options::above(0, "s"))->capture_default_str();
  c->add_flag("--strict", o->file.strict, "warnings are errors");
  c->add_flag("--all", o->all, "a row for files that load, too");
  c->add_flag("--json", o->as_json, "{files, totals}");
  c->footer("Every file is read in a process of its own, so that none ends the run; Ctrl-C keeps what there is.\n"
            "Exit code 1 when a model differs from the second reading, or a file ends or hangs the process.");
  c->callback([=, &run] { run = [=] { return survey(*o); }; });
}

}  // namespace delassus::cli
