// Newton's method on the motion: not only that it arrives (with a wrong Hessian it does too), but by which steps.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "generators/random.h"
#include "generators/contact_families.h"
#include "reference/definition.h"
#include "simulation/solvers/friction_shift.h"
#include "simulation/solvers/primal_newton.h"

namespace delassus::newton_laws_test {
namespace {

using namespace simulation;

struct Bench {
  ContactProblem<double> p;
  MatrixX<double> M, J;
  VectorX<double> R_inverse, b;
  mutable TreeOperators<double> tree;
  explicit Bench(const PileSpec& spec) : p(pile(spec)), tree(p.mechanism->structure) {
    tree.take(*p.mechanism);
    const auto d = reference::dense(*p.mechanism, Damping<double>::uniform(p.rows(), 0.0));
    M = d.M;
    J = d.J;
    R_inverse = Eigen::Map<const VectorX<double>>(p.R_inverse.data(), p.rows());
    b = p.free_velocity;
  }
};

PileSpec spec(Index bodies, Index contacts, std::uint64_t seed, bool joints = false) {
  return {.bodies = bodies, .contacts = contacts, .damping = 1e-3, .joints = joints, .law = FrictionLaw::relaxed, .seed = seed};
}

// λ(u), contact by contact, as the minimum of ½ λᵀR⁻¹λ + λᵀu over the cone: equal R⁻¹ within a contact, so the nearest point of −R u.
VectorX<double> impulses(const Bench& s, const VectorX<double>& u) {
  VectorX<double> lambda = -(u.array() / s.R_inverse.array()).matrix();
  for (const ConeRows& c : s.p.groups) {
    const double mu = s.p.friction[static_cast<std::size_t>(c.row + 1)], t = lambda.segment(c.row + 1, 2).norm(), n = lambda[c.row];
    if (t <= mu * n) continue;
    const double normal = std::max(0.0, (n + mu * t) / (1 + mu * mu));
    lambda.segment(c.row + 1, 2) *= t > 0 ? mu * normal / t : 0;
    lambda[c.row] = normal;
  }
  return lambda;
}

// H = −dλ/du by central differences; false where a difference crosses from one region of the cone to another.
MatrixX<double> curvature(const Bench& s, const VectorX<double>& u) {
  const Index m = u.size();
  MatrixX<double> H(m, m);
  for (Index c = 0; c < m; ++c) {
    const double h = 1e-6 * u.lpNorm<Eigen::Infinity>();
    VectorX<double> plus = u, minus = u;
    plus[c] += h;
    minus[c] -= h;
    H.col(c) = -(impulses(s, plus) - impulses(s, minus)) / (2 * h);
  }
  return H;
}

// The same in closed form, where λ(u) has a derivative: R Π'(−R u), Π of a round cone.
MatrixX<double> exact_curvature(const Bench& s, const VectorX<double>& u) {
  MatrixX<double> H = MatrixX<double>::Zero(u.size(), u.size());
  for (const ConeRows& c : s.p.groups) {
    const double R = 1 / s.R_inverse[c.row], mu = s.p.friction[static_cast<std::size_t>(c.row + 1)], a = 1 / (1 + mu * mu);
    const double n = -R * u[c.row], t = R * u.segment(c.row + 1, 2).norm();
    auto block = H.block(c.row, c.row, 3, 3);
    if (t <= mu * n) block.diagonal().setConstant(R);
    if (t <= mu * n || n + mu * t <= 0) continue;
    const Eigen::Vector2d d = -R / t * u.segment(c.row + 1, 2);
    block(0, 0) = R * a;
    block.block(1, 0, 2, 1) = R * mu * a * d;
    block.block(0, 1, 1, 2) = R * mu * a * d.transpose();
    block.block(1, 1, 2, 2) = R * mu * (mu * a * d * d.transpose() + (n + mu * t) * a / t * (Eigen::Matrix2d::Identity() - d * d.transpose()));
  }
  return H;
}

// What a step owes: (M + JᵀHJ) d = Jᵀλ − M w, relative to its terms. `H` by differences.
double step_error(const Bench& s, const MatrixX<double>& H, const VectorX<double>& lambda, const VectorX<double>& d) {
  const VectorX<double> right = s.J.transpose() * lambda;  // w = 0
  const VectorX<double> left = s.M * d + s.J.transpose() * (H * (s.J * d));
  return (left - right).norm() / (right.norm() + left.norm());
}

TEST(NewtonLaws, StepSolvesTheHessianOfAnotherRoute) {
  for (const bool joints : {false, true})
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const Bench s(spec(4, 6, seed, joints));
      PrimalNewton<double> newton;
      newton.analyze(s.p);
      ASSERT_TRUE(newton.start(s.p, s.tree).ok());
      VectorX<double> lambda(s.p.rows()), d(s.M.rows()), Jd(s.p.rows());
      newton.evaluate(s.R_inverse, s.b, lambda);
      EXPECT_LT((lambda - impulses(s, s.b)).norm(), 1e-12 * lambda.norm() + 1e-300);
      ASSERT_TRUE(newton.direction(lambda, d, Jd).ok());
      if (lambda.norm() == 0) continue;
      EXPECT_LT(step_error(s, curvature(s, s.b), lambda, d), 1e-7) << "seed " << seed;  // of differences with a step of 1e-6
      EXPECT_LT((s.J * d - Jd).norm(), 1e-10 * (1 + Jd.norm()));
    }
}

// Wrong Hessians of peers: each must be seen by the law above.
TEST(NewtonLaws, WrongHessiansAreNoticed) {
  struct Defect {
    const char* name;
    void (*make)(MatrixX<double>& M, MatrixX<double>& J, MatrixX<double>& H, const MatrixX<double>& H_before);
  };
  const Defect defects[] = {
      {"M missing in one triangle", [](auto& M, auto&, auto&, auto&) { M = MatrixX<double>(M.template triangularView<Eigen::Lower>()); }},
      {"rows of another branch merged", [](auto&, auto& J, auto&, auto&) { J.col(1) += J.col(J.cols() - 1); }},
      {"stale weights", [](auto&, auto&, auto& H, auto& H_before) { H = H_before; }},
      {"blocks without their sides", [](auto&, auto&, auto& H, auto&) { H = MatrixX<double>(H.diagonal().asDiagonal()); }},
      {"one contact left out", [](auto&, auto&, auto& H, auto&) { H.topRows(3).setZero(); H.leftCols(3).setZero(); }},
      {"a per cent of M", [](auto& M, auto&, auto&, auto&) { M *= 1.01; }},
  };
  for (const Defect& defect : defects) {
    int noticed = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const Bench s(spec(4, 6, seed, true));
      const VectorX<double> lambda = impulses(s, s.b);
      if (lambda.norm() == 0) continue;
      const MatrixX<double> H = curvature(s, s.b);
      const MatrixX<double> H_before = curvature(s, s.b - s.J * s.M.llt().solve(s.J.transpose() * lambda));  // of another motion
      MatrixX<double> M = s.M, J = s.J, wrong = H;
      defect.make(M, J, wrong, H_before);
      const VectorX<double> d = (M + J.transpose() * wrong * J).fullPivLu().solve(s.J.transpose() * lambda);
      noticed += step_error(s, H, lambda, d) >= 1e-7;
    }
    EXPECT_GT(noticed, 0) << defect.name;
    std::printf("  %-32s noticed in %d of 8\n", defect.name, noticed);
  }
}

Bench half_lines(std::uint64_t seed) {
  Bench s(spec(3, 4, seed, seed % 2 == 0));
  for (ConeRows& c : s.p.groups) c.cone = Cone::half_line;
  std::fill(s.p.friction.begin(), s.p.friction.end(), 0);
  return s;
}

bool strictly_complementary(const Bench& s, const VectorX<double>& lambda, const VectorX<double>& u) {
  bool strict = lambda.norm() > 0;
  for (Index r = 0; r < u.size(); ++r) strict = strict && (lambda[r] * s.R_inverse[r] > 1e-4 || u[r] > 1e-4);
  return strict;
}

// Half lines alone are quadratic near a solution that is strictly complementary: one step, to the last digits.
TEST(NewtonLaws, OneStepFromTheActiveSet) {
  int judged = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Bench s = half_lines(seed);
    PrimalNewton<double> newton;
    newton.analyze(s.p);
    ASSERT_TRUE(newton.start(s.p, s.tree).ok());
    VectorX<double> lambda(s.p.rows()), again(s.p.rows());
    ASSERT_TRUE(newton.minimise(s.R_inverse, s.b, 0, 100, lambda).report.ok());
    const VectorX<double> u = s.J * newton.motion() + s.b, solution = newton.motion();
    if (!strictly_complementary(s, lambda, u)) continue;
    ++judged;
    ASSERT_TRUE(newton.begin_at(lambda * (1 + 1e-6)).ok());  // a motion that keeps the active set
    ASSERT_TRUE(newton.minimise(s.R_inverse, s.b, 0, 1, again).report.ok());
    EXPECT_LT((newton.motion() - solution).norm(), 1e-11 * (1 + solution.norm())) << "seed " << seed;
  }
  EXPECT_GT(judged, 3);
}

// The same method with a dense Hessian, its search written out with dense curvature, needs as many iterations.
TEST(NewtonLaws, AsManyIterationsAsWithADenseHessian) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Bench s(spec(4, 8, seed, seed % 2 == 0));
    PrimalNewton<double> newton;
    newton.analyze(s.p);
    ASSERT_TRUE(newton.start(s.p, s.tree).ok());
    VectorX<double> lambda(s.p.rows());
    const auto out = newton.minimise(s.R_inverse, s.b, 1e-9, 100, lambda);
    VectorX<double> w = VectorX<double>::Zero(s.M.rows());
    int dense = 0;
    for (; dense < 100; ++dense) {
      const VectorX<double> u = s.J * w + s.b, l = impulses(s, u);
      const MatrixX<double> H = exact_curvature(s, u);
      const VectorX<double> d = (s.M + s.J.transpose() * H * s.J).llt().solve(s.J.transpose() * l - s.M * w), Jd = s.J * d;
      const auto slope = [&](double alpha) { return d.dot(s.M * (w + alpha * d)) - Jd.dot(impulses(s, u + alpha * Jd)); };
      double low = 0, high = 0, alpha = 1;
      while (std::fabs(slope(alpha)) > PrimalNewton<double>::flat_enough * std::fabs(slope(0))) {
        (slope(alpha) < 0 ? low : high) = alpha;
        const double next = alpha - slope(alpha) / d.dot(MatrixX<double>(s.M + s.J.transpose() * exact_curvature(s, u + alpha * Jd) * s.J) * d);
        alpha = high > 0 && !(low < next && next < high) ? (low + high) / 2 : next;
      }
      w += alpha * d;
      double bent = (alpha * Jd).lpNorm<Eigen::Infinity>() <= 1e-14 ? 0 : 1;  // λ off what H says, as a velocity
      if (alpha == 1) bent = std::min(bent, (impulses(s, u + Jd) - (l - H * Jd)).cwiseAbs().cwiseProduct(s.R_inverse).maxCoeff());
      if (bent <= 1e-9) break;
    }
    EXPECT_NEAR(out.iterations, dense + 1, 1) << "seed " << seed;
    EXPECT_LT((newton.motion() - w).norm(), 1e-7 * (1 + w.norm())) << "seed " << seed;
  }
}

// Where a point starts from the cones of its own answer, it starts at the answer: half lines, with λ₀ that are far from it.
TEST(NewtonLaws, AStartFromTheConesOfTheAnswerIsTheAnswer) {
  int judged = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Bench s = half_lines(seed);
    PrimalNewton<double> newton;
    newton.analyze(s.p);
    ASSERT_TRUE(newton.start(s.p, s.tree).ok());
    const VectorX<double> origin = VectorX<double>::LinSpaced(s.p.rows(), 0.0, 0.5);
    VectorX<double> lambda(s.p.rows()), again(s.p.rows());
    ASSERT_TRUE(newton.begin_from(origin, VectorX<double>::Zero(s.p.rows()), s.R_inverse, s.b).ok());
    ASSERT_TRUE(newton.minimise(s.R_inverse, s.b, 0, 100, lambda).report.ok());
    const VectorX<double> w = newton.motion(), u = s.J * w + s.b;
    EXPECT_LT((s.M * w - s.J.transpose() * (lambda - origin)).norm(), 1e-12 * (1 + (s.M * w).norm())) << "seed " << seed;
    if (!strictly_complementary(s, lambda, u)) continue;
    ++judged;
    const VectorX<double> x = lambda - u;  // of another length, in the same cones
    ASSERT_TRUE(newton.begin_from(origin, x, s.R_inverse, s.b).ok());
    EXPECT_LT((newton.motion() - w).norm(), 1e-11 * (1 + w.norm())) << "seed " << seed;
    EXPECT_EQ(newton.minimise(s.R_inverse, s.b, 0, 100, again).iterations, 0) << "seed " << seed;
    EXPECT_LT((again - lambda).norm(), 1e-9 * lambda.norm()) << "seed " << seed;
  }
  EXPECT_GT(judged, 3);
}

// One scene, masses over six decades: the iterations stay few.
TEST(NewtonLaws, MassRatiosDoNotStallIt) {
  for (const int decades : {0, 3, 6}) {
    PileSpec of = spec(8, 12, 3);
    of.mass_decades = decades;
    const Bench s(of);
    PrimalNewton<double> newton;
    newton.analyze(s.p);
    ASSERT_TRUE(newton.start(s.p, s.tree).ok());
    VectorX<double> lambda(s.p.rows());
    EXPECT_LT(newton.minimise(s.R_inverse, s.b, 0, 100, lambda).iterations, 40) << decades << " decades";
  }
}

// What Γ does to a pile: its impulses, their velocities, and Φ.
struct Shifted {
  Bench s;
  PrimalNewton<double> newton;
  VectorX<double> lambda, u;
  explicit Shifted(std::uint64_t seed, bool joints) : s([&] { auto of = spec(4, 8, seed, joints); of.law = FrictionLaw::exact; return of; }()), lambda(s.p.rows()), u(s.p.rows()) {
    newton.analyze(s.p);
  }
  VectorX<double> phi(const VectorX<double>& gamma) {
    VectorX<double> b = s.b, out(gamma.size());
    for (Index e = 0; e < gamma.size(); ++e) b[s.p.groups[static_cast<std::size_t>(e)].row] += gamma[e];
    EXPECT_TRUE(newton.start(s.p, s.tree).ok() && newton.minimise(s.R_inverse, b, 0, 100, lambda).report.ok());
    u = s.b + s.J * s.M.llt().solve(s.J.transpose() * lambda) + s.R_inverse.cwiseProduct(lambda);
    for (Index e = 0; e < gamma.size(); ++e) {
      const Index r = s.p.groups[static_cast<std::size_t>(e)].row;
      out[e] = std::hypot(s.p.friction[static_cast<std::size_t>(r + 1)] * u[r + 1], s.p.friction[static_cast<std::size_t>(r + 2)] * u[r + 2]);
    }
    return out;
  }
};

// A step on Γ solves (1 − Φ') δ = Φ(Γ) − Γ, Φ' by differences: to what is asked of GMRES and to theirs.
TEST(NewtonLaws, AStepOnTheShiftSolvesTheDerivativeOfAnotherRoute) {
  int judged = 0;
  double slopes = 0;
  for (const bool joints : {false, true})
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Shifted x(seed, joints);
      FrictionShift<double> shift;
      shift.analyze(x.s.p);
      shift.plain(x.s.p, x.s.b);
      const auto groups = static_cast<Index>(x.s.p.groups.size());
      VectorX<double> gamma(groups), step(groups);
      for (Index e = 0; e < groups; ++e) gamma[e] = shift[static_cast<std::size_t>(e)];
      const VectorX<double> at = x.phi(gamma);
      MatrixX<double> D(groups, groups);
      bool smooth = true;
      const double h = 1e-6;
      for (Index e = 0; e < groups; ++e) {
        const VectorX<double> plus = x.phi(gamma + h * VectorX<double>::Unit(groups, e)), minus = x.phi(gamma - h * VectorX<double>::Unit(groups, e));
        D.col(e) = (plus - minus) / (2 * h);
        smooth = smooth && (plus - 2 * at + minus).norm() <= 1e-3 * h;
      }
      x.phi(gamma);
      ASSERT_TRUE(shift.newton(x.s.p, x.newton, x.s.R_inverse, x.lambda, x.u, 1).ok());
      bool cut = false;
      for (Index e = 0; e < groups; ++e) step[e] = shift[static_cast<std::size_t>(e)] - gamma[e], cut = cut || shift[static_cast<std::size_t>(e)] == 0;
      if (!smooth || cut) continue;
      ++judged;
      slopes = std::max(slopes, D.cwiseAbs().maxCoeff());
      EXPECT_LE((step - D * step - (at - gamma)).norm(), 2e-3 * (at - gamma).norm()) << "seed " << seed << (joints ? ", joints" : "");
    }
  EXPECT_GT(judged, 10);
  EXPECT_GT(slopes, 0.1);
}

}  // namespace
}  // namespace delassus::newton_laws_test
