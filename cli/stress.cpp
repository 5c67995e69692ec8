// `delassus stress`: a randomised search for broken laws, alone or in shards under a launcher; reports merged.
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "bench/text.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/stress_json.h"
#include "generators/classes.h"
#include "property_tests/defects/defects.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct StressOptions {
  std::string time = "60s", shard, report, folder = ".", defect;
  std::optional<std::uint64_t> seed;
  std::int64_t count = 0;
  std::size_t failures = 1;
  std::vector<std::string> ops, merge;
  bool as_json = false;
};

struct Shard {
  int number = 1, of = 1;
  std::string from;   ///< what said so; empty: nothing
};

/// A whole non-negative number, or −1.
int whole(const std::string& text) {
  int n = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error == std::errc() && end == text.data() + text.size() && n >= 0 ? n : -1;
}

int variable(const char* name) {
  const char* value = name ? std::getenv(name) : nullptr;
  return value ? whole(value) : -1;
}

/// Launchers by the variables they set: rank, number of ranks, first rank (nullptr: 0).
constexpr struct {
  const char *rank, *size, *first;
} launchers[] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", nullptr},
                 {"PMI_RANK", "PMI_SIZE", nullptr},
                 {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN"},
                 {"SLURM_PROCID", "SLURM_NTASKS", nullptr}};

/// --shard, or the first launcher that is there.
Shard shard_of(const std::string& text) {
  if (!text.empty()) {
    const std::size_t slash = text.find('/');
    const int i = whole(text.substr(0, slash)), n = slash == std::string::npos ? -1 : whole(text.substr(slash + 1));
    if (i < 1 || i > n) throw ModelError("", "--shard", "is '" + text + "'", "i/n with 1 ≤ i ≤ n; 1/4 is the first of four");
    return {i, n, "--shard"};
  }
  for (const auto& launcher : launchers) {
    const int rank = variable(launcher.rank), size = variable(launcher.size);
    const int first = launcher.first ? std::max(0, variable(launcher.first)) : 0;
    if (rank >= first && size > rank - first) return {rank - first + 1, size, launcher.rank};
  }
  return {};
}

std::uint64_t fresh_seed() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 16) ^ device();
}

laws::Search search_of(const StressOptions& o) {
  laws::Search s;
  const Shard shard = shard_of(o.shard);
  if (shard.of > 1 && !o.seed)
    throw ModelError("", "--seed", "is missing for shard " + std::to_string(shard.number) + "/" +
                     std::to_string(shard.of) + " (" + shard.from + ")", "one seed for all shards; give --seed with the same number to each");
  s.seed = o.seed ? *o.seed : fresh_seed();
  s.shard = shard.number;
  s.shards = shard.of;
  s.seconds = options::seconds_of(o.time);
  s.count = o.count;
  s.most_failures = o.failures;
  s.ops.clear();
  for (const OperatorRow* row : chosen_operators(o.ops, o.defect)) s.ops.push_back(*row);
  if (!o.defect.empty()) s.left_out = laws::left_out(laws::find_defect(o.defect));
  return s;
}

void print_progress(const laws::Found& f) {
  std::printf("%7.1f s  %9lld problems  %7.1f per second  %11lld checks  %zu failures\n", f.seconds,
              static_cast<long long>(f.problems), static_cast<double>(f.problems) / f.seconds,
              static_cast<long long>(f.checks), f.failures.size());
  std::fflush(stdout);
}

void print_classes(const laws::Found& f) {
  for (std::size_t k = 0; k < f.classes.size(); ++k)
    std::printf("  %s %9lld  %5.1f %%\n", bench::pad_right(std::string(generators::classes()[k].name), 24).c_str(),
                static_cast<long long>(f.classes[k]),
                f.problems ? 100 * static_cast<double>(f.classes[k]) / static_cast<double>(f.problems) : 0.0);
}

/// "failure-SEED-operator-law.json" with everything but letters and digits of ASCII as "_".
std::string file_name(const laws::Failure& f) {
  std::string name = f.op + "-" + f.law;
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-')) c = '_';
  return "failure-" + std::to_string(f.seed) + "-" + name + ".json";
}

void print_failure(const laws::Failure& f) {
  std::printf("FAILED  %s: %s, ratio %s %s\n  seed %llu, %zu bodies, shrunk to %zu bodies and %zu constraints in %d steps\n",
              f.op.c_str(), f.law.c_str(), bench::three_digits(f.ratio).c_str(), f.note.c_str(),
              static_cast<unsigned long long>(f.seed), f.found_bodies, f.spec.bodies.size(),
              f.spec.links.size() + f.spec.joints.size(), f.tried);
}

/// Where a failure is written.
std::string path_of(const laws::Failure& f, const StressOptions& o) { return (std::filesystem::path(o.folder) / file_name(f)).string(); }

/// The report of the shard, with the file of every failure.
void print_json(const laws::Found& f, const StressOptions& o) {
  json out = found_json(f);
  for (std::size_t k = 0; k < f.failures.size(); ++k) out["failures"][k]["file"] = path_of(f.failures[k], o);
  std::printf("%s\n", out.dump(1).c_str());
}

void print(const laws::Found& f, const StressOptions& o) {
  std::printf("%lld problems in %.1f s, %lld checks (%lld did not apply), %zu failures; classes:\n",
              static_cast<long long>(f.problems), f.seconds, static_cast<long long>(f.checks),
              static_cast<long long>(f.skipped), f.failures.size());
  print_classes(f);
  for (const laws::Failure& x : f.failures) {
    print_failure(x);
    std::printf("  delassus replay %s%s\n", path_of(x, o).c_str(), x.op == o.defect ? (" --defect " + o.defect).c_str() : "");
  }
}

/// Prints what was found and writes the files; the exit code.
int conclude(const laws::Found& f, const StressOptions& o) {
  for (const laws::Failure& x : f.failures) write_text(path_of(x, o), failure_json(x).dump(1));
  if (o.as_json) print_json(f, o);
  else print(f, o);
  if (!o.report.empty()) {
    std::string file = o.report;
    if (const std::size_t at = file.find("{shard}"); at != std::string::npos) file.replace(at, 7, std::to_string(f.shard));
    write_text(file, found_json(f).dump(1));
  }
  return f.failures.empty() ? good : law_broken;
}

int merge(const StressOptions& o) {
  std::vector<laws::Found> shards;
  for (const std::string& file : o.merge) {
    const json j = json::parse(read_text(file), nullptr, false);
    if (j.is_discarded()) throw ModelError(file, "document", "is not JSON, or holds a number beyond double", "a report written by `stress --report`; write it again");
    shards.push_back(read_found(j, file));
  }
  return conclude(laws::merged(shards), o);
}

int stress(const StressOptions& o) {
  if (!o.merge.empty()) return merge(o);
  laws::Search s = search_of(o);
  keep_on_interrupt();
  s.stop = interrupted;
  if (!o.as_json) {
    std::printf("seed %llu, shard %d/%d\n", static_cast<unsigned long long>(s.seed), s.shard, s.shards);
    s.progress = print_progress;
  }
  return end_of_run(conclude(laws::search(s), o), "the search ends before its time");
}

}  // namespace

void add_stress(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("stress", "randomised search for broken laws");
  auto o = std::make_shared<StressOptions>();
  c->add_option("--time", o->time, "how long: 60 or 60s, 10m, 2h")->check(options::duration())->capture_default_str();
  c->add_option("--count", o->count, "this many problems (of all shards together) instead of a time")->check(options::whole(1));
  c->add_option("--seed", o->seed, "of the first problem; when left out, a fresh one, printed")->check(options::whole(0));
  c->add_option("--shard", o->shard, "i/n: problems i, i + n, …; when left out, rank and size set by the launcher");
  c->add_option("--op", o->ops, "only these operators");
  c->add_option("--defect", o->defect, "an operator that is wrong in one respect (see `delassus list defects`): what the search must find");
  c->add_option("--failures", o->failures, "stop after this many pairs of law and operator")->check(options::whole(1))->capture_default_str();
  c->add_option("--folder", o->folder, "where failures are written")->check(options::existing_directory())->capture_default_str();
  c->add_option("--report", o->report, "write what was done as JSON; {shard} in the name becomes the shard's number");
  c->add_option("--merge", o->merge, "put reports of shards together instead of searching");
  c->add_flag("--json", o->as_json, "print {seed, shard, shards, problems, checks, skipped, seconds, classes, failures}, the report of --report with the `file` of every failure");
  c->footer("Ctrl-C keeps what was found. Exit code 1 when a law is broken; the failure is shrunk, written, and the command that replays it printed.");
  c->callback([=, &run] { run = [=] { return stress(*o); }; });
}

}  // namespace delassus::cli
