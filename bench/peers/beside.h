// What the runs beside programs from outside share (peer_table.h, simulation_speed.h): under what they were measured, scene after scene.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "bench/results.h"
#include "bench/stopwatch.h"
#include "bench/text.h"

namespace delassus::bench {

struct Beside {
  Machine machine;
  std::string kernels;
  double budget = 0, load = 0, load_after = 0;  ///< seconds that a timed row gets; load averages at the start and at the end
  bool interrupted = false;

  /// This machine and our kernels, now.
  void begin(double seconds);
  void end();
  /// Processor, system, compiler, kernels, revision, loads: a line.
  [[nodiscard]] std::string text() const;
};

/// Into what a table of results is written with, and back. @throws nlohmann::json::exception for anything else.
void write(nlohmann::json& j, const Beside& b);
void read(const nlohmann::json& j, Beside& b);

/// t.scenes: measure(item) of every item, in turn. `progress` is called with a line of text after each, with its name; `stop` is asked before.
template <class Table, class Item, class Measure, class Name>
void measure_scenes(Table& t, const std::vector<Item>& items, double budget, const Measure& measure, const Name& name, const std::function<void(const std::string&)>& progress,
                    const std::function<bool()>& stop) {
  t.begin(budget);
  const auto start = std::chrono::steady_clock::now();
  for (const Item& item : items) {
    if (stop && stop()) {
      t.interrupted = true;
      break;
    }
    t.scenes.push_back(measure(item));
    progress(format("%2zu/%zu  %s  %.0f s", t.scenes.size(), items.size(), pad_right(name(item), 26).c_str(), seconds_since(start)));
  }
  t.end();
}

/// The rows of programs from outside, as the first scene has them.
template <class Table> [[nodiscard]] auto from_outside(const Table& t) {
  auto out = t.scenes.empty() ? decltype(t.scenes.front().entries){} : t.scenes.front().entries;
  std::erase_if(out, [](const auto& e) { return e.ours(); });
  return out;
}

}  // namespace delassus::bench
