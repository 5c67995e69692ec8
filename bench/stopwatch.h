// Time of one call: clock of the thread, warm caches, several batches in one run. What others do on the machine counts for caches alone.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <vector>

namespace delassus::bench {

/// Time of one call [µs]: median and lowest over batches; NaN when not measured.
struct Timing {
  double median = std::numeric_limits<double>::quiet_NaN();
  double lowest = std::numeric_limits<double>::quiet_NaN();
  int batches = 0;
  [[nodiscard]] bool measured() const { return batches > 0; }
};

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Time this thread has computed [s].
[[nodiscard]] inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Calls `f` once to warm up, then in up to 15 batches of equal length within about `budget` seconds. A call that is
/// longer than the budget, twice so that a machine that was busy once is not taken for it, counts as it is.
template <class F> [[nodiscard]] Timing stopwatch(F&& f, double budget) {
  const auto timed = [&](std::int64_t calls) {
    const double start = thread_seconds();
    for (std::int64_t i = 0; i < calls; ++i) f();
    return (thread_seconds() - start) / static_cast<double>(calls);
  };
  const double cold = timed(1), warm = timed(1), once = std::min(cold, warm);
  if (once > budget) return {5e5 * (cold + warm), 1e6 * once, 2};
  const auto calls = std::max<std::int64_t>(1, std::llround(budget / 15 / std::max(once, 1e-9)));
  const double batch = static_cast<double>(calls) * once;
  const int batches = std::clamp(static_cast<int>(budget / batch), 3, 15);
  std::vector<double> times;
  for (int b = 0; b < batches; ++b) times.push_back(1e6 * timed(calls));
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times.front(), batches};
}

}  // namespace delassus::bench
