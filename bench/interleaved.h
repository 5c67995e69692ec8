// Several tasks timed in turn, so that a slow phase of the machine meets all of them: ratios within one run. By the clock of the thread:
// what others do on the machine meanwhile does not count, but for the caches.
#pragma once

#include <functional>

#include "bench/stopwatch.h"

namespace delassus::bench {

/// Time of one call [µs] over rounds: median, quartiles. NaN: not measured.
struct Spread {
  double median = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
  int rounds = 0;
  [[nodiscard]] bool measured() const { return rounds > 0; }
};

/// Of a list that is not empty, in any order: the middle one, and those a quarter from either end.
[[nodiscard]] inline Spread spread_of(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const std::size_t n = times.size(), quarter = n / 4;
  return {times[n / 2], times[quarter], times[n - 1 - quarter], static_cast<int>(n)};
}

/// Of a − b, round by round: what slows both down does not count. Both lists at least one.
[[nodiscard]] inline Spread difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) d.push_back(a[k] - b[k]);
  return spread_of(d);
}

/// Times every task [µs]: in up to `rounds` rounds one batch of each, a call to warm up before it where calls are short. About `budget`
/// seconds per task; a task longer than a round's share takes fewer rounds, three at least. Cost: tasks · budget.
[[nodiscard]] inline std::vector<std::vector<double>> in_rounds(const std::vector<std::function<void()>>& tasks, double budget, int rounds = 15) {
  struct Plan {
    std::int64_t calls;
    int rounds;
    bool warm;
    std::vector<double> times;
  };
  const auto timed = [](const std::function<void()>& task, std::int64_t calls) {
    const double start = thread_seconds();
    for (std::int64_t i = 0; i < calls; ++i) task();
    return (thread_seconds() - start) / static_cast<double>(calls);
  };
  std::vector<Plan> plans;
  for (const auto& task : tasks) {
    const double cold = timed(task, 1), warm = cold > budget ? cold : timed(task, 1), once = std::max(std::min(cold, warm), 1e-9);
    const double share = budget / rounds;
    const auto calls = std::max<std::int64_t>(1, std::llround(share / once));
    plans.push_back({calls, std::clamp(static_cast<int>(budget / (static_cast<double>(calls) * once)), 3, rounds), once < share, {}});
  }
  for (int r = 0; r < rounds; ++r)
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      Plan& p = plans[i];
      if ((r + 1) * p.rounds / rounds == r * p.rounds / rounds) continue;  // its rounds are spread over all
      if (p.warm) tasks[i]();
      p.times.push_back(1e6 * timed(tasks[i], p.calls));
    }
  std::vector<std::vector<double>> out;
  for (Plan& p : plans) out.push_back(std::move(p.times));
  return out;
}

[[nodiscard]] inline std::vector<Spread> interleaved(const std::vector<std::function<void()>>& tasks, double budget, int rounds = 15) {
  std::vector<Spread> out;
  for (const auto& times : in_rounds(tasks, budget, rounds)) out.push_back(spread_of(times));
  return out;
}

}  // namespace delassus::bench
