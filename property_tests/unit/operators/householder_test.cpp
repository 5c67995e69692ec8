// The kernel of the square-root elimination.
#include <gtest/gtest.h>

#include <random>

#include "algorithms/kit/householder.h"
#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/verdict.h"

namespace delassus::householder_test {
namespace {

using laws::judge;

template <class T> class HouseholderKernel : public testing::Test {};
using Scalars = testing::Types<double, float>;  // with lanes, and without
TYPED_TEST_SUITE(HouseholderKernel, Scalars);

constexpr double fence = 1000;  // what stands behind an array, which must not be read or written

TYPED_TEST(HouseholderKernel, FindsTheLargestEntryWhereverItIs) {
  for (const int count : {1, 5, 8, 9, 16, 24})
    for (int at = 0; at < count; ++at)
      for (const double sign : {1.0, -1.0}) {
        std::vector<TypeParam> v(static_cast<std::size_t>((count + 7) / 8 * 8) + 1, TypeParam(0));
        for (int k = 0; k < count; ++k) v[static_cast<std::size_t>(k)] = TypeParam(k % 2 == 0 ? -0.5 : 0.5 / (k + 1));
        v[static_cast<std::size_t>(at)] = TypeParam(0.75 * sign);
        v.back() = TypeParam(fence);
        EXPECT_EQ(largest_entry(v.data(), count), at) << count;
      }
}

TYPED_TEST(HouseholderKernel, TransposesAndMultipliesRows) {
  using T = TypeParam;
  constexpr int most = 24;
  std::vector<Six<T>> rows(most + 1, Six<T>::zero()), matrix(3, Six<T>::zero());
  for (int r = 0; r <= most; ++r)
    for (int c = 0; c < 6; ++c) rows[static_cast<std::size_t>(r)].v[c] = T(7 * r + c + 1);
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 6; ++c) matrix[static_cast<std::size_t>(k)].v[c] = T((k + c) % 4 - 1.5);
  for (int count = 1; count <= most; ++count) {
    const Index stride = (count + 7) / 8 * 8;
    std::vector<T> x(static_cast<std::size_t>(6 * stride) + 8, T(fence)), y = x;
    transpose(rows.data(), count, x.data(), stride);
    multiply(rows.data(), count, matrix.data(), 3, y.data(), stride);
    for (Index r = 0; r < stride; ++r) {
      const Six<T>& row = rows[static_cast<std::size_t>(r)];
      for (int c = 0; c < 6; ++c) EXPECT_EQ(x[static_cast<std::size_t>(c * stride + r)], r < count ? row[c] : T(0)) << count;
      for (int k = 0; k < 3; ++k) EXPECT_EQ(y[static_cast<std::size_t>(k * stride + r)], r < count ? dot(row, matrix[static_cast<std::size_t>(k)]) : T(0)) << count;
    }
    EXPECT_EQ(x[static_cast<std::size_t>(6 * stride)], T(fence));
    EXPECT_EQ(y[static_cast<std::size_t>(3 * stride)], T(fence));
  }
}

// Its square underflows: nothing is reflected, and nothing of it is left but the entry of the last row.
TYPED_TEST(HouseholderKernel, LeavesATinyColumnAlone) {
  using T = TypeParam;
  const T tiny = std::is_same_v<T, double> ? T(0x1p-600) : T(0x1p-100);
  std::vector<T> column(17, T(fence));
  for (int r = 0; r < 16; ++r) column[static_cast<std::size_t>(r)] = r < 5 ? tiny * T(r + 1) : T(0);
  const Panel<T> panel{column.data(), 16, 1, nullptr, 0, 0};
  const Reflection<T> r = panel.reduce(0, 5);
  EXPECT_EQ(r.pivot, 4);
  EXPECT_EQ(r.beta, T(0));
  EXPECT_EQ(r.left, tiny * T(5));
  for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(column[k], T(0));
  EXPECT_EQ(column[16], T(fence));
}

// A panel of leading columns only, reduced column by column, and what is left of it.
struct Reduction {
  Index stride;
  std::vector<double> columns, beta;
  std::vector<int> lane, pivot;
  MatrixX<double> left;  // row k: the row that reflection k completed, from column lane[k] on

  explicit Reduction(const MatrixX<double>& A)
      : stride((A.rows() + 7) / 8 * 8), columns(static_cast<std::size_t>(stride * A.cols()), 0.0),
        left(MatrixX<double>::Zero(A.cols(), A.cols())) {
    const int width = static_cast<int>(A.cols());
    const Panel<double> panel{columns.data(), stride, width, nullptr, 0, 0};
    double squared[6];
    for (int c = 0; c < width; ++c) {
      lane.push_back(c);
      for (Index r = 0; r < A.rows(); ++r) panel.column(c)[r] = A(r, c);
      squared[c] = A.col(c).squaredNorm();
    }
    for (int k = 0, last = static_cast<int>(A.rows()) - 1; k < width; ++k, --last) {
      panel.bring_longest(k, squared, lane.data());
      const Reflection<double> r = panel.reduce(k, last + 1);
      beta.push_back(r.beta);
      pivot.push_back(r.pivot);
      left(k, lane[k]) = r.left;
      for (int c = k + 1; c < width; ++c) left(k, lane[c]) = panel.take(c, last, squared[c]);
    }
  }
  /// Q times the rows left, column c.
  [[nodiscard]] VectorX<double> restored(Index rows, int c) const {
    VectorX<double> x = VectorX<double>::Zero(stride);
    for (std::size_t k = 0; k < beta.size(); ++k) x[rows - 1 - static_cast<Index>(k)] = left(static_cast<Index>(k), c);
    for (std::size_t k = beta.size(); k-- > 0;) {
      const int last = static_cast<int>(rows) - 1 - static_cast<int>(k);
      std::swap(x[pivot[k]], x[last]);
      reflect(x.data(), columns.data() + static_cast<Index>(k) * stride, beta[k], last + 1);
    }
    return x.head(rows);
  }
};

TEST(Householder, PivotsAreExactWhereNormsAre) {
  MatrixX<double> A(4, 2);
  A << 0, 2, 0, 2, 4, 0, 0, 1;
  const Reduction r(A);
  EXPECT_EQ(r.lane, (std::vector<int>{0, 1}));   // the longer column first
  EXPECT_EQ(r.pivot, (std::vector<int>{2, 0}));  // its largest entry
  EXPECT_EQ(r.left(0, 0), -4);
  EXPECT_EQ(r.left(0, 1), 0);
  EXPECT_EQ(r.left(1, 1), -3);
  EXPECT_EQ(r.left(1, 0), 0);
}

// What is left of an estimated norm must not decide the order: columns that differ in the last rows only.
TEST(Householder, KnowsTheLongerColumnAfterCancellation) {
  MatrixX<double> A(4, 3);
  A << 0x1p30, 0x1p30, 0x1p30, 0, 0x1p-10, 0x1p-9, 0, 0, 0, 0, 0, 0;
  const Reduction r(A);
  EXPECT_EQ(r.lane, (std::vector<int>{0, 2, 1}));
}

TEST(Householder, KeepsAColumnOfZerosAsItIs) {
  MatrixX<double> A = MatrixX<double>::Zero(9, 3);
  A.col(1).setConstant(2);
  const Reduction r(A);
  EXPECT_EQ(r.left(0, 1), -6);
  for (const int k : {1, 2}) EXPECT_EQ(r.beta[k], 0);
  for (const int c : {0, 2}) EXPECT_EQ(r.restored(9, c), A.col(c));
}

TEST(Householder, ANotANumberReachesEveryColumnBehind) {
  MatrixX<double> A = MatrixX<double>::Ones(3, 2);
  A(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(Reduction(A).left(0, 1)));
}

// A = Q (0; R), each row to an accuracy of its own size, whatever the sizes of the others.
TEST(Householder, EveryRowKeepsItsOwnAccuracy) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int draw = 0; draw < 50; ++draw) {
    MatrixX<double> A(11, 4);
    for (Index r = 0; r < 11; ++r)
      for (Index c = 0; c < 4; ++c) A(r, c) = number(engine) * (r % 3 == 2 ? 0x1p40 : r % 3 == 1 ? 0x1p10 : 1);
    const Reduction reduction(A);
    ASSERT_EQ(reduction.beta.size(), 4u);
    MatrixX<Quad> error(11, 4), bound(11, 4);
    for (int c = 0; c < 4; ++c) error.col(c) = reduction.restored(11, c).cast<Quad>() - A.col(c).cast<Quad>();
    for (Index r = 0; r < 11; ++r) bound.row(r).setConstant(Quad(A.row(r).cwiseAbs().maxCoeff()) * Quad(4));
    const auto verdict = judge(error, bound, unit_roundoff<double>, "4 · largest entry of the row");
    EXPECT_TRUE(verdict.passed()) << verdict.ratio << " in row " << verdict.row;
  }
}

}  // namespace
}  // namespace delassus::householder_test
