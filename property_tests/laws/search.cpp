#include "property_tests/laws/search.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "generators/arbitrary.h"
#include "generators/classes.h"
#include "generators/random.h"
#include "generators/shrink.h"

namespace delassus::laws {
namespace {

using generators::Spec;

class Clock {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool starts_with(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }

/// The outcome on a spec; a spec that cannot be built breaks nothing.
Outcome outcome(const LawRow& law, const OperatorRow& op, const Spec& spec) {
  try {
    return check(law, op, make_case(spec));
  } catch (const ModelError&) {
    return {law.name, op.name, {}, "cannot be built", {}};
  }
}

void count_classes(const Spec& spec, Found& found) {
  const std::vector<bool> in = generators::classes_of(spec, generators::build(spec));
  for (std::size_t k = 0; k < in.size(); ++k) found.classes[k] += in[k] ? 1 : 0;
}

/// Laws on one problem; new pairs of law and operator are shrunk.
void check_problem(const Search& s, std::uint64_t seed, std::set<std::pair<std::string, std::string>>& broken, Found& found) {
  const Spec spec = generators::arbitrary(seed);
  count_classes(spec, found);
  ++found.problems;
  const Case c = make_case(spec);
  for (const OperatorRow& op : s.ops)
    for (const LawRow& law : laws()) {
      if (law.name == s.left_out || !chosen(law, spec)) continue;
      const Outcome o = check(law, op, c);
      ++(o.skipped ? found.skipped : found.checks);
      if (!o.failed() || !broken.emplace(o.law, o.op).second) continue;
      found.failures.push_back(shrunk(law, op, spec));
      found.failures.back().seed = seed;
      if (found.failures.size() >= s.most_failures) return;
    }
}

/// Of every pair of law and operator the failure with the lowest seed, by seed: what one search alone would keep.
void keep_lowest_seeds(std::vector<Failure>& failures) {
  std::stable_sort(failures.begin(), failures.end(), [](const Failure& a, const Failure& b) { return a.seed < b.seed; });
  std::set<std::pair<std::string, std::string>> seen;
  std::erase_if(failures, [&](const Failure& f) { return !seen.emplace(f.law, f.op).second; });
}

}  // namespace

bool chosen(const LawRow& law, const Spec& spec) {
  const bool exact = starts_with(law.name, "exact ");
  if (exact && spec.bodies.size() > 3) return false;
  if (law.name == "columns = definition" || law.name == "damped inverse = definition") return true;
  std::uint64_t mix = spec.seed;
  for (const char letter : law.name) mix = mix * 131 + static_cast<unsigned char>(letter);
  return generators::Random(mix).integer(1, exact ? 32 : 8) == 1;
}

Failure shrunk(const LawRow& law, const OperatorRow& op, const Spec& spec) {
  Failure f;
  f.seed = spec.seed;
  f.law = law.name;
  f.op = op.name;
  f.found_bodies = spec.bodies.size();
  const generators::Shrunk s =
      generators::shrink(spec, [&](const Spec& smaller) { return outcome(law, op, smaller).failed(); });
  f.spec = s.spec;
  f.tried = s.tried;
  const Verdict v = outcome(law, op, f.spec).verdict;
  f.ratio = v.ratio;
  f.note = v.note;
  return f;
}

Found search(const Search& s) {
  Found found;
  found.seed = s.seed;
  found.shard = s.shard;
  found.shards = s.shards;
  found.classes.assign(generators::classes().size(), 0);
  std::set<std::pair<std::string, std::string>> broken;
  const Clock clock;
  double told = 0;
  for (auto k = static_cast<std::int64_t>(s.shard - 1); found.failures.size() < s.most_failures; k += s.shards) {
    if (s.count > 0 ? k >= s.count : clock.seconds() >= s.seconds) break;
    if (s.stop && s.stop()) break;
    check_problem(s, s.seed + static_cast<std::uint64_t>(k), broken, found);
    found.seconds = clock.seconds();
    if (!s.progress || found.seconds < told + s.every) continue;
    told = found.seconds;
    s.progress(found);
  }
  found.seconds = clock.seconds();
  return found;
}

Found merged(const std::vector<Found>& shards) {
  const std::string accepted = "one report per shard of one search, each once; name them all";
  if (shards.empty()) throw ModelError("merge", "reports", "there is none", accepted);
  Found all = shards[0];
  std::set<int> seen;
  for (const Found& f : shards) {
    if (f.seed != all.seed || f.shards != all.shards)
      throw ModelError("merge", "shard " + std::to_string(f.shard) + "/" + std::to_string(f.shards),
                       "is of seed " + std::to_string(f.seed) + ", the first report of seed " + std::to_string(all.seed) +
                           " and " + std::to_string(all.shards) + " shards", accepted);
    if (!seen.insert(f.shard).second)
      throw ModelError("merge", "shard " + std::to_string(f.shard), "is there twice", accepted);
  }
  if (static_cast<int>(seen.size()) != all.shards)
    throw ModelError("merge", "reports", std::to_string(seen.size()) + " of " + std::to_string(all.shards) + " shards", accepted);
  for (std::size_t k = 1; k < shards.size(); ++k) {
    const Found& f = shards[k];
    all.problems += f.problems;
    all.checks += f.checks;
    all.skipped += f.skipped;
    all.seconds = std::max(all.seconds, f.seconds);
    for (std::size_t c = 0; c < all.classes.size(); ++c) all.classes[c] += f.classes[c];
    all.failures.insert(all.failures.end(), f.failures.begin(), f.failures.end());
  }
  keep_lowest_seeds(all.failures);
  all.shard = all.shards = 1;
  return all;
}

}  // namespace delassus::laws
