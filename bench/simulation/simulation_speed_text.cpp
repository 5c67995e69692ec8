#include <cmath>
#include <map>

#include "bench/simulation/simulation_speed.h"
#include "bench/text.h"

namespace delassus::bench {
namespace {

using Cells = std::vector<std::vector<std::string>>;

std::string short_number(double x) { return x == 0 ? "0" : std::isinf(x) ? "∞" : rough_digit(x); }
std::string count(double x) { return std::isnan(x) ? "–" : format("%.0f", x); }

/// Time of a step of one over that of the other; NaN: one has none.
double ratio(const SpeedEntry* theirs, const SpeedEntry* ours) { return theirs != nullptr && ours != nullptr ? theirs->time.median / ours->time.median : NAN; }

std::string counts(const SpeedScene& s, std::int64_t SpeedEntry::*what) {
  std::string out;
  for (const SpeedEntry& e : s.entries)
    if ((!e.ours() || e.name == own_name) && e.time.measured()) out += (out.empty() ? "" : " / ") + std::to_string(e.*what);
  return out;
}

std::string main_table(const SimulationSpeed& t) {
  Cells cells{{"example", "dofs", "rows", "ours", "residual"}};
  for (const SpeedEntry& e : from_outside(t)) cells[0].insert(cells[0].end(), {e.name, "residual", "ratio", "ours, no coarser", "ratio"});
  for (const SpeedScene& s : t.scenes) {
    std::vector<std::string> line{s.example.name, std::to_string(s.dofs), counts(s, &SpeedEntry::rows)};
    const auto speed = [&](const SpeedEntry* e) { line.push_back(e == nullptr || !e->time.measured() ? "–" : count(e->steps_per_second()) + (e->ended.empty() ? "" : " †")); };
    const auto pair = [&](const SpeedEntry* e) {
      speed(e);
      line.push_back(line.back() == "–" || std::isnan(e->median.natural) ? "–" : short_number(e->median.natural) + " (" + short_number(e->worst.natural) + ")");
    };
    pair(s.find(own_name));
    for (const SpeedEntry& e : from_outside(t)) {
      pair(s.find(e.name));
      line.push_back(three_digits(ratio(s.find(e.name), s.find(own_name))));
      speed(s.as_accurate_as(e.name));
      line.push_back(three_digits(ratio(s.find(e.name), s.as_accurate_as(e.name))));
    }
    cells.push_back(line);
  }
  return markdown_table(cells);
}

/// Ours is slower there.
std::string wins(const SimulationSpeed& t) {
  std::string s;
  for (const SpeedEntry& e : from_outside(t))
    for (const bool equal : {true, false}) {
      std::string robots, rest;
      int compared = 0;
      for (const SpeedScene& scene : t.scenes) {
        const double x = ratio(scene.find(e.name), equal ? scene.as_accurate_as(e.name) : scene.find(own_name));
        if (std::isnan(x)) continue;
        ++compared;
        if (x >= 1) continue;
        std::string& to = scene.example.robot ? robots : rest;
        to += (to.empty() ? "" : ", ") + scene.example.name + format(" %.2g times", 1 / x);
      }
      s += "- `" + e.name + "` against ours " + (equal ? "where ours is no coarser" : "at the residual of the example") + format(", %d examples: ", compared);
      s += robots.empty() && rest.empty() ? "nowhere" : (robots.empty() ? "on no robot" : "**on robots: " + robots + "**") + (rest.empty() ? "" : "; " + rest);
      s += ".\n";
    }
  return s;
}

std::string detail_table(const SimulationSpeed& t) {
  Cells cells{{"example", "program", "µs a step", "quartiles", "iterations", "contacts", "natural [m/s]", "approach [m/s]", "cone [N s]", "momentum [N s]", "depth [m]", "M", "ν̇"}};
  for (const SpeedScene& s : t.scenes)
    for (const SpeedEntry& e : s.entries) {
      if (!e.time.measured()) continue;
      const auto both = [&](double StepResidual::*x) { return short_number(e.median.*x) + " (" + short_number(e.worst.*x) + ")"; };
      cells.push_back({s.example.name, e.name, three_digits(e.time.median), three_digits(e.time.low) + " … " + three_digits(e.time.high), three_digits(e.iterations), std::to_string(e.contacts),
                       both(&StepResidual::natural), both(&StepResidual::approach), both(&StepResidual::cone), both(&StepResidual::momentum), both(&StepResidual::depth), short_number(e.M_error),
                       short_number(e.free_error)});
    }
  return markdown_table(cells, 2);
}

std::string left_out(const SimulationSpeed& t) {
  std::map<std::string, std::string> of;  // by reason: programs and examples
  std::string s;
  for (const SpeedScene& scene : t.scenes)
    for (const SpeedEntry& e : scene.entries) {
      if (!e.cannot.empty()) of[e.cannot] += (of[e.cannot].empty() ? "" : ", ") + scene.example.name + " by `" + e.name + "`";
      if (!e.disagrees.empty()) s += "- **" + scene.example.name + ", `" + e.name + "` was not timed**: " + e.disagrees + "\n";
      if (!e.ended.empty()) s += "- † " + scene.example.name + ", `" + e.name + "` ended before its time, " + e.ended + "\n";
    }
  for (const auto& [why, who] : of) s += "- " + who + ": " + why + "\n";
  return s.empty() ? s : "\n### Left out, or ended early\n" + s;
}

}  // namespace

std::string speed_text(const SimulationSpeed& t) {
  std::string s = t.text() +
                  "Medians of 3 to 15 runs, all of an example in turn in one process, by the clock of the thread.\n";
  if (t.interrupted) s += "**Interrupted**: examples are missing.\n";
  if (t.disagreements() > 0) s += format("**%d were not timed**: they do not move as ours without rows.\n", t.disagreements());
  for (const SpeedEntry& e : from_outside(t)) s += "- `" + e.name + "`: " + e.program + ", " + e.what + "\n";
  return s + "\n### Steps per second\nResidual: natural, in m/s, median of the steps that were judged (the largest). Ratio: time of a step over ours, above 1 ours is faster.\n\n" + main_table(t) +
         "\n### Where others are faster\n" + wins(t) + "\n### All numbers\n" + detail_table(t) + left_out(t);
}

}  // namespace delassus::bench
