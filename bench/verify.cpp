#include "bench/verify.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <thread>

#include "bench/accuracy/accuracy.h"
#include "bench/text.h"
#include "property_tests/laws/laws.h"

namespace delassus::bench {

namespace {

struct Pair {
  std::size_t op, law;
};

LawResult outcome(const laws::LawRow& law, const OperatorRow& op, const laws::Case& c) {
  const laws::Outcome o = laws::check(law, op, c);
  LawResult r{std::string(law.name), o.verdict.ratio, !o.failed(), o.skipped ? o.skipped : "", o.verdict.note, false};
  return r;
}

/// Why a law does not apply; nullptr: it does, or that could not be found out because the operator gave no answer.
const char* not_applicable(const laws::LawRow& law, const OperatorRow& op, const laws::Case& c) {
  try {
    return law.why_not(op, c);
  } catch (const std::exception&) {
    return nullptr;
  }
}

/// In double.
bool is_definition(const laws::LawRow& law) { return law.name.find("= definition") != std::string_view::npos && law.name.rfind("exact", 0) != 0; }

/// Laws against a definition, and every law of the default.
bool comes_first(const laws::LawRow& law, const OperatorRow& op) {
  return op.name == accuracy::default_rung || is_definition(law);
}

/// Pairs of operator and law by what matters first: every operator against the definitions, the default against all laws, then law
/// by law, so that time runs out on every operator alike.
std::vector<Pair> by_importance(const std::vector<const OperatorRow*>& ops) {
  std::vector<Pair> pairs;
  for (std::size_t l = 0; l < laws::laws().size(); ++l)
    for (std::size_t i = 0; i < ops.size(); ++i) pairs.push_back({i, l});
  const auto rank = [&](const Pair& p) {
    const laws::LawRow& law = laws::laws()[p.law];
    return !comes_first(law, *ops[p.op]) ? 2 : is_definition(law) ? 0 : 1;
  };
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& x, const Pair& y) { return rank(x) < rank(y); });
  return pairs;
}

void verify_one(const Scene& scene, const std::vector<const OperatorRow*>& ops, const Deadline& deadline, SceneResult& result) {
  const auto start = std::chrono::steady_clock::now();
  if (deadline.stop && deadline.stop()) return;
  const laws::Case c = laws::make_case(problem_of(scene), scene.damping, scene.name, 1);
  for (std::size_t i = 0; i < ops.size(); ++i) result.cells[i].laws.resize(laws::laws().size());
  for (const Pair& p : by_importance(ops)) {
    const laws::LawRow& law = laws::laws()[p.law];
    LawResult& r = result.cells[p.op].laws[p.law];
    const bool stopped = deadline.stop && deadline.stop();
    const bool due = deadline.seconds > 0 ? seconds_since(start) < deadline.seconds : false;
    const bool first = comes_first(law, *ops[p.op]) && (deadline.default_in_full || ops[p.op]->name != accuracy::default_rung || is_definition(law));
    if (!stopped && (due || first)) {
      r = outcome(law, *ops[p.op], c);
      continue;
    }
    r.law = std::string(law.name);
    const char* const why_not = not_applicable(law, *ops[p.op], c);
    r.left_out = why_not == nullptr;
    r.skipped = why_not ? why_not : stopped ? "interrupted" : "no time left";
  }
}

}  // namespace

void verify(const std::vector<Scene>& scenes, const std::vector<const OperatorRow*>& ops, const Deadline& deadline,
            std::vector<SceneResult>& results, const std::function<void(const SceneResult&)>& done) {
  std::vector<std::size_t> order(scenes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return results[a].rows > results[b].rows; });
  std::atomic<std::size_t> next = 0;
  std::mutex speaking;
  const auto work = [&] {
    for (std::size_t k; (k = next++) < order.size();) {
      const std::size_t i = order[k];
      verify_one(scenes[i], ops, deadline, results[i]);
      const std::lock_guard lock(speaking);
      done(results[i]);
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned t = 1; t < std::max(1U, std::thread::hardware_concurrency()); ++t) workers.emplace_back(work);
  work();
}

}  // namespace delassus::bench
