// SymmetricTiles against its definition: sizes around whole tiles, in double, float and rational numbers; and coupled_rows against
// elimination in yes and no.
#include <gtest/gtest.h>

#include "algorithms/factors/symmetric_tiles.h"
#include "algorithms/kit/test_scalars.h"
#include "algorithms/operators/operator.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::symmetric_tiles_test {
namespace {

/// Whole numbers, so that sums are exact in any order and any scalar. Rows sum to at most 5 n beside a diagonal of 12 n − 5 at
/// least: κ ≤ (17 n + 5)/(7 n − 5) < 4 from n = 3 on.
template <class T> MatrixX<T> whole_numbers(Index n) {
  MatrixX<T> A(n, n);
  for (Index s = 0; s < n; ++s)
    for (Index r = s; r < n; ++r) A(r, s) = A(s, r) = T(static_cast<int>((7 * r + 13 * s + r * s) % 11 - 5 + (r == s ? 12 * n : 0)));
  return A;
}

template <class T> MatrixX<T> lower(const MatrixX<T>& A) {
  MatrixX<T> L = A;
  for (Index s = 0; s < A.cols(); ++s)
    for (Index r = 0; r < s; ++r) L(r, s) = ScalarTraits<T>::nan();  // must not be read
  return L;
}

/// A x, or A⁻¹x, of x in whole tiles; what is around them is NaN.
template <class T> VectorX<T> answer(const SymmetricTiles<T>& A, const VectorX<T>& x, bool solve) {
  Workspace<T> work(2 * padded(x.size()));
  work.fill(ScalarTraits<T>::nan());
  T *const in = work.data(), *const out = in + padded(x.size());
  VectorX<T> y = VectorX<T>::Constant(x.size() + 1, T(77));
  A.load(x.data(), in);
  if (solve) A.solve(in);
  else A.multiply(in, out);
  A.store(solve ? in : out, y.data());
  EXPECT_TRUE(y[x.size()] == T(77)) << "beyond the last row";
  return y.head(x.size());
}

template <class T> VectorX<T> numbers(Index n) {
  VectorX<T> x(n);
  for (Index r = 0; r < n; ++r) x[r] = T(static_cast<int>(5 * r % 9 - 4));
  return x;
}

template <class T> VectorX<T> product(const MatrixX<T>& A, const VectorX<T>& x) {
  VectorX<T> y(x.size());
  for (Index r = 0; r < x.size(); ++r) {
    y[r] = T(0);
    for (Index s = 0; s < x.size(); ++s) y[r] += A(r, s) * x[s];
  }
  return y;
}

template <class T> class Tiles : public testing::Test {};
using Scalars = testing::Types<double, float, Rational>;
TYPED_TEST_SUITE(Tiles, Scalars);

constexpr Index sizes[] = {0, 1, 3, 7, 8, 9, 12, 16, 23, 24, 41};

TYPED_TEST(Tiles, ProductsOfWholeNumbersAreExact) {
  using T = TypeParam;
  for (const Index n : sizes) {
    MatrixX<T> A = whole_numbers<T>(n);
    const VectorX<T> x = numbers<T>(n);
    SymmetricTiles<T> tiles;
    tiles.analyze(n);
    tiles.assign(lower(A));
    EXPECT_TRUE(answer(tiles, x, false) == product(A, x)) << n;
    std::vector<Index> off;
    for (Index s = 0; s < n; s += 5) {
      for (Index r = s; r < std::min(n, s + 10); r += 3) {
        tiles.add(r, s, T(3));
        A(r, s) += T(3);
        if (r != s) A(s, r) += T(3);
      }
      if (s + 1 < n) off.push_back(s + 1);
    }
    EXPECT_TRUE(answer(tiles, x, false) == product(A, x)) << n << ", added to";
    for (const Index r : off) A.row(r).setConstant(T(0)), A.col(r).setConstant(T(0));
    tiles.cut(off);
    EXPECT_TRUE(answer(tiles, x, false) == product(A, x)) << n << ", cut";
  }
}

TYPED_TEST(Tiles, SolvesAreRightToRounding) {
  using T = TypeParam;
  for (const Index n : sizes) {
    const MatrixX<T> A = whole_numbers<T>(n);
    const VectorX<T> x = numbers<T>(n);
    SymmetricTiles<T> tiles;
    tiles.analyze(n);
    tiles.assign(lower(A));
    ASSERT_EQ(tiles.factor(), -1) << n;
    const VectorX<T> found = answer(tiles, product(A, x), true);
    const double bound = 30 * static_cast<double>(n) * unit_roundoff<T> * 4 * 4;  // 30 n eps κ, and |x_r| ≤ 4; equality where eps is 0
    for (Index r = 0; r < n; ++r) EXPECT_LE(std::abs(static_cast<double>(T(found[r] - x[r]))), bound) << n << ", row " << r;
  }
}

TYPED_TEST(Tiles, TheFirstPivotThatIsLostIsNamed) {
  using T = TypeParam;
  for (const Index n : sizes)
    for (Index lost = 0; lost < n; lost += 3) {
      MatrixX<T> A = whole_numbers<T>(n);
      for (Index s = 0; s < n; ++s) A(lost, s) = A(s, lost) = T(0);
      SymmetricTiles<T> tiles;
      tiles.analyze(n);
      tiles.assign(A);
      EXPECT_EQ(tiles.factor(), lost) << n;
    }
}

/// Whether an entry can be other than zero: by the definition of J M⁻¹Jᵀ + R⁻¹, then by elimination. Shape m × m.
MatrixX<int> eliminated(const Structure& s, Index width) {
  const Index m = s.rows, units = (m + width - 1) / width;
  MatrixX<int> J = MatrixX<int>::Zero(m, s.dofs()), own = MatrixX<int>::Zero(m, m), M = MatrixX<int>::Zero(s.dofs(), s.dofs());
  const auto way = [&](Index body, const auto& visit) {
    for (Index i = body; i != ground; i = s.parent[i])
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) visit(k);
  };
  for (const auto& e : s.link_constraints) {
    own.block(e.row, e.row, e.rows, e.rows).setOnes();
    for (const auto& link : e.links) way(link.body, [&](Index k) { J.col(k).segment(e.row, e.rows).setOnes(); });
  }
  for (const auto& e : s.joint_constraints) {
    own.block(e.row, e.row, e.rows, e.rows).setOnes();
    for (Index k = s.first_dof[e.body]; k < s.first_dof[e.body + 1]; ++k) J.col(k).segment(e.row, e.rows).setOnes();
  }
  for (Index i = 0; i < s.bodies(); ++i)
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) way(i, [&](Index l) { M(k, l) = M(l, k) = 1; });
  for (Index k = 0; k < s.dofs(); ++k)  // M⁻¹ is not zero where ways through M lead
    for (Index r = 0; r < s.dofs(); ++r)
      if (M(r, k) != 0) M.row(r) = M.row(r).cwiseMax(M.row(k));
  const MatrixX<int> A = own + J * M * J.transpose();
  MatrixX<int> L = MatrixX<int>::Zero(units, units);
  for (Index c = 0; c < m; ++c)
    for (Index r = 0; r < m; ++r)
      if (A(r, c) != 0) L(r / width, c / width) = 1;
  for (Index c = 0; c < units; ++c)
    for (Index q = c + 1; q < units; ++q)
      for (Index r = q; r < units; ++r)
        if (L(r, c) != 0 && L(q, c) != 0) L(r, q) = 1;
  return L;
}

TEST(CoupledRows, AreThoseOfElimination) {
  for (const auto& family : generators::families())
    for (const Index n : {2, 6, 9}) {
      const auto structure = generators::build(family.make(n, 1)).problem.structure;
      const Structure& s = *structure;
      if (s.rows > 120) continue;
      for (const Index width : {1, 8}) {
        const MatrixX<int> L = eliminated(s, width);
        const Fill fill = coupled_rows(s, width);
        ASSERT_EQ(static_cast<Index>(fill.first.size()), L.cols() + 1) << family.name;
        double entries = 0, squares = 0;
        for (Index c = 0; c < L.cols(); ++c) {
          std::vector<Index> rows;
          for (Index r = c; r < L.rows(); ++r)
            if (r == c || L(r, c) != 0) rows.push_back(r);
          EXPECT_EQ(rows, std::vector<Index>(fill.row.begin() + fill.first[c], fill.row.begin() + fill.first[c + 1])) << family.name << " n=" << n << ", width " << width << ", column " << c;
          entries += static_cast<double>(rows.size()), squares += static_cast<double>(rows.size() * rows.size());
        }
        if (width > 1) continue;
        EXPECT_EQ(fill_sums(s).entries, entries) << family.name << " n=" << n;
        EXPECT_EQ(fill_sums(s).squares, squares) << family.name << " n=" << n;
      }
    }
}

/// Products and solves by tiles that are there alone, on bodies in a row with two constraints at either end.
TEST(CoupledRows, TilesOfTheseAlone) {
  Structure s;
  for (int body = 0; body < 9; ++body) s.add_body(ground, 6);
  for (Index body = 0; body + 1 < 9; ++body) s.add_link_constraint(5, {body, body + 1}), s.add_link_constraint(2, {body});
  const Index m = s.rows;
  const MatrixX<int> L = eliminated(s, 1);
  MatrixX<Rational> A = whole_numbers<Rational>(m);
  for (Index c = 0; c < m; ++c)
    for (Index r = c + 1; r < m; ++r)
      if (L(r, c) == 0) A(r, c) = A(c, r) = Rational(0);
  const MatrixX<double> B = A.unaryExpr([](const Rational& x) { return static_cast<double>(x); });
  SymmetricTiles<Rational> exact;
  SymmetricTiles<double> rounded;
  exact.analyze(m, coupled_rows(s, exact.width));
  rounded.analyze(m, coupled_rows(s, rounded.width));
  SymmetricTiles<double> all;
  all.analyze(m);
  EXPECT_LT(rounded.bytes(), all.bytes());
  MatrixX<double> cleared = MatrixX<double>::Ones(m, m);
  rounded.clear(cleared);
  EXPECT_TRUE(cleared.cwiseProduct(B).isZero(0)) << "zeros where A is not";
  EXPECT_EQ(cleared(m - 1, 0), 1) << "nothing is touched elsewhere";
  exact.assign(A);
  rounded.assign(B);
  const VectorX<Rational> x = numbers<Rational>(m);
  const VectorX<double> y = numbers<double>(m);
  EXPECT_TRUE(answer(exact, x, false) == product(A, x));
  EXPECT_TRUE(answer(rounded, y, false) == product(B, y));
  ASSERT_EQ(exact.factor(), -1);
  ASSERT_EQ(rounded.factor(), -1);
  EXPECT_TRUE(answer(exact, product(A, x), true) == x);
  EXPECT_LE((answer(rounded, product(B, y), true) - y).cwiseAbs().maxCoeff(), 30 * static_cast<double>(m) * unit_roundoff<double> * 4 * 4);
}

}  // namespace
}  // namespace delassus::symmetric_tiles_test
