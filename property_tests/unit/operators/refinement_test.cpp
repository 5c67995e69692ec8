// Refinement against a model of it.
#include <gtest/gtest.h>

#include "property_tests/unit/operators/refinement_model.h"
#include "property_tests/unit/operators/reuse.h"

namespace delassus::laws::refinement_test {
namespace {

TEST(Refinement, DoesWhatItsHeaderSays) {
  for (const char* family : {"generic", "chain", "several_trees", "joint_friction", "block_damping", "random_tree", "hard"})
    for (const Index n : {2, 3}) EXPECT_EQ(refinement_wrong(make_case(family, n, 1)), "");
  EXPECT_EQ(refinement_wrong(make_case("chain", 12, 1)), "");
  EXPECT_EQ(refinement_wrong(without_freedoms()), "");
  for (const Index hard : {0, 2}) EXPECT_EQ(refinement_wrong(three_rows_on_one_freedom(hard)), "");
  EXPECT_EQ(stray_motion_wrong(), "");
  EXPECT_EQ(factored_mass_wrong(), "");
  EXPECT_EQ(refinement_wrong(with_partial_blocks(make_case("generic", 4, 1), 1)), "");
}

}  // namespace
}  // namespace delassus::laws::refinement_test
