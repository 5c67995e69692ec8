// The cones: a projection is what its definition says, and its derivative that of the projection.
#include <gtest/gtest.h>

#include <random>

#include "algorithms/kit/quad.h"
#include "simulation/cones.h"

namespace delassus::simulation::cones_test {
namespace {

struct Case {
  Index rows;
  std::vector<double> mu, x;
};

// Points near and far, aligned and not, with equal, unequal and vanishing coefficients.
std::vector<Case> cases(int count) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<Case> all;
  for (int k = 0; k < count; ++k) {
    Case c{2 + static_cast<Index>(random() % 5), {}, {}};
    const bool equal = random() % 2 == 0;
    const double first = std::exp2(static_cast<double>(random() % 12) - 8);
    for (Index i = 0; i < c.rows; ++i) {
      c.mu.push_back(i == 0 ? 0 : equal ? first : random() % 8 == 0 ? 0 : std::exp2(static_cast<double>(random() % 12) - 8));
      c.x.push_back(random() % 10 == 0 ? 0 : normal(random) * std::exp2(static_cast<double>(random() % 20) - 10));
    }
    all.push_back(c);
  }
  return all;
}

constexpr double eps = 0x1p-53;

double size(const std::vector<double>& x) {
  double s = 0;
  for (const double v : x) s = std::max(s, std::abs(v));
  return s;
}

// λ in K, λ − x in K*, and the two orthogonal: this is the projection, by the theorem of Moreau. Judged in Quad.
TEST(Cones, ProjectionFulfilsMoreau) {
  double worst = 0;
  for (const Case& c : cases(4000)) {
    std::vector<double> y = c.x;
    ConeProjection<double>::project(y.data(), c.mu.data(), c.rows);
    std::vector<Quad> l, d, mu;
    Quad pairing(0);
    for (Index i = 0; i < c.rows; ++i) {
      const auto k = static_cast<std::size_t>(i);
      l.emplace_back(y[k]);
      d.push_back(Quad(y[k]) - Quad(c.x[k]));
      mu.emplace_back(c.mu[k]);
      pairing += l.back() * d.back();
    }
    const double bound = eps * size(c.x);
    worst = std::max(worst, static_cast<double>(cone_defect(l.data(), mu.data(), c.rows)) / bound);
    double reach = 1;  // dual_defect weighs tangents by μ
    for (const double m : c.mu) reach = std::max(reach, m);
    worst = std::max(worst, static_cast<double>(dual_defect(d.data(), mu.data(), c.rows)) / (bound * reach));
    worst = std::max(worst, std::abs(static_cast<double>(pairing)) / (bound * size(c.x)));
  }
  EXPECT_LT(worst, 30);
  RecordProperty("worst", std::to_string(worst));
}

TEST(Cones, ProjectionOfUnequalCoefficientsMeetsThatOfEqualOnes) {
  const double x[3] = {0.3, 2, -1};
  const double equal[3] = {0, 0.5, 0.5}, nearly[3] = {0, 0.5, 0.5 * (1 + 0x1p-40)};
  double a[3], b[3];
  std::copy(x, x + 3, a);
  std::copy(x, x + 3, b);
  ConeProjection<double>::project(a, equal, 3);
  ConeProjection<double>::project(b, nearly, 3);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 4 * 0x1p-40);
}

// Central differences in Quad with a relative step of 2⁻⁴⁰: what they leave out is a third derivative times 2⁻⁸⁰.
TEST(Cones, DerivativeIsThatOfTheProjection) {
  int judged = 0;
  for (const Case& c : cases(500)) {
    std::vector<Quad> x, mu;
    for (const double v : c.x) x.emplace_back(v);
    for (const double v : c.mu) mu.emplace_back(v);
    std::vector<Quad> l = x;
    const auto at = ConeProjection<Quad>::project(l.data(), mu.data(), c.rows);
    std::vector<Quad> d(static_cast<std::size_t>(c.rows * c.rows));
    at.derivative(l.data(), mu.data(), c.rows, d.data());
    const double step = std::max(size(c.x), 1.0) * 0x1p-40;
    for (Index j = 0; j < c.rows; ++j) {
      auto plus = x, minus = x;
      plus[static_cast<std::size_t>(j)] += Quad(step);
      minus[static_cast<std::size_t>(j)] -= Quad(step);
      if (ConeProjection<Quad>::project(plus.data(), mu.data(), c.rows).region != at.region) continue;
      if (ConeProjection<Quad>::project(minus.data(), mu.data(), c.rows).region != at.region) continue;
      ++judged;
      for (Index i = 0; i < c.rows; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double difference = static_cast<double>((plus[k] - minus[k]) / Quad(2 * step));
        EXPECT_NEAR(static_cast<double>(d[static_cast<std::size_t>(j * c.rows + i)]), difference, 1e-9) << "region " << static_cast<int>(at.region);
      }
    }
  }
  EXPECT_GT(judged, 1000);
}

TEST(Cones, DefectsVanishExactlyInside) {
  const double mu[3] = {0, 0.5, 0.5}, inside[3] = {2, 0.6, 0.8}, outside[3] = {1, 3, 4}, below[3] = {-1, 0, 0};
  EXPECT_EQ(cone_defect(inside, mu, 3), 0);
  EXPECT_DOUBLE_EQ(cone_defect(outside, mu, 3), 4.5);
  EXPECT_DOUBLE_EQ(cone_defect(below, mu, 3), 1);
  const double u[3] = {2.5, 3, 4}, v[3] = {1, 3, 4};
  EXPECT_EQ(dual_defect(u, mu, 3), 0);
  EXPECT_DOUBLE_EQ(dual_defect(v, mu, 3), 1.5);
}

}  // namespace
}  // namespace delassus::simulation::cones_test
