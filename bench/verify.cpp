#include "bench/verify.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <thread>

#include "bench/text.h"
#include "property_tests/laws.h"

namespace delassus::bench {

namespace {

LawResult outcome(const laws::LawRow& law, const OperatorRow& op, const laws::Case& c) {
  const laws::Outcome o = laws::check(law, op, c);
  LawResult r{std::string(law.name), o.verdict.ratio, !o.failed(), o.skipped ? o.skipped : "", o.verdict.note};
  return r;
}

void verify_one(const Scene& scene, const std::vector<const OperatorRow*>& ops, double time_limit, SceneResult& result) {
  const auto start = std::chrono::steady_clock::now();
  const laws::Case c = laws::make_case(problem_of(scene), scene.damping, scene.name, 1);
  for (std::size_t i = 0; i < ops.size(); ++i)
    for (const laws::LawRow& law : laws::laws()) {
      if (seconds_since(start) < time_limit)
        result.cells[i].laws.push_back(outcome(law, *ops[i], c));
      else
        result.cells[i].laws.push_back({std::string(law.name), 0, true,
                                        format("time limit of %.0f s per scene reached", time_limit), ""});
    }
}

}  // namespace

void verify(const std::vector<Scene>& scenes, const std::vector<const OperatorRow*>& ops, double time_limit,
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
      verify_one(scenes[i], ops, time_limit, results[i]);
      const std::lock_guard lock(speaking);
      done(results[i]);
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned t = 1; t < std::max(1U, std::thread::hardware_concurrency()); ++t) workers.emplace_back(work);
  work();
}

}  // namespace delassus::bench
