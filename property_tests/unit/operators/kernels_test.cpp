// The parts operators are made of, against the definition.
#include <gtest/gtest.h>

#include "property_tests/unit/operators/kernels.h"
#include "property_tests/unit/operators/reuse.h"

namespace delassus::laws::kernels_test {
namespace {

TEST(Kernels, GiveTheNumbersOfTheDefinition) {
  for (const char* family : {"generic", "chain", "random_tree", "several_trees", "joint_friction", "four_bar", "block_damping", "massless"})
    for (const Index n : {2, 4}) {
      const Case c = make_case(family, n, 1);
      EXPECT_EQ(kernel_wrong(c), "");
      EXPECT_EQ(kernel_wrong(with_partial_blocks(c, static_cast<std::uint64_t>(n))), "");
    }
  EXPECT_EQ(kernel_wrong(without_freedoms()), "");
  EXPECT_EQ(kernel_wrong(rows_on_a_free_joint()), "");
  EXPECT_EQ(kernel_wrong(make_case("no_rows", 4, 1)), "");
}

}  // namespace
}  // namespace delassus::laws::kernels_test
