// The pictures of accuracy_digest.h.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>

#include "bench/accuracy/accuracy_digest.h"
#include "bench/page/plot.h"

namespace delassus::accuracy {

namespace {

constexpr double worst_drawn = 10, best_drawn = 1e-17;  // of the error's axis: no digit or no answer; exact

double drawn(double error) { return std::isnan(error) ? worst_drawn : std::clamp(error, best_drawn, worst_drawn); }

double price_of(const Cell& c, Price price) {
  return price == Price::time ? c.time : c.operations > 0 ? static_cast<double>(c.operations) : std::nan("");
}

bench::Series& series_of(std::vector<bench::Series>& all, const Cell& c) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const bench::Series& s) { return s.title == c.rung; });
  return found != all.end() ? *found : all.emplace_back(bench::Series{c.rung, {}, c.style});
}

constexpr const char* error_axis = "relative error of the motion";

std::string identifier(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '-';
  return name;
}

/// Of one rung at one range of dampings.
struct Pool {
  double worst = 0;
  std::vector<double> prices;
};

std::size_t group(double damping) { return damping <= 2e-10 ? 0 : damping <= 2e-6 ? 1 : damping <= 2e-2 ? 2 : 3; }

}  // namespace

std::string picture(const Table& table, Price price) {
  std::vector<bench::Series> series;
  for (const Level& level : table.levels) {
    if (!level.no_reference.empty()) continue;
    for (const Cell& c : level.cells)
      if (const double p = price_of(c, price); p > 0 && c.style >= 0) {
        bench::Series& one = series_of(series, c);
        one.ringed = one.ringed || &level == &table.levels.front();
        one.points.emplace_back(drawn(c.errors.motion), p);
      }
  }
  const bool time = price == Price::time;
  return bench::labelled_plot((time ? "a-time-" : "a-work-") + identifier(table.name),
                              "Motion error against " + std::string(time ? "time" : "counted operations") + ", " + table.name,
                              error_axis, time ? "update and solve [µs]" : "operations of update and solve", series);
}

std::string overview(const std::vector<Table>& tables, Price price) {
  std::vector<bench::Series> series;  // in the order of the rungs
  std::map<std::string, std::array<Pool, 4>> pools;
  for (const Table& table : tables)
    for (const Level& level : table.levels) {
      const Cell* fast = level.find(fast_rung);
      if (!fast || !level.no_reference.empty()) continue;
      for (const Cell& c : level.cells) {
        if (c.style < 0) continue;
        static_cast<void>(series_of(series, c));
        Pool& pool = pools[c.rung][group(level.damping)];
        pool.worst = std::max(pool.worst, drawn(c.errors.motion));
        if (const double p = price_of(c, price) / price_of(*fast, price); p > 0) pool.prices.push_back(p);
      }
    }
  for (bench::Series& one : series) {
    one.ringed = !pools[one.title][0].prices.empty();
    for (Pool& pool : pools[one.title]) {
      if (pool.prices.empty()) continue;
      std::sort(pool.prices.begin(), pool.prices.end());
      one.points.emplace_back(pool.worst, pool.prices[pool.prices.size() / 2]);
    }
  }
  const bool time = price == Price::time;
  return bench::labelled_plot(time ? "a-time" : "a-work", "Worst motion error over all scenes against cost",
                              "worst error of the motion", time ? "time / time of lcaba" : "operations / operations of lcaba", series);
}

}  // namespace delassus::accuracy
