// Tableaus of Runge and Kutta: conditions of order, stability, and what a wrong coefficient does.
#include <gtest/gtest.h>

#include <complex>

#include "property_tests/unit/simulation/stepping_scenes.h"
#include "simulation/runge_kutta.h"

namespace delassus::tableaus_test {
namespace {

using namespace stepping;

constexpr double eps = 0x1p-53;

/// Largest |Σ …  − 1/γ| of the conditions to an order ≤ 4, relative to the terms that are summed, in units of rounding; weights `b`.
double off_order(const Tableau& t, const double* b, int order) {
  using Row = std::array<long double, 7>;
  const int s = t.stages;
  const auto times = [&](const Row& x) {
    Row out{};
    for (int i = 0; i < s; ++i)
      for (int j = 0; j < s; ++j) out[i] += t.a[i][j] * x[j];
    return out;
  };
  const auto product = [](Row x, const Row& y) {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= y[k];
    return x;
  };
  Row one{};
  one.fill(1);
  const Row c = times(one), cc = product(c, c), Ac = times(c);
  const std::vector<std::tuple<int, Row, int>> conditions{{1, one, 1}, {2, c, 2}, {3, cc, 3}, {3, Ac, 6}, {4, product(cc, c), 4}, {4, product(c, Ac), 8}, {4, times(cc), 12}, {4, times(Ac), 24}};
  double worst = 0;
  for (const auto& [of, x, gamma] : conditions) {
    if (of > order) continue;
    long double sum = 0, size = 0;
    for (int i = 0; i < s; ++i) sum += b[i] * x[i], size += std::abs(b[i] * x[i]);
    worst = std::max(worst, static_cast<double>(std::abs(sum - 1.0L / gamma) / size) / eps);
  }
  return worst;
}

/// To rounding of the coefficients; any of them off by 1e-12 is seen.
TEST(Tableaus, fulfil_the_conditions_of_their_order) {
  for (const auto& [tableau, order] : {std::pair{&classical(), 4}, {&dormand_prince(), 4}, {&implicit_midpoint(), 2}, {&sdirk4(), 4}}) {
    EXPECT_LT(off_order(*tableau, tableau->b, order), 30);
    double lower[7];
    for (int k = 0; k < 7; ++k) lower[k] = tableau->b[k] - tableau->e[k];
    EXPECT_LT(off_order(*tableau, lower, tableau->estimate), 30);
    for (int i = 0; i < tableau->stages; ++i) {
      Tableau wrong = *tableau;
      wrong.b[i] += 1e-12;
      EXPECT_GT(off_order(wrong, wrong.b, order), 300) << i;
      for (int j = 0; j <= i; ++j) {
        if (tableau->a[i][j] == 0 || tableau->b[i] == 0) continue;
        wrong = *tableau;
        wrong.a[i][j] += 1e-12;
        EXPECT_GT(off_order(wrong, wrong.b, order), 100) << i << j;
      }
    }
  }
  const Tableau& t = sdirk4();
  for (int j = 0; j < t.stages; ++j) {
    EXPECT_EQ(t.a[t.stages - 1][j], t.b[j]) << "its last stage is its end";
    EXPECT_EQ(t.a[j][j], 0.25);
  }
}

/// y₁/y₀ of y' = z y, h = 1.
std::complex<double> growth(const Tableau& t, std::complex<double> z) {
  std::array<std::complex<double>, 7> k{};
  std::complex<double> y = 1;
  for (int i = 0; i < t.stages; ++i) {
    std::complex<double> at = 1;
    for (int j = 0; j < i; ++j) at += t.a[i][j] * k[j];
    k[i] = z * at / (1.0 - z * t.a[i][i]);
    y += t.b[i] * k[i];
  }
  return y;
}

/// On the imaginary axis |R| ≤ 1, its poles are to the right of it: so to the left of it. R(∞) = 0 of sdirk4; |R| = 1 of the midpoint.
TEST(Tableaus, stability_of_the_implicit_ones) {
  for (double y = 1e-3; y < 1e9; y *= 1.05) {
    EXPECT_LE(std::abs(growth(sdirk4(), {0, y})), 1 + 100 * eps * std::max(1.0, y * 1e-3)) << y;
    EXPECT_NEAR(std::abs(growth(implicit_midpoint(), {0, y})), 1, 10 * eps) << y;
  }
  for (const std::complex<double> z : {std::complex<double>{-1e6, 0}, {0, 1e6}, {-1e6, 1e6}}) EXPECT_LT(std::abs(growth(sdirk4(), z)), 1e-5);
  EXPECT_GT(std::abs(growth(classical(), {0, 3})), 1) << "the judge sees what is not stable";
}

/// A tableau whose weights or coefficients are off shows in the order that is measured: ẍ = −sin x, on one prismatic joint.
double order_measured(const Tableau& tableau) {
  Model m;
  m.add(body("mass", ground, JointType::prismatic, 1, {1, 1, 1}));
  const auto end_of = [&](const Tableau& t, int steps) {
    RungeKutta<double> method(m, t);
    State<double> s;
    s.q = VectorX<double>{{1.5}}, s.nu = VectorX<double>{{0.5}};
    method.start(s);
    for (int k = 0; k < steps; ++k) {
      EXPECT_TRUE(method.attempt(1.0 / steps, [](const State<double>& at, const RungeKutta<double>::Stage&, VectorX<double>& a) {
        a = VectorX<double>{{-std::sin(at.q[0])}};
        return true;
      }));
      method.accept(s);
    }
    return s.q[0];
  };
  const double exact = end_of(dormand_prince(), 400);
  return std::log2(std::abs((end_of(tableau, 20) - exact) / (end_of(tableau, 40) - exact)));
}

TEST(Tableaus, a_wrong_coefficient_is_seen_in_the_order) {
  EXPECT_NEAR(order_measured(implicit_midpoint()), 2, 0.1);
  EXPECT_NEAR(order_measured(sdirk4()), 4, 0.3);
  Tableau weights = sdirk4(), inner = sdirk4(), middle = implicit_midpoint();
  weights.b[2] += 1e-3;
  EXPECT_LT(order_measured(weights), 0.5);
  inner.a[2][0] += 1e-3;
  EXPECT_LT(order_measured(inner), 3.2);
  middle.a[0][0] = 0.55;
  EXPECT_LT(order_measured(middle), 1.5);
}

}  // namespace
}  // namespace delassus::tableaus_test
