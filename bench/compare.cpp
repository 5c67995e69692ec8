#include "bench/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "algorithms/errors/status.h"
#include "bench/text.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

using Cells = std::vector<std::pair<std::string, Measured>>;

constexpr const char* accepted = "what `delassus bench --json` or `delassus bench --table1 --json` prints, or a report's results.json";

void add_time(Cells& to, const std::string& name, const json& t) {
  if (t.is_null()) return;
  const double median = t.at("median");
  if (!t.contains("quartiles")) {  // `bench --json`: the lowest alone, and as far above
    const double lowest = t.at("lowest");
    to.emplace_back(name, Measured{median, lowest, 2 * median - lowest, t.at("batches")});
    return;
  }
  to.emplace_back(name, Measured{median, t.at("quartiles").at(0), t.at("quartiles").at(1), t.at("rounds")});
}

void add_count(Cells& to, const std::string& name, const json& n) {
  if (!n.is_number() || n.get<double>() < 0) return;
  to.emplace_back(name, Measured{n, n, n, 0});
}

Cells cells_of(const json& j, const std::string& file) {
  Cells all;
  try {
    for (const json& s : j.at(j.contains("table1") ? "table1" : "scenes")) {
      const std::string scene = s.at("scene");
      add_time(all, scene + " · kinematics", s.at("kinematics_microseconds"));
      for (const json& c : s.at("operators")) {
        const std::string op = scene + " · " + c.at("operator").get<std::string>() + " · ";
        if (c.contains("uses"))
          for (const auto& [use, of] : c.at("uses").items()) {
            if (of.contains("microseconds")) add_time(all, op + use, of.at("microseconds"));
            if (of.contains("cache_lines")) add_count(all, op + use + " · cache lines", of.at("cache_lines"));
          }
        if (c.contains("microseconds"))
          for (const auto& [phase, t] : c.at("microseconds").items()) add_time(all, op + phase, t);
        if (c.contains("operations"))
          for (const auto& [phase, n] : c.at("operations").items()) add_count(all, op + phase + " · operations", n);
        if (c.contains("bytes")) add_count(all, op + "bytes", c.at("bytes"));
      }
    }
  } catch (const json::exception& e) {
    throw ModelError(file, "JSON", std::string("is no result of a bench: ") + e.what(), accepted);
  }
  return all;
}

double notch(const Measured& m) { return m.rounds == 0 ? 0 : 1.57 * (m.high - m.low) / std::sqrt(static_cast<double>(m.rounds)); }

}  // namespace

int Comparison::worse(double slack) const {
  return static_cast<int>(std::count_if(changes.begin(), changes.end(), [&](const Change& c) {
    return c.significant && c.after.value > (c.before.rounds == 0 ? 1 : slack) * c.before.value;
  }));
}

Comparison compare(const json& before, const json& after, const std::string& first, const std::string& second) {
  Comparison result;
  const Cells old = cells_of(before, first);
  std::map<std::string, Measured> now;
  for (const auto& [name, m] : cells_of(after, second)) now.emplace(name, m);
  std::vector<double> times;
  for (const auto& [name, m] : old) {
    const auto found = now.find(name);
    if (found == now.end()) {
      result.only_before.push_back(name);
      continue;
    }
    Change c{name, m, found->second, found->second.value / m.value - 1, (notch(m) + notch(found->second)) / m.value, false};
    if (m.value == 0) c.relative = found->second.value == 0 ? 0 : HUGE_VAL;
    c.significant = std::fabs(found->second.value - m.value) > notch(m) + notch(found->second);
    if (m.rounds > 0) times.push_back(c.relative);
    result.changes.push_back(c);
    now.erase(found);
  }
  for (const auto& [name, m] : now) result.only_after.push_back(name);
  std::sort(times.begin(), times.end());
  if (!times.empty()) result.drift = times[times.size() / 2];
  return result;
}

std::string comparison_text(const Comparison& c) {
  std::vector<const Change*> changed;
  for (const Change& one : c.changes)
    if (one.significant) changed.push_back(&one);
  std::stable_sort(changed.begin(), changed.end(), [](const Change* x, const Change* y) { return std::fabs(std::log1p(x->relative)) > std::fabs(std::log1p(y->relative)); });
  std::vector<std::vector<std::string>> rows{{"cell", "before", "after", "change", "less the drift", "± chance"}};
  for (const Change* one : changed) {
    const bool time = one->before.rounds > 0;
    rows.push_back({one->cell, three_digits(one->before.value) + (time ? " µs" : ""), three_digits(one->after.value) + (time ? " µs" : ""), format("%+.1f %%", 100 * one->relative),
                    time ? format("%+.1f %%", 100 * ((1 + one->relative) / (1 + c.drift) - 1)) : "", time ? format("%.1f %%", 100 * one->notch) : "exact"});
  }
  std::string s = changed.empty() ? std::string() : markdown_table(rows) + "\n";
  s += format("%zu of %zu cells changed by more than their spread explains; the times' change in common: %+.1f %%.\n", changed.size(), c.changes.size(), 100 * c.drift);
  if (!c.only_before.empty()) s += format("%zu cells in the first file alone, from %s on.\n", c.only_before.size(), c.only_before.front().c_str());
  if (!c.only_after.empty()) s += format("%zu cells in the second file alone, from %s on.\n", c.only_after.size(), c.only_after.front().c_str());
  return s;
}

void to_json(json& j, const Comparison& c) {
  const auto written = [](const Measured& m) { return m.rounds == 0 ? json(m.value) : json{{"median", m.value}, {"quartiles", {m.low, m.high}}, {"rounds", m.rounds}}; };
  j = {{"drift", c.drift}, {"only_before", c.only_before}, {"only_after", c.only_after}, {"changes", json::array()}};
  for (const Change& one : c.changes)
    j["changes"].push_back({{"cell", one.cell}, {"before", written(one.before)}, {"after", written(one.after)}, {"relative", std::isfinite(one.relative) ? json(one.relative) : json(nullptr)},
                            {"chance", one.notch}, {"significant", one.significant}});
}

}  // namespace delassus::bench
