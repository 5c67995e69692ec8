// The table of ladders: mechanisms of one kind in sizes that double, made to show how an operator's work grows.
// A ladder is one row; `delassus bench --ladders`, the gate on orders and docs/ladders.md read the table.
#pragma once

#include <string_view>
#include <vector>

#include "generators/spec.h"

namespace delassus::generators {

struct LadderRow {
  std::string_view name, size, fixed, purpose;   ///< size: what s counts; fixed: what does not grow with it
  Spec (*make)(Index s);
  Index smallest, largest;                       ///< sizes are smallest · 2^k up to largest
  Index gate;                                    ///< up to where the gate counts
  /// What counts on it are sums of: sᵖ for every p in here, and sᵖ (log s)ʲ for one that stands j times more. Empty: of no such
  /// terms, since the order of elimination has none.
  std::vector<int> powers;
};

[[nodiscard]] const std::vector<LadderRow>& ladders();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const LadderRow& find_ladder(std::string_view name);

}  // namespace delassus::generators
