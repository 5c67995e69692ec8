// Eigenvalues of J M⁻¹Jᵀ by counting: counts equal to the inertia of the matrix itself, over the rational numbers; intervals in
// double judged by the same inertia.
#include "algorithms/dynamics/spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/families.h"
#include "reference/sensitivity.h"

namespace delassus::spectrum_test {
namespace {

// Loops within a tree and between trees, rows of several bodies and rows on joints, massless links, joints of 0 to 6 freedoms,
// rows that depend on others.
constexpr const char* mechanisms[] = {"generic", "random_tree", "comb", "humanoid", "several_trees", "massless", "joint_friction", "redundant", "no_rows", "no_bodies"};

Problem<double> problem(const char* family, std::uint64_t seed) {
  return generators::build(generators::find_family(family).make(generators::find_family(family).exact_size, seed)).problem;
}

MatrixX<Rational> delassus_matrix(const Problem<double>& p) {
  const Problem<Rational> exact = p.cast<Rational>();
  return reference::dense(exact, Damping<Rational>::uniform(p.structure->rows, Rational(0))).A0;
}

// Positive eigenvalues of a symmetric matrix (Sylvester): congruences that take out one row and column, or two where all of the
// diagonal is zero; those two have one eigenvalue of each sign.
Index positive_eigenvalues(MatrixX<Rational> a) {
  Index positive = 0;
  std::vector<Index> left;
  for (Index i = 0; i < a.rows(); ++i) left.push_back(i);
  while (!left.empty()) {
    const auto pivot = std::find_if(left.begin(), left.end(), [&](Index i) { return !(a(i, i) == Rational(0)); });
    if (pivot == left.end()) {
      bool found = false;
      for (std::size_t x = 0; x < left.size() && !found; ++x)
        for (std::size_t y = x + 1; y < left.size() && !found; ++y) {
          const Index i = left[x], j = left[y];
          if (a(i, j) == Rational(0)) continue;
          for (const Index k : left) a(i, k) += a(j, k);  // row and column i take j's: the diagonal is 2 a_ij
          for (const Index k : left) a(k, i) += a(k, j);
          found = true;
        }
      if (!found) return positive;  // the rest is zero
      continue;
    }
    const Index p = *pivot;
    left.erase(pivot);
    if (a(p, p) > Rational(0)) ++positive;
    for (const Index i : left) {
      const Rational l = a(i, p) / a(p, p);
      for (const Index j : left) a(i, j) -= l * a(p, j);
    }
  }
  return positive;
}

Index eigenvalues_above(const MatrixX<Rational>& A0, const Rational& mu) {
  MatrixX<Rational> shifted = A0;
  for (Index i = 0; i < shifted.rows(); ++i) shifted(i, i) -= mu;
  return positive_eigenvalues(shifted);
}

TEST(Spectrum, counts_are_the_inertia_of_the_matrix) {
  int between = 0;
  for (const char* family : mechanisms) {
    const Problem<double> p = problem(family, 3);
    const MatrixX<Rational> A0 = delassus_matrix(p);
    Spectrum<Rational> of(p.structure);
    ASSERT_TRUE(of.update(p.cast<Rational>()).ok()) << family;
    double trace = 0;
    for (Index r = 0; r < A0.rows(); ++r) trace += static_cast<double>(A0(r, r));
    if (trace == 0) trace = 1;
    for (double mu = 2 * trace; mu > 1e-6 * trace; mu *= 0.37) {
      Index count = -1;
      ASSERT_TRUE(of.count_above(mu, count).ok()) << family << " at " << mu;
      EXPECT_EQ(count, eigenvalues_above(A0, Rational(mu))) << family << " at " << mu;
      if (count > 0 && count < A0.rows()) ++between;
    }
  }
  EXPECT_GT(between, 60);
}

TEST(Spectrum, intervals_hold_the_eigenvalues) {
  int positive = 0, zero = 0;
  for (const char* family : mechanisms)
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Problem<double> p = problem(family, seed);
      const Index m = p.structure->rows;
      if (m == 0) continue;
      const MatrixX<Rational> A0 = delassus_matrix(p);
      const reference::Sensitivity sensitivity(p, Damping<double>::uniform(m, 0.0));
      const double bound = sensitivity.apply_sensitivity(VectorX<double>::Ones(m)).maxCoeff();  // of ‖δΛ⁻¹‖_∞, and so of every eigenvalue
      const double slack = 30 * unit_roundoff<double> * bound;
      Spectrum<double> of(p.structure);
      ASSERT_TRUE(of.update(p).ok()) << family;
      for (const Index k : {Index{0}, m / 2, m - 1}) {
        Spectrum<double>::Interval found;
        ASSERT_TRUE(of.eigenvalue(k, 1e-6, found).ok()) << family << " " << seed;
        EXPECT_TRUE(found.lower == 0 || found.upper <= (1 + 1e-6) * found.lower) << family << " " << seed << " " << k;
        EXPECT_LE(eigenvalues_above(A0, Rational(found.upper + slack)), k) << family << " " << seed << " " << k << " above " << found.upper;
        if (found.lower > slack) {
          EXPECT_GT(eigenvalues_above(A0, Rational(found.lower - slack)), k) << family << " " << seed << " " << k << " below " << found.lower;
        }
        ++(found.lower > 0 ? positive : zero);
      }
      Spectrum<double>::Interval largest, smallest, first, last;
      ASSERT_TRUE(of.largest(1e-6, largest).ok() && of.smallest(1e-6, smallest).ok() && of.eigenvalue(0, 1e-6, first).ok() && of.eigenvalue(m - 1, 1e-6, last).ok());
      EXPECT_EQ(largest.upper, first.upper);
      EXPECT_EQ(smallest.upper, last.upper);
    }
  EXPECT_GT(positive, 30);
  EXPECT_GT(zero, 5);  // rows that depend on others
}

/// A point of one kilogram held in three directions: Λ⁻¹ = 1.
TEST(Spectrum, an_eigenvalue_itself_is_no_place_to_count) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 6);
  s->add_link_constraint(3, {0});
  Problem<Rational> p(s);
  for (int c = 0; c < 6; ++c) p.S[c][c] = p.H[0](c, c) = Rational(1);
  for (int r = 0; r < 3; ++r) p.K[r][3 + r] = Rational(1);
  Spectrum<Rational> of(s);
  ASSERT_TRUE(of.update(p).ok());
  Index count = -1;
  EXPECT_EQ(of.count_above(1, count).status, Status::lost_pivot);
  ASSERT_TRUE(of.count_above(0.75, count).ok());
  EXPECT_EQ(count, 3);
  ASSERT_TRUE(of.count_above(1.25, count).ok());
  EXPECT_EQ(count, 0);
  Spectrum<Rational>::Interval found;
  ASSERT_TRUE(of.largest(1e-3, found).ok());
  EXPECT_LT(found.lower, 1);
  EXPECT_GT(found.upper, 1);
  EXPECT_LE(found.upper, 1.001 * found.lower);
}

TEST(Spectrum, says_where_the_inertia_is_singular_and_what_it_cannot_be_asked) {
  auto s = std::make_shared<Structure>();
  s->add_body(s->add_body(ground, 1), 1);
  s->add_link_constraint(1, {1});
  Problem<double> p(s);
  Spectrum<double> of(s);
  Index count = 0;
  Spectrum<double>::Interval found;
  EXPECT_THROW(static_cast<void>(of.count_above(1, count)), std::logic_error);
  EXPECT_EQ(of.update(p).status, Status::lost_pivot);
  EXPECT_EQ(of.count_above(1, count).status, Status::lost_pivot);
  EXPECT_EQ(of.largest(1e-3, found).status, Status::lost_pivot);
  EXPECT_THROW(static_cast<void>(of.count_above(0, count)), std::logic_error);
  EXPECT_THROW(static_cast<void>(of.eigenvalue(1, 1e-3, found)), std::logic_error);
  EXPECT_THROW(static_cast<void>(of.eigenvalue(0, 0, found)), std::logic_error);
  EXPECT_THROW(Spectrum<double>(nullptr), std::logic_error);
}

}  // namespace
}  // namespace delassus::spectrum_test
