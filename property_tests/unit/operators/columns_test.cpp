// What a solve of several columns reports, and that columns in lanes do not know of each other.
#include <gtest/gtest.h>

#include <cstring>

#include "algorithms/errors/status.h"
#include "algorithms/kit/columns.h"
#include "algorithms/operators/ladder.h"
#include "algorithms/operators/proximal.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/laws/route.h"

namespace delassus::columns_test {
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

struct Solved {
  MatrixX<double> f;
  std::array<Report, lane_count> reports;
};

template <class Op> Solved together(const Op& op, const MatrixX<double>& a, Accuracy wanted) {
  Workspace<double> w(op.workspace(a.cols()));
  w.fill(std::numeric_limits<double>::quiet_NaN());
  Solved s{MatrixX<double>::Constant(a.rows(), a.cols(), 0.75), {}};
  EXPECT_TRUE(op.solve_together(a, s.f, wanted, s.reports, w.data()));
  return s;
}

bool same_bits(const MatrixX<double>& x, const MatrixX<double>& y) {
  return std::memcmp(x.data(), y.data(), static_cast<std::size_t>(x.size()) * sizeof(double)) == 0;
}

/// A column beside others, beside zeros, beside one that is no number; and what it says when it goes alone.
template <class Op> void expect_each_for_itself(const Problem<double>& p, const Damping<double>& d, const char* of) {
  Op op;
  op.analyze(p.structure);
  ASSERT_TRUE(op.update(p, d).ok()) << of;
  const Index m = p.structure->rows;
  MatrixX<double> a = laws::vectors<double>(m, 7, 5);
  a.col(1).setZero();
  a.col(2) *= 0x1p-300;
  a.col(3) *= 0x1p200;
  a.col(4) = VectorX<double>::Unit(m, m - 1);
  for (const Accuracy wanted : {Accuracy::full(), Accuracy{1e-6}, Accuracy::fastest(), Accuracy{0, 1}}) {
    const Solved all = together(op, a, wanted);
    MatrixX<double> others = a;
    others.rightCols(3).setConstant(std::numeric_limits<double>::quiet_NaN());
    others.col(0).setZero();
    const Solved beside = together(op, others, wanted);
    for (const Index c : {1, 2, 3}) {
      EXPECT_TRUE(same_bits(all.f.col(c), beside.f.col(c))) << of << ", column " << c;
      EXPECT_EQ(all.reports[c].status, beside.reports[c].status) << of << ", column " << c;
    }
    for (const Index c : {4, 5, 6}) EXPECT_EQ(beside.reports[c].status, Status::not_finite) << of;
    Workspace<double> w(op.workspace(1));
    for (Index c = 0; c < a.cols(); ++c) {
      MatrixX<double> f(m, 1);
      const Report alone = op.solve(a.col(c), f, wanted, w);
      EXPECT_EQ(all.reports[c].ok(), alone.ok()) << of << ", column " << c << ", wanted " << wanted.error << ": " << all.reports[c].iterations << " and " << alone.iterations << " steps";
      EXPECT_LE(std::abs(all.reports[c].iterations - alone.iterations), 1) << of << ", column " << c;
      EXPECT_EQ(all.reports[c].error_bound < 0, alone.error_bound < 0) << of << ", column " << c;
    }
  }
}

TEST(Columns, InLanesEachForItself) {
  for (const char* family : {"humanoid", "ring", "chain"}) {
    const Problem<double> p = generators::build(generators::find_family(family).make(9, 1)).problem;
    const auto d = Damping<double>::uniform(p.structure->rows, 0x1p-10);
    expect_each_for_itself<LcabaRefined<double>>(p, d, "lcaba_refined");
    expect_each_for_itself<Proximal<double>>(p, d, "proximal");
  }
}
}  // namespace
}  // namespace delassus::columns_test
