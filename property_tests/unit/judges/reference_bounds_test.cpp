// The bounds of the verdict: they cover what changes of the data do, and tell the direct formula from a stable one.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/judges/reference_cases.h"
#include "reference/reference.h"
#include "reference/sensitivity.h"

namespace delassus::reference::reference_bounds_test {
namespace {

using namespace cases;

/// Every number changed by a relative ±ε.
Case perturbed(Case c, double epsilon, unsigned seed) {
  std::mt19937 engine(seed);
  const auto change = [&](double& x) { x *= engine() % 2 ? 1 + epsilon : 1 - epsilon; };
  for (auto& s : c.problem.S) for (Index i = 0; i < 6; ++i) change(s[i]);
  for (auto& k : c.problem.K) for (Index i = 0; i < 6; ++i) change(k[i]);
  for (auto& h : c.problem.H)
    for (Index j = 0; j < 6; ++j)
      for (Index i = j; i < 6; ++i) {
        change(h(i, j));
        h(j, i) = h(i, j);
      }
  for (auto& k : c.problem.joint_K) change(k);
  for (auto& a : c.problem.armature) change(a);
  for (auto& r : c.damping.diagonal) change(r);
  return c;
}

TEST(Sensitivity, CoversChangesOfTheData) {
  constexpr double epsilon = 0x1p-40;  // far above Quad's roundoff, far below one
  double worst = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Case c = random_case(seed, 5, 2);
    const Matrix x = random_right_side(seed, c.problem.structure->rows);
    const Sensitivity bounds(c.problem, c.damping);
    const VectorX<Quad> a = references()[0].apply(c.problem, c.damping, x).col(0), f = bounds.solve(x.col(0));
    const Vector apply_bound = bounds.apply_sensitivity(x.col(0)), solve_bound = bounds.solve_sensitivity(x.col(0), rounded(f));
    const Vector norm_bound = bounds.solve_normwise(x.col(0), rounded(f));
    EXPECT_TRUE((solve_bound.array() <= norm_bound.array()).all());
    for (unsigned draw = 1; draw <= 4; ++draw) {
      const Case other = perturbed(c, epsilon, 100 * seed + draw);
      const double apply_ratio = ratio(references()[0].apply(other.problem, other.damping, x).col(0), a, apply_bound, epsilon);
      const double solve_ratio = ratio(references()[0].solve(other.problem, other.damping, x).col(0), f, solve_bound, epsilon);
      EXPECT_LT(apply_ratio, 3.1);  // |δJ| ≤ 2ε J_abs, |δM| ≤ 3ε M_abs
      EXPECT_LT(solve_ratio, 3.1);
      worst = std::max({worst, apply_ratio, solve_ratio});
    }
  }
  EXPECT_GT(worst, 1.0 / 64);  // the bound is not far above what happens
}

/// λ = R a − R J M_R⁻¹ Jᵀ R a in double: within its own bound, and outside that of the data.
TEST(Sensitivity, DirectFormulaIsAmplified) {
  double beyond_data = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Case c = random_case(seed, 6, 1);
    c.damping = Damping<double>::uniform(c.problem.structure->rows, 0x1p-30);
    const Vector a = random_right_side(seed, c.problem.structure->rows).col(0);
    const auto d = dense(c.problem, c.damping);
    const Matrix R = Matrix::Identity(a.size(), a.size()) * 0x1p30;
    const Matrix MR = d.M + d.J.transpose() * R * d.J;
    const Matrix rate = PivotedLdlt<double>(MR).solve(d.J.transpose() * (R * a));
    const Matrix direct = R * (a - d.J * rate.col(0));
    const Sensitivity bounds(c.problem, c.damping);
    const VectorX<Quad> exact = bounds.solve(a);
    const VectorX<Quad> computed = convert<Quad>(direct).col(0);
    EXPECT_LT(ratio(computed, exact, bounds.solve_amplified(a), unit_roundoff<double>), 30) << seed;
    beyond_data = std::max(beyond_data, ratio(computed, exact, bounds.solve_sensitivity(a, rounded(exact)), unit_roundoff<double>));
  }
  EXPECT_GT(beyond_data, 30);
}

}  // namespace
}  // namespace delassus::reference::reference_bounds_test
