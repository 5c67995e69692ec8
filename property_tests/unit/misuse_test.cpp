// Every operator refuses misuse. That the check can fail: property_tests/mutate.py runs it on mutants of the sources.
#include <gtest/gtest.h>

#include "property_tests/misuse.h"

namespace delassus {
namespace {

TEST(Misuse, IsRefusedByEveryOperator) {
  for (const OperatorRow& row : operators()) EXPECT_EQ(misuse_accepted(row), "");
}

}  // namespace
}  // namespace delassus
