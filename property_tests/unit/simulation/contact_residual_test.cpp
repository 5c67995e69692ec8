// Two residuals of contact problems that share no line agree; closed forms; and wrong ones are noticed.
#include <gtest/gtest.h>

#include "generators/random.h"
#include "generators/contact_families.h"
#include "reference/contact_residual.h"
#include "simulation/residual.h"

namespace delassus::contact_residual_test {
namespace {

using namespace simulation;
using generators::Random;

// Every cone, unequal coefficients, dampings, targets; λ anywhere.
ContactProblem<double> anything(Random& random) {
  const auto number = [&] { return random.integer(-64, 64) / 16.0; };
  ContactProblem<double> p;
  p.resize(13);
  append(p, Cone::free, 2);
  append(p, Cone::half_line, 2);
  append(p, Cone::box, 2);
  append_contact(p, 0.5);
  append_contact(p, 0.25, 1);
  append(p, Cone::box, 1);
  append(p, Cone::free, 1);
  for (Index r = 7; r < 9; ++r) p.friction[static_cast<std::size_t>(r)] = random.integer(1, 8) / 8.0;
  p.friction[10] = random.integer(0, 8) / 8.0;
  p.friction[11] = p.friction[12] = 0;
  p.low = {0, 0, 0, 0, -1, -2, 0, 0, 0, 0, 0, -std::numeric_limits<double>::infinity(), 0};
  p.high = {0, 0, 0, 0, 1, 0.5, 0, 0, 0, 0, 0, 0.5, 0};
  MatrixX<double> B(13, 9);
  for (Index k = 0; k < B.size(); ++k) B.data()[k] = number();
  p.G = B * B.transpose();
  for (Index r = 0; r < 13; ++r) {
    p.free_velocity[r] = number();
    p.target[r] = number();
    p.R_inverse[static_cast<std::size_t>(r)] = random.integer(0, 3) / 4.0;
  }
  p.law = random.coin() ? FrictionLaw::exact : FrictionLaw::relaxed;
  return p;
}

struct Pair {
  Residuals own;
  reference::ContactResidual other;
  double bound;  // of a velocity that was summed in double
};

// Our own on p, the reference on q, which a defect may have made another.
Pair judged(const ContactProblem<double>& p, const VectorX<double>& lambda, const ContactProblem<double>& q, const VectorX<double>& other) {
  MatrixX<double> A = p.G;
  for (Index r = 0; r < p.rows(); ++r) A(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  const VectorX<double> u = A * lambda + p.free_velocity - p.target, d = A.diagonal();
  const VectorX<double> size = A.cwiseAbs() * lambda.cwiseAbs() + p.free_velocity.cwiseAbs() + p.target.cwiseAbs();
  return {residuals(p, lambda.data(), u.data(), d.data()),
          reference::contact_residual<Quad>(q, reference::DenseContact<Quad>(q), other, q.law), static_cast<double>(p.rows()) * size.maxCoeff()};
}

// error / (eps bound) of the worst of the four; ratios of impulses and energies by the size of λ.
double ratio(const Pair& r, const VectorX<double>& lambda) {
  const double unit = 0x1p-53 * r.bound, impulse = std::max(1.0, lambda.lpNorm<Eigen::Infinity>());
  return std::max({std::abs(r.own.natural - r.other.natural) / unit, std::abs(r.own.penetration - r.other.approach) / unit,
                   std::abs(r.own.cone - r.other.cone) / (0x1p-53 * impulse * 16), std::abs(r.own.complementarity - r.other.work) / (unit * impulse * 4)});
}

VectorX<double> impulses(Random& random, Index m) {
  VectorX<double> lambda(m);
  for (double& x : lambda) x = random.integer(0, 3) == 0 ? 0 : random.integer(-32, 64) / 16.0;
  return lambda;
}

TEST(ContactResidual, TwoThatShareNothingAgree) {
  Random random(3);
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    const auto p = anything(random);
    p.validate();
    const auto lambda = impulses(random, p.rows());
    worst = std::max(worst, ratio(judged(p, lambda, p, lambda), lambda));
  }
  EXPECT_LT(worst, 30);
  RecordProperty("worst", std::to_string(worst));
}

// A sliding block: at rest in the relaxed law, Γ above the plane in the exact one.
TEST(ContactResidual, ClosedForms) {
  ContactProblem<double> p;
  p.resize(3);
  append_contact(p, 0.5);
  p.G = MatrixX<double>::Identity(3, 3) / 2;
  p.free_velocity << -3, 6, 8;
  VectorX<double> lambda(3);
  lambda << 6, -1.8, -2.4;  // u = (0, 5.1, 6.8), Γ = 4.25
  const reference::DenseContact<Quad> dense(p);
  auto r = reference::contact_residual(p, dense, lambda, FrictionLaw::exact);
  EXPECT_LT(r.natural, 1e-15);
  EXPECT_LT(r.work, 1e-14);
  EXPECT_NEAR(r.shift, 4.25, 1e-15);
  r = reference::contact_residual(p, dense, lambda, FrictionLaw::relaxed);
  EXPECT_NEAR(r.approach, 4.25, 1e-15);
  EXPECT_NEAR(r.work, 25.5, 1e-14);  // 1.8 · 5.1 + 2.4 · 6.8
  lambda << -2, 0, 3;
  EXPECT_NEAR(reference::contact_residual(p, dense, lambda, FrictionLaw::exact).cone, 3, 1e-15);
}

TEST(ContactResidual, MomentumIsThatOfTheMotion) {
  const auto p = pile({.bodies = 2, .contacts = 3, .seed = 5});
  const reference::DenseContact<Quad> dense(p);
  VectorX<double> lambda = VectorX<double>::LinSpaced(p.rows(), -1, 1);
  const auto d = reference::dense(*p.mechanism, Damping<double>::uniform(p.rows(), 0.0));
  VectorX<double> dv = d.M_inv_Jt * lambda;
  EXPECT_LT(reference::contact_momentum(dense, dv, lambda), 1e-12);
  dv[0] += 1;
  EXPECT_NEAR(reference::contact_momentum(dense, dv, lambda), static_cast<double>(dense.M.col(0).cwiseAbs().maxCoeff()), 1e-9 * d.M.maxCoeff());
}

struct Defect {
  const char* name;
  void (*make)(ContactProblem<double>& p, VectorX<double>& lambda);
};
const Defect defects[] = {
    {"R⁻¹ forgotten", [](auto& p, auto&) { p.R_inverse.assign(p.R_inverse.size(), 0); }},
    {"target forgotten", [](auto& p, auto&) { p.target.setZero(); }},
    {"target added", [](auto& p, auto&) { p.target = -p.target; }},
    {"g forgotten", [](auto& p, auto&) { p.free_velocity.setZero(); }},
    {"μ squared", [](auto& p, auto&) { for (auto& x : p.friction) x *= x; }},
    {"the first tangent's μ for both", [](auto& p, auto&) { p.friction[8] = p.friction[7]; }},
    {"the shift of the other law", [](auto& p, auto&) { p.law = p.law == FrictionLaw::exact ? FrictionLaw::relaxed : FrictionLaw::exact; }},
    {"normal and tangent swapped", [](auto& p, auto& l) { std::swap(l[6], l[7]); std::swap(p.free_velocity[6], p.free_velocity[7]); }},
    {"impulse upside down", [](auto&, auto& l) { l = -l; }},
    {"one triangle of G", [](auto& p, auto&) { p.G = MatrixX<double>(p.G.template triangularView<Eigen::Lower>()); }},
    {"diagonal of G alone", [](auto& p, auto&) { p.G = MatrixX<double>(p.G.diagonal().asDiagonal()); }},
    {"box taken for a half line", [](auto& p, auto&) { p.groups[2].cone = Cone::half_line; }},
    {"half line taken for an equality", [](auto& p, auto&) { p.groups[1].cone = Cone::free; }},
    {"upper bound forgotten", [](auto& p, auto&) { p.high.assign(p.high.size(), std::numeric_limits<double>::infinity()); }},
    {"a contact left out", [](auto& p, auto&) { for (Index r = 6; r < 9; ++r) p.R_inverse[static_cast<std::size_t>(r)] = std::numeric_limits<double>::infinity(); }},
    {"one part in 1e10 of one entry", [](auto& p, auto&) { p.G(4, 4) *= 1 + 1e-10; }},
};

TEST(ContactResidual, WrongOnesAreNoticed) {
  for (const Defect& defect : defects) {
    Random random(11);
    int noticed = 0;
    for (int k = 0; k < 60; ++k) {
      const auto p = anything(random);
      const auto lambda = impulses(random, p.rows());
      auto q = p;
      auto other = lambda;
      defect.make(q, other);
      noticed += ratio(judged(p, lambda, q, other), lambda) >= 30;
    }
    EXPECT_GT(noticed, 0) << defect.name;
    std::printf("  %-34s noticed in %2d of 60\n", defect.name, noticed);
  }
}

}  // namespace
}  // namespace delassus::contact_residual_test
