// The oracle of small contact problems: exact roots, all solutions, and solvers held against it.
#include <gtest/gtest.h>

#include <numbers>

#include "generators/random.h"
#include "generators/contact_families.h"
#include "reference/contact_oracle.h"
#include "reference/contact_residual.h"
#include "simulation/solvers.h"

namespace delassus::contact_oracle_test {
namespace {

using namespace simulation;
using reference::ContactMode;
using reference::Polynomial;

Polynomial linear(int root) { return Polynomial({Rational(-root), Rational(1)}); }

// 19 digits behind the point.
Rational decimal(const char* digits) { return Rational(mpq_class(mpz_class(digits))) / Rational(mpq_class(mpz_class("10000000000000000000"))); }

TEST(Polynomials, RootsAreIsolatedExactly) {
  const Polynomial p = linear(1) * linear(1) * linear(2) * linear(-3) * Polynomial({Rational(1), Rational(0), Rational(1)}) * Polynomial({Rational(-2), Rational(0), Rational(1)});
  const auto roots = reference::real_roots(p);  // −3, −√2, 1, √2, 2
  ASSERT_EQ(roots.size(), 5u);
  const double expected[5] = {-3, -std::numbers::sqrt2, 1, std::numbers::sqrt2, 2};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(static_cast<double>(roots[k].within(Rational(0x1p-60))), expected[k], 1e-15);
  EXPECT_EQ(roots[1].sign(Polynomial({Rational(-2), Rational(0), Rational(1)}) * linear(7)), 0);  // exactly zero at −√2
  EXPECT_EQ(roots[3].sign(Polynomial({-decimal("14142135623730950488"), Rational(1)})), 1);
  EXPECT_EQ(roots[3].sign(Polynomial({-decimal("14142135623730950489"), Rational(1)})), -1);
  EXPECT_TRUE(reference::real_roots(Polynomial({Rational(1), Rational(0), Rational(1)})).empty());
}

// 1e-6 apart: Wilkinson's polynomial of two near roots.
TEST(Polynomials, NearRootsAreTold) {
  const Rational near = Rational(mpq_class("1000001/1000000"));
  EXPECT_EQ(reference::real_roots(linear(1) * Polynomial({-near, Rational(1)})).size(), 2u);
}

ContactProblem<double> single(const Matrix3<double>& G, const Vector3<double>& b, double mu) {
  ContactProblem<double> p;
  p.resize(3);
  append_contact(p, mu);
  p.G = G;
  p.free_velocity = b;
  return p;
}

double residual(const ContactProblem<double>& p, const VectorX<double>& lambda) {
  return reference::contact_residual(p, reference::DenseContact<Quad>(p), lambda, FrictionLaw::exact).natural;
}

Matrix3<double> random_matrix(generators::Random& random) {
  Matrix3<double> B;
  for (Index k = 0; k < 9; ++k) B.data()[k] = random.integer(-16, 16) / 8.0;
  return B * B.transpose() + Matrix3<double>::Identity() / 16;
}

// The slip directions of one contact counted on a fine circle: changes of sign of d × u_t where λ_n > 0 and d·u_t > 0.
int slips_on_a_circle(const Matrix3<double>& G, const Vector3<double>& b, double mu) {
  int count = 0;
  double before = 0;
  bool valid_before = false;
  const int n = 8000;
  for (int k = 0; k <= n; ++k) {
    const double a = 2 * std::numbers::pi * (k + 0.37) / n, c = std::cos(a), s = std::sin(a);
    const double normal = -b[0] / (G(0, 0) - mu * (G(0, 1) * c + G(0, 2) * s));
    const Vector3<double> u = G * Vector3<double>(normal, -mu * normal * c, -mu * normal * s) + b;
    const double across = c * u[2] - s * u[1];
    const bool valid = normal > 0 && c * u[1] + s * u[2] > 0;
    count += valid && valid_before && (across > 0) != (before > 0);
    before = across;
    valid_before = valid;
  }
  return count;
}

TEST(ContactOracle, OneContactHasTheSolutionsOfACircle) {
  generators::Random random(1);
  int seen[4] = {};
  for (int k = 0; k < 100; ++k) {
    const Matrix3<double> G = random_matrix(random);
    const Vector3<double> b(random.integer(-16, 4) / 8.0, random.integer(-16, 16) / 8.0, random.integer(-16, 16) / 8.0);
    const double mu = random.integer(1, 12) / 8.0;
    const auto found = reference::contact_solutions(single(G, b, mu));
    EXPECT_TRUE(found.complete() || b[0] == 0);  // a contact that rests may be pressed into slipping by any impulse
    EXPECT_GE(found.all.size(), 1u) << "G is regular: a solution exists";
    int slips = 0;
    for (const auto& s : found.all) {
      ++seen[static_cast<int>(s.modes[0])];
      slips += s.modes[0] == ContactMode::slip;
      EXPECT_LT(residual(single(G, b, mu), s.lambda), 1e-13 * (G.norm() * s.lambda.norm() + b.norm()));
    }
    if (found.complete()) {
      EXPECT_EQ(slips, slips_on_a_circle(G, b, mu)) << "case " << k;
    }
  }
  EXPECT_GT(seen[0], 3);
  EXPECT_GT(seen[1], 3);
  EXPECT_GT(seen[2], 15);
}

// Painlevé's rod in the plane: G_nn < μ G_nt, and the free velocity opens: open, slipping and sticking are all solutions.
TEST(ContactOracle, PainlevesRodHasThreeSolutions) {
  ContactProblem<double> p;
  p.resize(2);
  append_contact(p, 1.0, 1);
  p.G.resize(2, 2);
  p.G << 1, 2, 2, 5;
  p.free_velocity << 0.25, 1;  // stick: λ = −G⁻¹b = (0.75, −0.5); slip: λ_n = −0.25/(1 − 2)
  const auto found = reference::contact_solutions(p);
  EXPECT_TRUE(found.complete());
  ASSERT_EQ(found.all.size(), 3u);
  for (const auto& s : found.all) EXPECT_LT(residual(p, s.lambda), 1e-15);
}

TEST(ContactOracle, TwoContactsThatSlipAreCertified) {
  int slips = 0, complete = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto p = pile({.bodies = 2, .contacts = 2, .friction = 0.25, .seed = seed});
    const auto found = reference::contact_solutions(p);
    complete += found.complete();
    for (const auto& s : found.all) {
      slips += s.modes[0] == ContactMode::slip && s.modes[1] == ContactMode::slip;
      EXPECT_LT(residual(p, s.lambda), 1e-9 * (1 + s.lambda.norm() * reference::DenseContact<double>(p).G.norm())) << seed;
    }
    for (const auto& why : found.undecided) std::printf("  seed %d undecided: %s\n", static_cast<int>(seed), why.c_str());
  }
  EXPECT_GT(slips, 2);
  EXPECT_GT(complete, 9);
}

// Where the oracle knows all solutions, a solver's is one of them; where there is none, no solver claims one.
TEST(ContactOracle, SolversFindOneOfItsSolutions) {
  int judged = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const auto p = pile({.bodies = 2, .contacts = 1 + static_cast<Index>(seed % 2), .friction = 1, .seed = 100 + seed});
    const auto found = reference::contact_solutions(p);
    if (!found.complete()) continue;
    for (const SolverRow& row : solvers()) {
      const auto solver = row.make();
      if (!solver->supports(p)) continue;
      solver->analyze(p);
      VectorX<double> lambda;
      const auto report = solver->solve(p, {1e-11, 50000}, lambda);
      if (!report.ok()) continue;
      ++judged;
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& s : found.all) nearest = std::min(nearest, (s.lambda - lambda).norm());
      const double weakest = reference::DenseContact<double>(p).G.selfadjointView<Eigen::Lower>().eigenvalues()[0];
      EXPECT_LT(nearest, 1e-10 * (1 + 100 / weakest)) << row.name << " seed " << seed << " of " << found.all.size() << " solutions";
    }
  }
  EXPECT_GT(judged, 25);
}

}  // namespace
}  // namespace delassus::contact_oracle_test
