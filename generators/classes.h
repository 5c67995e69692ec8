// The hard classes of problems: what each is, measured on what was built, and the least share a search must have of it.
#pragma once

#include <string_view>
#include <vector>

#include "generators/build.h"

namespace delassus::generators {

/// What the classes look at. `rank` is that of J.
struct Facts {
  const Spec& spec;
  const Built& built;
  Index rank;
};

struct ClassRow {
  std::string_view name, definition;
  double least_share;               ///< of the specs of `arbitrary` over many seeds
  bool (*holds)(const Facts&);
};

[[nodiscard]] const std::vector<ClassRow>& classes();

/// One flag per row of the table.
[[nodiscard]] std::vector<bool> classes_of(const Spec& spec, const Built& built);

/// Rank of J from its own numbers modulo 2⁶¹ − 1: never above the rank in rational numbers, and below it with a
/// probability of about m/2⁶¹. Cost O(m n min(m, n)).
[[nodiscard]] Index rank_of_J(const Problem<double>& problem);

}  // namespace delassus::generators
