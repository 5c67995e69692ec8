// What analyze costs, counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "algorithms/delassus.h"
#include "algorithms/factors/dissection.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/unit/allocations.h"
#include "property_tests/laws/laws.h"

namespace delassus::analyze_test {
namespace {

TEST(Analyze, AllocatesAFewTimesWhateverTheSize) {
  laws::count_allocations();
  if (laws::allocation_count == nullptr) GTEST_SKIP() << "allocations are not counted in this build";
  constexpr std::int64_t constant = 40;  // 16 by lcaba, 33 by ladder where nothing couples bodies
  constexpr int growing = 4;             // lists that double: neighbours, the queue, Q of all bodies, blocks
  for (const auto& family : generators::families())
    for (const Index n : {1, 16, 160}) {
      const auto structure = generators::build(family.make(n, 1)).problem.structure;
      for (const char* name : {"lcaba", "lcaba_refined", "ladder"}) {
        const auto op = find_operator(name).make<double>();
        const std::int64_t before = laws::allocation_count();
        op->analyze(structure);
        const std::int64_t now = laws::allocation_count() - before;
        EXPECT_GT(now, 0) << "the counter counts";
        const int grown = growing * static_cast<int>(std::bit_width(static_cast<std::size_t>(structure->bodies())));
        const bool dissected = std::ranges::count(structure->parent, ground) > undivided;  // one more order, and its graph
        EXPECT_LE(now, constant + grown + (dissected ? constant / 2 + grown : 0)) << name << ", " << family.name << " n=" << n;
      }
    }
}

}  // namespace
}  // namespace delassus::analyze_test
