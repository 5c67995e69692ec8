// The catalogue of hard cases: families made to break things, and why each is hard (docs/hard_cases.md).
#pragma once

#include "generators/families.h"

namespace delassus::generators {

/// Families of the catalogue that are not among the common ones; families() lists them after those.
[[nodiscard]] std::vector<FamilyRow> hard_families();

/// One entry of the catalogue: a family, why it is hard, and the sizes its table is made at.
struct HardCase {
  std::string_view family, because;
  std::vector<Index> sizes;
};

[[nodiscard]] const std::vector<HardCase>& hard_cases();

}  // namespace delassus::generators
