// The fuzz of the loaders: sound texts of every format (fuzz_texts.cpp), whole kinds of broken texts, and mutants
// (mutate_text.h), each judged (fuzz_judge.h) in a child process that reads a batch of them. A crash, a hang and whatever
// the judge finds is printed, and the text is saved.
//
//   fuzz_loaders                          what the tests run: the corpus, the whole kinds, some thousand mutants
//   fuzz_loaders --count 1000000          longer; other mutants with --seed; --share sdf=5 urdf=40 …
//   fuzz_loaders FILE…                    judges these files only
// Exit code 1 with a finding.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <sys/time.h>
#include <unistd.h>

#include "property_tests/campaigns/fuzz_judge.h"
#include "cli/program/isolated.h"
#include "property_tests/campaigns/mutate_text.h"
#include "cli/program/options.h"

namespace {

using namespace delassus;
namespace fs = std::filesystem;

const std::vector<std::string> formats{"urdf", "yaml", "json", "xml", "sdf"};

/// What is wrong with an entry of --share.
std::string format_and_weight(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return "is '" + text + "' (accepted: FORMAT=WEIGHT, as in sdf=5; a weight is a whole number)";
  const std::string format = options::one_of(formats)(text.substr(0, equals)), weight = options::whole(0)(text.substr(equals + 1));
  return !format.empty() ? format : weight.empty() && text.size() - equals > 5 ? "is '" + text + "' (accepted: weights up to 9999; only their ratios count)" : weight;
}

struct Options {
  std::int64_t count = 6000;
  std::int64_t seed = 1;
  double limit = 20;
  std::size_t findings = 20;
  std::string keep = ".", only, corpus = DELASSUS_LOADER_CORPUS;
  std::vector<std::string> files, share;
  bool mutants_only = false;
};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<FuzzText> files_as_texts(const std::vector<fs::path>& files) {
  std::vector<FuzzText> out;
  for (const fs::path& f : files) out.push_back({f.extension().string().substr(std::min<std::size_t>(1, f.extension().string().size())), read(f)});
  return out;
}

/// Ends the process after so much time of the processor (a busy machine is no hang), or after thirty times that on the clock.
void limit_time(double seconds) {
  const auto whole = static_cast<time_t>(seconds);
  const itimerval t{{0, 0}, {whole, static_cast<suseconds_t>(1e6 * (seconds - static_cast<double>(whole)))}};
  ::setitimer(ITIMER_PROF, &t, nullptr);
  ::alarm(static_cast<unsigned>(30 * seconds) + (seconds > 0 ? 1 : 0));
}

struct Tally {
  std::int64_t seen = 0, loaded = 0, refused = 0;
};

class Fuzz {
 public:
  explicit Fuzz(const Options& o) : o_(o), folder_(fs::temp_directory_path() / ("fuzz_loaders." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    prepare_fuzz_folder(folder_);
  }
  ~Fuzz() { std::error_code ignored; fs::remove_all(folder_, ignored); }
  Fuzz(const Fuzz&) = delete;
  Fuzz& operator=(const Fuzz&) = delete;

  [[nodiscard]] bool full() const { return found_ >= o_.findings; }
  [[nodiscard]] std::size_t found() const { return found_; }
  [[nodiscard]] const std::map<std::string, Tally>& tallies() const { return tally_; }

  /// Judges texts number 0 … n−1, a child for each stretch between crashes.
  template <class Make> void run(const char* what, std::int64_t n, const Make& make) {
    constexpr std::int64_t batch = 500;
    for (std::int64_t first = 0; first < n && !full();) {
      first = stretch(first, std::min(n, first + batch), make);
      if (n > batch) std::fprintf(stderr, "\r%s: %lld of %lld, %zu findings ", what, static_cast<long long>(first), static_cast<long long>(n), found_);
    }
    if (n > batch) std::fprintf(stderr, "\n");
  }

 private:
  /// Lines from the child: `B i` before a text, `L i` or `R i` after it, `F i finding`. Returns where to go on.
  template <class Make> std::int64_t stretch(std::int64_t first, std::int64_t end, const Make& make) {
    const Outcome outcome = isolated(
        [&](const Progress& progress) {
          for (std::int64_t i = first; i < end; ++i) {
            const FuzzText text = make(i);
            progress("B" + std::to_string(i) + "\n");
            limit_time(o_.limit);
            const FuzzVerdict v = judge_text(text, folder_, static_cast<std::uint64_t>(i));
            limit_time(0);
            std::string line = v.finding;
            for (char& c : line) if (c == '\n') c = ' ';
            progress((v.loaded ? "L" : "R") + text.format + "\n" + (line.empty() ? "" : "F" + std::to_string(i) + " " + line + "\n"));
          }
          return std::string("E\n");
        },
        o_.limit * 30 * 500);
    std::int64_t last = first;
    bool done = false;
    for (std::size_t at = 0; at < outcome.result.size();) {
      const std::size_t next = std::min(outcome.result.find('\n', at), outcome.result.size());
      const std::string line = outcome.result.substr(at, next - at);
      at = next + 1;
      if (line[0] == 'B') last = std::stoll(line.substr(1));
      if (line[0] == 'L' || line[0] == 'R') {
        Tally& t = tally_[line.substr(1)];
        ++t.seen;
        (line[0] == 'L' ? t.loaded : t.refused)++;
      }
      if (line[0] == 'F') keep(make(last), line.substr(line.find(' ') + 1));
      done = done || line[0] == 'E';
    }
    if (done && outcome.end == Outcome::End::returned) return end;
    FuzzText text = make(last);
    ++tally_[text.format].seen;
    const bool hang = outcome.end == Outcome::End::timed_out || outcome.signal == SIGPROF || outcome.signal == SIGALRM;
    keep(text, hang ? "no answer within the time limit" : delassus::describe(outcome) + (outcome.said.empty() ? "" : ": " + outcome.said.substr(0, 1500)));
    return last + 1;
  }

  void keep(const FuzzText& text, const std::string& finding) {
    const fs::path file = fs::path(o_.keep) / ("finding_" + std::to_string(found_++) + "." + text.format);
    std::ofstream(file, std::ios::binary) << text.text;
    std::printf("%s: %s\n", file.string().c_str(), finding.c_str());
    std::fflush(stdout);
  }

  const Options& o_;
  fs::path folder_;
  std::size_t found_ = 0;
  std::map<std::string, Tally> tally_;
};

std::vector<fs::path> corpus_of(const Options& o) {
  std::vector<fs::path> out;
  if (fs::is_directory(o.corpus))
    for (const auto& entry : fs::directory_iterator(o.corpus))
      if (entry.path().has_extension()) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<FuzzText> chosen(const std::vector<FuzzText>& all, const std::string& only) {
  std::vector<FuzzText> out;
  for (const FuzzText& t : all)
    if (only.empty() || t.format == only) out.push_back(t);
  return out;
}

/// Which text the mutants start from: by the weights of --share, whole numbers; every text as often where there are none.
class Starts {
 public:
  Starts(const std::vector<FuzzText>& texts, const std::vector<std::string>& share) : texts_(texts) {
    std::map<std::string, std::int64_t> weights;
    for (const std::string& s : share) weights[s.substr(0, s.find('='))] = std::stoll(s.substr(s.find('=') + 1));
    for (std::size_t k = 0; k < texts.size(); ++k) {
      if (weights.empty()) turns_.push_back({k});
      if (!weights.empty() && (k == 0 || texts[k].format != texts[k - 1].format)) {
        std::vector<std::size_t> same;
        for (std::size_t i = k; i < texts.size() && texts[i].format == texts[k].format; ++i) same.push_back(i);
        for (std::int64_t n = weights[texts[k].format]; n > 0; --n) turns_.push_back(same);
      }
    }
    if (turns_.empty()) throw std::invalid_argument("--share leaves no text to start from; give a format a weight above 0");
  }
  [[nodiscard]] const FuzzText& of(std::int64_t i) const {
    const auto n = static_cast<std::int64_t>(turns_.size());
    const std::vector<std::size_t>& same = turns_[static_cast<std::size_t>(i % n)];
    return texts_[same[static_cast<std::size_t>(i / n) % same.size()]];
  }

 private:
  const std::vector<FuzzText>& texts_;
  std::vector<std::vector<std::size_t>> turns_;
};

/// The sound texts must load, and in silence but for notes, or the judge would be deaf. A format may be left out of the build.
bool sound(const std::vector<FuzzText>& texts, const std::string& folder) {
  bool all = true;
  for (const FuzzText& t : texts)
    for (const std::uint64_t seed : {0, 1}) {
      const FuzzVerdict v = judge_text(t, folder, seed);
      if (v.loaded && v.finding.empty() && (v.message.empty() || t.format == "xml" || t.format == "sdf")) continue;  // these have notes
      if (!v.loaded && v.message.find("built without") != std::string::npos) continue;
      std::printf("a sound text (%s) is not read as one: %s %s\n", t.format.c_str(), v.message.c_str(), v.finding.c_str());
      all = false;
    }
  return all;
}

int fuzz(const Options& o) {
  Fuzz fuzz(o);
  const auto from = [](const std::vector<FuzzText>& list) { return [&list](std::int64_t i) { return list[static_cast<std::size_t>(i)]; }; };
  if (!o.files.empty()) {
    const std::vector<FuzzText> given = files_as_texts({o.files.begin(), o.files.end()});
    fuzz.run("files", static_cast<std::int64_t>(given.size()), from(given));
  } else {
    const std::vector<FuzzText> texts = chosen(fuzz_texts(), o.only), corpus = files_as_texts(corpus_of(o));
    const Starts starts(texts, o.share);
    const fs::path folder = fs::temp_directory_path() / ("fuzz_sound." + std::to_string(::getpid()));
    fs::create_directories(folder);
    prepare_fuzz_folder(folder);
    const bool heard = sound(texts, folder);
    fs::remove_all(folder);
    if (!heard) return 1;
    fuzz.run("corpus", static_cast<std::int64_t>(corpus.size()), from(corpus));
    std::vector<FuzzText> kinds;
    for (const FuzzText& t : o.mutants_only ? std::vector<FuzzText>{} : texts) {
      const std::size_t step = t.format == "sdf" && t.text.size() > 2000 ? 10 : 1;  // libsdformat takes 20 ms for a text
      std::vector<std::string> all = whole_kinds(t.text);
      for (std::size_t k = 0; k < all.size(); k += step) kinds.push_back({t.format, std::move(all[k])});
    }
    fuzz.run("whole kinds", static_cast<std::int64_t>(kinds.size()), from(kinds));
    const auto mutant = [&](std::int64_t i) {
      const FuzzText& t = starts.of(i);
      return FuzzText{t.format, mutated(t.text, static_cast<std::uint64_t>(o.seed) * 1000000007u + static_cast<std::uint64_t>(i))};
    };
    fuzz.run("mutants", o.count, mutant);
  }
  std::int64_t seen = 0;
  for (const auto& [format, t] : fuzz.tallies()) {
    std::printf("%-5s %lld read: %lld loaded, %lld refused\n", format.c_str(), static_cast<long long>(t.seen), static_cast<long long>(t.loaded), static_cast<long long>(t.refused));
    seen += t.seen;
  }
  std::printf("%lld texts, %zu findings\n", static_cast<long long>(seen), fuzz.found());
  return fuzz.found() > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Broken robots, scenes and specs for the loaders: each is refused in words, or loads as what it says."};
  Options o;
  app.add_option("--count", o.count, "mutants")->check(options::whole(0))->capture_default_str();
  app.add_option("--seed", o.seed, "of the mutants")->check(options::whole(0))->capture_default_str();
  app.add_option("--limit", o.limit, "time of the processor for one text [s]")->check(options::above(0, "s"))->capture_default_str();
  app.add_option("--findings", o.findings, "stop after so many")->capture_default_str();
  app.add_option("--only", o.only, "one format")->check(options::one_of(formats));
  app.add_option("--share", o.share, "how often each format is taken, as in urdf=40 yaml=20 json=10 xml=25 sdf=5; without: every text as often")
      ->check(format_and_weight);
  app.add_flag("--mutants-only", o.mutants_only, "without the whole kinds, which are the same for every seed");
  app.add_option("--keep", o.keep, "folder for the texts of findings")->check(options::existing_directory())->capture_default_str();
  app.add_option("FILE", o.files, "judge these only")->check(options::existing_file());
  app.footer("Exit code 1 with a finding.");
  return options::run(app, argc, argv, [&] { return fuzz(o); });
}
