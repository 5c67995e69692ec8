// Two files of results, cell by cell: relative change, spread, and whether the change is more than the spread explains.
//
// A cell is a time of an operator, or of kinematics, in one phase on one scene, or a number that does not depend on the clock (bytes,
// operations, cache lines). Times differ where their medians' notches, ± 1.57 (q₃ − q₁)/√n, do not overlap: some 95 % (McGill,
// Tukey, Larsen 1978), where a file gives no quartiles twice the distance of median and lowest in their place; counts where they are not equal. `drift` is the change all times have in common, their median: the
// machine's, as a rule.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace delassus::bench {

struct Measured {
  double value = 0, low = 0, high = 0;   ///< median and quartiles; of a count three times the same
  int rounds = 0;                        ///< 0: a count
};
struct Change {
  std::string cell;                      ///< "scene · operator · phase"
  Measured before, after;
  double relative = 0;                   ///< after / before − 1
  double notch = 0;                      ///< by how much it may be chance, relative to before
  bool significant = false;
};
struct Comparison {
  std::vector<Change> changes;           ///< of cells in both files, in the order of the first
  std::vector<std::string> only_before, only_after;
  double drift = 0;                      ///< relative change of all times in the middle

  /// Times that became slower, and counts that became larger, by more than `slack` times, significantly.
  [[nodiscard]] int worse(double slack) const;
};

/// Files of `bench --json`, of `bench --table1 --json` or results.json of a report, both of one kind. @throws ModelError naming `first` or
/// `second` when it is none.
[[nodiscard]] Comparison compare(const nlohmann::json& before, const nlohmann::json& after, const std::string& first, const std::string& second);
/// Every significant change, largest first, and what there was beside.
[[nodiscard]] std::string comparison_text(const Comparison& c);
void to_json(nlohmann::json& j, const Comparison& c);

}  // namespace delassus::bench
