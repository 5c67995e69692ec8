#include "bench/scaling/dissection.h"

#include "algorithms/factors/elimination.h"
#include "bench/text.h"
#include "generators/build.h"
#include "generators/ladders.h"

namespace delassus::bench {

std::string dissection_table(const ScalingLadder& ladder) {
  constexpr Index smallest = 6, most_bodies = 10000;
  if (ladder.name != "wall" && ladder.name != "pyramid" && ladder.name != "lattice") return "";
  std::vector<std::vector<std::string>> rows{{"s", "bodies", "minimum degree", "order taken", "ratio"}};
  for (const ScalingSize& size : ladder.sizes) {
    if (size.s < smallest || (size.s % 10 != 0 && (size.s & (size.s - 1)) != 0 && size.s != ladder.sizes.back().s)) continue;
    const Structure s = *generators::build(generators::find_ladder(ladder.name).make(size.s)).problem.structure;
    if (s.bodies() > most_bodies) continue;
    const auto work = [&](Ordering ordering) { return eliminate(s, Matrix::M_R, Branches::with_rows, ordering).work; };
    const double plain = work(Ordering::minimum_degree), taken = work(Ordering::cheapest);
    rows.push_back({std::to_string(size.s), std::to_string(s.bodies()), format("%.4g", plain), format("%.4g", taken), format("%.2f", taken / plain)});
  }
  return "\nΣ n (|Q| + 1)², which an update of `lcaba` is made of, by minimum degree alone, and in the order taken, dissected where that is less:\n\n" + markdown_table(rows);
}

}  // namespace delassus::bench
