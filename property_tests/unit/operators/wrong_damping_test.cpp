// A damping that cannot be right is bad_damping on every operator, in time that grows with the rows.
#include <gtest/gtest.h>

#include <chrono>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/wrong_damping.h"

namespace delassus::wrong_damping_test {
namespace {

TEST(WrongDamping, IsSaidByEveryOperator) {
  for (const OperatorRow& row : operators()) EXPECT_EQ(wrong_damping_taken(row), "");
}

template <class T> Report updated(const OperatorRow& row, Damping<double> d) {
  Structure s;
  s.add_body(ground, 3);
  s.add_link_constraint(2, {0});
  s.add_link_constraint(1, {0});
  Problem<double> p(std::make_shared<const Structure>(s));
  p.H[0].setIdentity();
  for (Index k = 0; k < 3; ++k) p.S[static_cast<std::size_t>(k)][k] = p.K[static_cast<std::size_t>(k)][k] = 1;
  const auto op = row.make<T>();
  op->analyze(p.structure);
  return op->update(p.cast<T>(), d.cast<T>());
}

template <class T> void expect_in_scalar(const OperatorRow& row) {
  if (std::get<Maker<T>>(row.makers) == nullptr) return;
  Damping<double> negative = Damping<double>::uniform(3, 1), indefinite = negative, twice = negative;
  negative.diagonal[2] = -1;
  indefinite.diagonal = twice.diagonal = {0, 0, 1};
  MatrixX<double> B(2, 2);
  B << 1, 2, 2, 1;
  indefinite.blocks.push_back({0, B});
  B << 2, 1, 1, 2;
  twice.blocks.push_back({0, B});
  EXPECT_TRUE(updated<T>(row, twice).ok()) << row.name;
  twice.diagonal[1] = 1;
  const auto expect = [&](const Report& r, Index where) {
    EXPECT_TRUE(r.status == Status::bad_damping && r.where == where && r.at_row()) << row.name << ": " << name(r.status) << " at " << r.where;
  };
  expect(updated<T>(row, twice), 1);
  if (std::is_same_v<T, PrimeField>) return;  // not ordered
  expect(updated<T>(row, negative), 2);
  expect(updated<T>(row, indefinite), 0);
}

TEST(WrongDamping, IsSaidInEveryScalar) {
  for (const OperatorRow& row : operators()) {
    expect_in_scalar<float>(row);
    expect_in_scalar<Quad>(row);
    expect_in_scalar<Counted>(row);
    expect_in_scalar<Rational>(row);
    expect_in_scalar<PrimeField>(row);
  }
}

/// Seconds of the sizes and the numbers of a damping in n blocks, the lowest of five.
double seconds(Index n) {
  Structure s;
  s.add_body(ground, 6);
  Damping<double> d = Damping<double>::uniform(3 * n, 0);
  for (Index e = 0; e < n; ++e) {
    s.add_link_constraint(3, {0});
    d.blocks.push_back({3 * e, MatrixX<double>::Identity(3, 3)});
  }
  std::vector<double> scratch(9);
  double lowest = 1e9;
  for (int k = 0; k < 5; ++k) {
    const auto start = std::chrono::steady_clock::now();
    d.check_sizes(s);
    EXPECT_TRUE(d.judged(scratch).ok());
    lowest = std::min(lowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return lowest;
}

TEST(WrongDamping, IsLookedForInLinearTime) {
  const double ratio = seconds(32000) / seconds(1000);
  EXPECT_LT(ratio, 32 * 8) << "32 times the blocks; quadratic: 1024";
}

}  // namespace
}  // namespace delassus::wrong_damping_test
