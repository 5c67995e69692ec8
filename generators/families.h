// The table of families: recipes for problems with a size knob, the named hard cases among them.
// A family is one row; tests, command line, benchmarks and documentation read the table.
#pragma once

#include <string_view>
#include <vector>

#include "generators/spec.h"

namespace delassus::generators {

struct FamilyRow {
  std::string_view name, summary;
  Spec (*make)(Index n, std::uint64_t seed);   ///< n: size, about the number of bodies
  std::vector<Index> sizes;                    ///< of the gate
  Index exact_size;                            ///< size for exact arithmetic; −1: left out there
  bool regular = true;                         ///< A is regular (J has full row rank where R⁻¹ = 0)
};

[[nodiscard]] const std::vector<FamilyRow>& families();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const FamilyRow& find_family(std::string_view name);

}  // namespace delassus::generators
