// Steps, outcomes and units of conjugate gradients.
#include <gtest/gtest.h>

#include "property_tests/unit/operators/krylov.h"

namespace delassus::laws::krylov_test {
namespace {

TEST(Krylov, KnownSpectra) {
  for (const std::string_view name : {"cg", "cg_preconditioned"}) EXPECT_EQ(krylov_wrong(find_operator(name)), "");
}

}  // namespace
}  // namespace delassus::laws::krylov_test
