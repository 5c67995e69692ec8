// The verdict itself: what counts as equal, as too large, and as nonsense.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace delassus::laws::verdict_test {
namespace {

constexpr double eps = unit_roundoff<double>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

MatrixX<Quad> column(std::initializer_list<double> values) {
  MatrixX<Quad> x(static_cast<Index>(values.size()), 1);
  Index r = 0;
  for (const double v : values) x(r++, 0) = Quad(v);
  return x;
}

TEST(Verdict, RatioIsErrorOverEpsTimesBound) {
  const Verdict v = judge(column({2 * eps, -29 * eps}), column({1, 1}), eps, "bound");
  EXPECT_EQ(v.ratio, 29);
  EXPECT_EQ(v.row, 1);
  EXPECT_EQ(v.bound, "bound");
  EXPECT_TRUE(v.passed());
  EXPECT_FALSE(judge(column({30 * eps}), column({1}), eps, "bound").passed());
  EXPECT_TRUE(judge(column({30 * eps}), column({2}), eps, "bound").passed());
}

TEST(Verdict, ZeroBoundDemandsExactZero) {
  EXPECT_TRUE(judge(column({0}), column({0}), eps, "bound").passed());
  EXPECT_FALSE(judge(column({1e-300}), column({0}), eps, "bound").passed());
}

TEST(Verdict, ExactScalarsDemandEquality) {
  EXPECT_FALSE(judge(column({1e-300}), column({1}), 0, "bound").passed());
  MatrixX<Rational> x(1, 1), y(1, 1);
  x(0, 0) = Rational(1) / Rational(3);
  y(0, 0) = x(0, 0);
  EXPECT_EQ(judge_equal(x, y).ratio, 0);
  y(0, 0) += Rational(1) / Rational(1e300);
  EXPECT_EQ(judge_equal(x, y).ratio, std::numeric_limits<double>::infinity());
}

TEST(Verdict, NonsenseNeverPasses) {
  EXPECT_FALSE(judge(column({nan}), column({1}), eps, "bound").passed());
  EXPECT_FALSE(judge(column({0}), column({nan}), eps, "bound").passed());
  EXPECT_FALSE(judge(column({0}), column({std::numeric_limits<double>::infinity()}), eps, "bound").passed());
  EXPECT_FALSE(judge(column({0}), column({-1}), eps, "bound").passed());
  EXPECT_FALSE(judge(column({0, 0}), column({1}), eps, "bound").passed());
  EXPECT_FALSE((Verdict{nan, "bound", -1, {}}.passed()));
  EXPECT_FALSE(failure("reason").passed());
}

TEST(Verdict, OneBoundServesEveryColumn) {
  MatrixX<Quad> error = MatrixX<Quad>::Zero(2, 3);
  error(1, 2) = Quad(5 * eps);
  EXPECT_EQ(judge(error, column({1, 1}), eps, "bound").ratio, 5);
}

TEST(Verdict, BitsTellZerosApartAndAcceptNan) {
  MatrixX<double> x(1, 2), y(1, 2);
  x << 0.0, nan;
  y << 0.0, nan;
  EXPECT_TRUE(judge_bits(x, y).passed());
  y(0, 0) = -0.0;
  EXPECT_FALSE(judge_bits(x, y).passed());
  EXPECT_FALSE(judge_bits(x, MatrixX<double>(1, 1)).passed());
}

TEST(Verdict, WorstKeepsTheLargerRatio) {
  EXPECT_EQ(worst(Verdict{1, "a", -1, {}}, Verdict{2, "b", -1, {}}).bound, "b");
  EXPECT_EQ(worst(Verdict{1, "a", -1, {}}, failure("x")).note, "x");
}

}  // namespace
}  // namespace delassus::laws::verdict_test
