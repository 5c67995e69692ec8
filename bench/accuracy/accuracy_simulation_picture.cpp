// The picture of accuracy_simulation.h.
#include <algorithm>
#include <cmath>

#include "bench/accuracy/accuracy_simulation.h"
#include "bench/page/plot.h"

namespace delassus::accuracy {
namespace {

constexpr double least = 1e-17;  // of the error's axis: exact

double of(const Distance& d) { return std::max({d.metres, d.radians, least}); }

}  // namespace

std::string picture(const SimulatedScene& s) {
  std::vector<bench::Series> series;
  bench::Series alone{"relaxation alone", {}, 0, false}, floor{"reference", {}, 0, false};
  double fast = HUGE_VAL, slow = 0;
  for (const SimulatedLine& line : s.lines) {
    bench::Series one{line.name, {}, static_cast<int>(series.size()), false};
    for (const SimulatedCell& c : line.cells) {
      if (!(c.seconds > 0) || !std::isfinite(c.error.size())) continue;
      one.points.emplace_back(of(c.error), c.seconds);
      fast = std::min(fast, c.seconds), slow = std::max(slow, c.seconds);
      if (line.relaxed && (alone.points.empty() || alone.style == one.style)) {  // of the first such line
        alone.style = one.style;
        alone.points.emplace_back(of(c.modelling), c.seconds);
      }
    }
    if (!one.points.empty()) series.push_back(std::move(one));
  }
  if (series.empty()) return "";
  if (!alone.points.empty()) {
    alone.style = static_cast<int>(series.size());
    series.push_back(std::move(alone));
  }
  if (std::isfinite(s.reference.error.size())) {
    floor.points = {{of(s.reference.error), fast}, {of(s.reference.error), slow}};
    floor.style = static_cast<int>(series.size());
    series.push_back(std::move(floor));
  }
  return bench::labelled_plot("simulated-" + s.name, "Error of the trajectory against computing time, " + s.name,
                              "error of the placements [m or rad]", "computing time [s]", series);
}

}  // namespace delassus::accuracy
