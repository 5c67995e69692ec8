// What solves (K) once, against the definition.
#include <gtest/gtest.h>

#include "property_tests/laws/known.h"
#include "property_tests/unit/operators/one_solve.h"
#include "property_tests/unit/operators/reuse.h"

namespace delassus::laws::one_solve_test {
namespace {

std::vector<Case> cases() {
  std::vector<Case> all = {with_partial_blocks(make_case("generic", 4, 1), 1), without_freedoms(), rows_on_a_free_joint(), three_rows_on_one_freedom()};
  for (const char* family : {"generic", "chain", "random_tree", "several_trees", "joint_friction", "block_damping", "massless", "redundant", "hard", "hard_redundant",
                             "no_rows"})
    for (const Index n : {2, 4}) all.push_back(make_case(family, n, 1));
  return all;
}

TEST(OneSolve, CappedInverse) {
  for (const Case& c : cases()) EXPECT_EQ(capped_inverse_wrong(c), "");
  EXPECT_EQ(capped_inverse_limits_wrong(), "");
}

TEST(OneSolve, SquareRootFactor) {
  for (const Case& c : cases()) EXPECT_EQ(damped(c) ? square_root_wrong(c) : "", "");
  EXPECT_EQ(square_root_limits_wrong(), "");
  for (const char* family : {"mixed_damping", "mixed_contacts", "stiff_redundant", "unequal_stack", "quadruped_feet"}) EXPECT_EQ(square_root_wrong(make_case(family, 6, 1)), "");
}

TEST(OneSolve, KktElimination) {
  for (const Case& c : cases()) EXPECT_EQ(elimination_wrong(c), "");
}

}  // namespace
}  // namespace delassus::laws::one_solve_test
