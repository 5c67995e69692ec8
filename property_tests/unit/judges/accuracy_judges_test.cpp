// Judges of the accuracy measurements: errors of known perturbations, claims, digits.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "bench/accuracy/accuracy_digest.h"
#include "bench/accuracy/accuracy_truth.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::accuracy::accuracy_judges_test {
namespace {

/// m bodies of mass 1/2^k on sliders along x, each with a row on it: A = diag(2^k) + R⁻¹.
Problem<double> sliders(Index m) {
  Structure s;
  for (Index k = 0; k < m; ++k) {
    s.add_body(ground, 1);
    s.add_link_constraint(1, {k});
  }
  Problem<double> p(std::make_shared<const Structure>(s));
  for (Index k = 0; k < m; ++k) {
    const auto i = static_cast<std::size_t>(k);
    p.S[i][3] = p.K[i][3] = 1;
    p.H[i](3, 3) = std::ldexp(1.0, -static_cast<int>(k));
  }
  return p;
}

TEST(Errors, OfAKnownPerturbation) {
  constexpr double damping = 0.25;
  const Problem<double> p = sliders(2);  // A = diag(1, 2) + 1/4
  VectorX<double> a(2);
  a << 1.25, 4.5;  // λ = (1, 2)
  const Truth truth(p, Damping<double>::uniform(2, damping), a);
  ASSERT_TRUE(truth.known()) << truth.why_not();
  EXPECT_NEAR(truth.largest_eigenvalue(), 2, 0.1);
  EXPECT_NEAR(truth.condition(), 2.25 / 1.25, 0.2);
  VectorX<Quad> lambda(2), nu(2);
  lambda << Quad(1), Quad(2);
  nu << Quad(1), Quad(4);  // M⁻¹Jᵀλ
  const Errors none = truth.errors_of({lambda, {}}), none_either = truth.errors_of({lambda, nu});
  for (const double e : {none.lambda, none.motion, none.energy, none.backward, none_either.motion, none_either.energy}) EXPECT_LT(e, 1e-30);

  const double d = 1e-3;
  lambda[1] += Quad(d);
  // ‖ν‖²_M = 1 + ½ 16 = 9, λᵀa = 10.25; δν = (0, 2d): ½ 4d² = 2d²
  const Errors e = truth.errors_of({lambda, {}});
  const auto expect = [](double x, double expected) { EXPECT_NEAR(x, expected, 1e-6 * expected); };
  expect(e.lambda, d / 2);
  expect(e.motion, d * std::sqrt(2.0 / 9));
  expect(e.energy, d * std::sqrt(damping / 10.25));
  EXPECT_NEAR(e.backward, 2.25 * d / (2.25 * std::sqrt(5.0) + std::hypot(1.25, 4.5)), 0.05 * d);
  const Errors both = truth.errors_of({lambda, nu});  // the motion is right
  EXPECT_LT(both.motion, 1e-30);
  expect(both.energy, d * std::sqrt(damping / 10.25));
  nu[0] += Quad(d);
  const Errors moved = truth.errors_of({lambda, nu});
  expect(moved.motion, d / 3);
  expect(moved.energy, d * std::sqrt((1 + damping) / 10.25));
  lambda[0] = Quad(std::nan(""));
  EXPECT_TRUE(std::isnan(truth.errors_of({lambda, {}}).lambda));
}

TEST(Claims, HoldOnlyWhereEveryErrorIsSmallAndEveryCertificateTrue) {
  const auto table = [](double motion, double lambda, double energy, double bound, double damping = 1e-6) {
    Cell c;
    c.rung = "ladder";
    c.status = "ok";
    c.errors = {lambda, motion, energy, 0};
    c.error_bound = bound;
    Level level;
    level.damping = damping;
    level.cells = {c};
    return std::vector<Table>{{"scene", true, 1, 1, 0, {level}}};
  };
  const auto holds = [&](const std::vector<Table>& t) {
    const std::vector<Claim> made = claims(t, "ladder");
    return made.size() == 1 && made[0].levels == 1 && made[0].holds();
  };
  EXPECT_TRUE(holds(table(0.5 * claimed_motion, 0.5 * claimed_lambda, 1e-16, 2e-16)));
  EXPECT_FALSE(holds(table(2 * claimed_motion, 0, 0, 0)));
  EXPECT_FALSE(holds(table(0, 2 * claimed_lambda, 0, 0)));
  EXPECT_FALSE(holds(table(0, 0, 2e-16, 1e-16))) << "the bound is below the error";
  EXPECT_FALSE(holds(table(0, 0, 0, -1))) << "no bound";
  EXPECT_FALSE(holds(table(std::nan(""), std::nan(""), std::nan(""), -1))) << "no answer is no small error";
  EXPECT_TRUE(std::isinf(claims(table(std::nan(""), 0, 0, 0), "ladder")[0].motion));
  EXPECT_TRUE(holds(table(0, 0, 0, 0, claimed_from)) && holds(table(0, 0, 0, 0, claimed_to)));
  EXPECT_TRUE(claims(table(0, 0, 0, 0, 10 * claimed_to), "ladder").empty());
  EXPECT_TRUE(claims(table(0, 0, 0, 0), "lcaba").empty());
}

TEST(Digits, AreThoseOfTheError) {
  EXPECT_EQ(digits(0), 16);
  EXPECT_NEAR(digits(1e-5), 5, 1e-12);
  EXPECT_EQ(digits(3), 0);
  EXPECT_EQ(digits(1e-40), 16);
}

}  // namespace
}  // namespace delassus::accuracy::accuracy_judges_test
