// What a solve of several columns reports.
#include <gtest/gtest.h>

#include "algorithms/errors/status.h"
#include "algorithms/kit/columns.h"

namespace delassus {
namespace {

Report report(Status status, Index where, int steps, double size, std::string_view rung) {
  return {.status = status, .where = where, .iterations = steps, .backward_error = size, .error_bound = 2 * size, .error_estimate = 3 * size, .rung = rung, .rungs_tried = steps};
}

void expect_same(const Report& a, const Report& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.where, b.where);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.backward_error, b.backward_error);
  EXPECT_EQ(a.error_bound, b.error_bound);
  EXPECT_EQ(a.error_estimate, b.error_estimate);
  EXPECT_EQ(a.rung, b.rung);
  EXPECT_EQ(a.rungs_tried, b.rungs_tried);
}

TEST(Columns, TheLargerNumbersAndTheFirstThatIsNotOk) {
  const Report good = report(Status::ok, -1, 1, 0.125, "one"), bad = report(Status::inconsistent, 4, 3, 0.5, "three"), lost = report(Status::lost_pivot, 2, 2, 0.25, "");
  expect_same(worse(good, good), good);
  expect_same(worse(good, bad), bad);
  expect_same(worse(bad, good), report(Status::inconsistent, 4, 3, 0.5, "one"));
  expect_same(worse(bad, lost), bad);
  expect_same(worse(lost, bad), report(Status::lost_pivot, 2, 3, 0.5, "three"));
  expect_same(worse({}, {}), {});
}

}  // namespace
}  // namespace delassus
