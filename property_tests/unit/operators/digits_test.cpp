// Digits by random rounding: the scalar on sums whose rounding is known, and digits of whole solves held against the truth.
//
// Coverage: Student's interval holds the exact result with probability 95 %. Rows of one run share roundings, so a run
// counts as one trial: the share outside over all rows of `runs` runs is at most 0.05 + 3 √(0.05 · 0.95 / runs).
#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/digits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "algorithms/delassus.h"
#include "algorithms/factors/factor.h"
#include "generators/random.h"
#include "models/scene.h"
#include "reference/definition.h"

namespace delassus::digits::digits_test {
namespace {

constexpr int runs = 400;
const double most_outside = 0.05 + 3 * std::sqrt(0.05 * 0.95 / runs);

/// Random rounding off for the lifetime of the object: the seeded defect.
struct Deterministic {
  bool before = random_rounding(false);
  ~Deterministic() { random_rounding(before); }
};

TEST(Stochastic, ExactOperationsKeepEveryDigit) {
  seed_rounding(1);
  Stochastic sum = 0;
  for (int k = 0; k < 1024; ++k) sum += 0.75;
  EXPECT_EQ(sum.digits(), most_digits);
  EXPECT_EQ(sum.mean(), 768);
  const Stochastic third = Stochastic(1) / 3;
  EXPECT_EQ((third + third).digits(), third.digits());
  EXPECT_EQ((third - third).digits(), most_digits);  // zero, exactly
  EXPECT_EQ(sqrt(Stochastic(9)).digits(), most_digits);
}

// (1 + c) − 1 is a multiple of 2⁻⁵², one of the two around c ≈ 2⁻⁴⁰: 12 bits are left. Each is met so often that the
// expectation is c, up to three deviations of the mean, √(p(1 − p)/N) units.
TEST(Stochastic, CancellationLeavesTheDifferenceOfTheBits) {
  const double unit = 0x1p-52, c = 0x1p-40 / 3, below = std::floor(c / unit) * unit, p = (c - below) / unit;
  seed_rounding(2);
  double sum = 0;
  constexpr int trials = 3000;
  for (int k = 0; k < trials; ++k)
    for (const double x : ((Stochastic(1) + Stochastic(c)) - Stochastic(1)).v) {
      EXPECT_TRUE(x == below || x == below + unit);
      sum += (x - below) / unit;
    }
  EXPECT_LT(std::fabs(sum / (3 * trials) - p), 3 * std::sqrt(p * (1 - p) / (3 * trials)));
  const Deterministic defect;
  for (const double x : ((Stochastic(1) + Stochastic(c)) - Stochastic(1)).v) sum += x == below + std::round(p) * unit ? 0 : 1e9;
  EXPECT_LT(sum, 1e9);
}

// Two sums of the same numbers in opposite orders are the same number; what their difference shows is rounding.
TEST(Stochastic, DifferenceOfEqualNumbersHasNoDigits) {
  double most = 0;
  const auto difference = [](std::uint64_t seed) {
    seed_rounding(seed);
    Stochastic up = 0, down = 0;
    for (int k = 1; k <= 200; ++k) up += Stochastic(1) / k;
    for (int k = 200; k >= 1; --k) down += Stochastic(1) / k;
    return up - down;
  };
  int outside = 0;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    const Stochastic d = difference(seed);
    outside += std::fabs(d.mean()) > d.half_width();
    most = std::max(most, d.digits());
  }
  EXPECT_LE(static_cast<double>(outside) / runs, most_outside);
  const Deterministic defect;
  EXPECT_EQ(difference(1).half_width(), 0);
}

TEST(Stochastic, SameSeedSameSamples) {
  const auto tenth_sum = [](std::uint64_t seed) {
    seed_rounding(seed);
    Stochastic sum = 0;
    for (int k = 0; k < 100; ++k) sum += 0.1;
    return sum.v;
  };
  EXPECT_EQ(tenth_sum(3), tenth_sum(3));
  EXPECT_NE(tenth_sum(3), tenth_sum(4));
}

/// What `runs` computations on go2_standing say: each with its own damping (one to two times `base`) and vector.
struct Truth {
  double outside = 0;    ///< share of rows whose Student interval misses the exact result
  double overstated = 0, understated = 0;  ///< share of rows where the operator in double has fewer, or more, digits than shown
};

// Shown: C = log10(√3 |f| / (τ s)). True, for aba_sweep or lcaba in double with error e: −log10(|e| / |f|) = C + log10(τ s / (√3 |e|)).
// Were e drawn like a sample, t = e / s would follow Student's law with two degrees of freedom, |t| ≤ x with probability
// x / √(2 + x²): |t| ∈ [0.0354, 6.205] in 95 % of rows, 2.5 % on each side. Rounding to nearest has at most the deviation of
// a sample: operation by operation its mean square is half of it (1/12 and 1/6 units²), and a fused operation leaves one of two
// roundings out: at least a quarter of the variance in all, half of the deviation. Hence
//   C + log10(τ/√3) − log10(6.205)  ≤  true  ≤  C + log10(τ/√3) − log10(0.0354 / 2)    except in 2.5 % on each side.
Truth truth(Computation computation, double base) {
  const bool apply = computation == Computation::apply;
  const Scene scene = open_scene("go2_standing");
  const Problem<double> problem = problem_of(scene);
  const Problem<Quad> quad = problem.cast<Quad>();
  const Index m = problem.structure->rows;
  const double shift = std::log10(4.302652729911275 / std::sqrt(3.0));
  generators::Random random(7);
  const auto op = find_operator(apply ? "aba_sweep" : "lcaba").make<double>();
  op->analyze(problem.structure);
  Workspace<double> work(op->workspace());
  Truth t;
  for (int run = 0; run < runs; ++run) {
    const auto damping = Damping<double>::uniform(m, base * (1 + random.integer(0, 999) / 1000.0));
    MatrixX<double> a(m, 1), f(m, 1);
    for (Index r = 0; r < m; ++r) a(r, 0) = random.integer(-1000, 1000) / 1000.0;
    const auto dense = reference::dense(quad, damping.cast<Quad>());
    const MatrixX<Quad> given = a.cast<Quad>(), exact = apply ? reference::dense_apply(dense, given) : reference::dense_solve(dense, given);
    EXPECT_TRUE(op->update(problem, damping).ok());
    EXPECT_TRUE((apply ? op->apply(a, f, work) : op->solve(a, f, work)).ok());
    const Measured shown = measure(problem, damping, a.col(0), computation, static_cast<std::uint64_t>(run + 1));
    EXPECT_TRUE(shown.report.ok());
    for (Index r = 0; r < m; ++r) {
      const Stochastic& s = shown.result[static_cast<std::size_t>(r)];
      const double miss = static_cast<double>(abs(exact(r, 0) - Quad(s.mean())));
      const double error = static_cast<double>(abs(exact(r, 0) - Quad(f(r, 0)))), value = std::fabs(f(r, 0));
      const double ahead = (error > 0 ? std::log10(value / error) : most_digits) - s.digits() - shift;
      t.outside += miss > s.half_width();
      t.overstated += ahead < -std::log10(6.205);
      t.understated += ahead > -std::log10(0.0354 / 2);
    }
  }
  for (double* share : {&t.outside, &t.overstated, &t.understated}) *share /= static_cast<double>(runs * m);
  return t;
}

void expect_true_digits(Computation computation, double damping) {
  const double most_beyond = 0.025 + 3 * std::sqrt(0.025 * 0.975 / runs);
  const Truth t = truth(computation, damping);
  EXPECT_LE(t.outside, most_outside) << damping;
  EXPECT_LE(t.overstated, most_beyond) << damping;
  EXPECT_LE(t.understated, most_beyond) << damping;
  std::printf("damping %g: outside %.4f (at most %.4f), overstated %.4f, understated %.4f (at most %.4f)\n", damping, t.outside,
              most_outside, t.overstated, t.understated, most_beyond);
}

TEST(Digits, OfTheDirectFormulaAreThoseAgainstTheReference) {
  for (const double damping : {1e-4, 1e-8}) expect_true_digits(Computation::solve, damping);
}

TEST(Digits, OfTheOperatorAreThoseAgainstTheReference) { expect_true_digits(Computation::apply, 1e-4); }

TEST(Digits, WithoutRandomRoundingAreFoundWrong) {
  const Deterministic defect;
  const Truth t = truth(Computation::solve, 1e-4);
  EXPECT_GT(t.outside, most_outside);
  EXPECT_GT(t.overstated, most_outside);
}

/// A chain of sliders along one axis with a row on the body `held`: masses from the root on [kg].
Problem<double> sliders(const std::vector<double>& masses, Index held) {
  auto s = std::make_shared<Structure>();
  for (std::size_t i = 0; i < masses.size(); ++i) s->add_body(static_cast<Index>(i) - 1, 1);
  s->add_link_constraint(1, {held});
  Problem<double> p(s);
  const Vector3<double> axis = Vector3<double>(1, 2, 3).normalized();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    p.S[i] = translation_axis(axis);
    p.H[i] = spatial_inertia<double>(masses[i], Vector3<double>::Zero(), masses[i] * Matrix3<double>::Identity());
  }
  p.K[0] = translation_axis(axis);
  return p;
}

// A slider's inertia is taken out along its axis: H − U D⁻¹ Uᵀ leaves the rounding of 10⁶ kg there, and the bodies below,
// which carry 10⁶ kg across the axis, have 1 kg along it: their pivots keep six digits fewer than with 1 kg everywhere.
// The heavy body and what it carries lose nothing. Figures of three samples scatter by −0.28 … +0.80 digits (95 %: s²/σ² is
// exponential), medians of 21 of them by less than 1.08.
TEST(Digits, LossShowsAtTheLightBodiesUnderTheHeavyOne) {
  constexpr int seeds = 21;
  const VectorX<double> x = VectorX<double>::Ones(1);
  const auto pivots = [&](double heavy) {
    std::array<std::vector<double>, 4> kept;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const Measured m = measure(sliders({1, 1, heavy, 1}, 1), Damping<double>::uniform(1, 0), x, Computation::apply, seed);
      EXPECT_TRUE(m.report.ok());
      for (std::size_t i = 0; i < 4; ++i) kept[i].push_back(m.links[i].pivot);
    }
    std::array<double, 4> median{};
    for (std::size_t i = 0; i < 4; ++i) {
      std::sort(kept[i].begin(), kept[i].end());
      median[i] = kept[i][seeds / 2];
    }
    return median;
  };
  const auto light = pivots(1), heavy = pivots(1e6);
  for (const std::size_t below : {0u, 1u}) EXPECT_LT(std::fabs(light[below] - heavy[below] - 6), 1.08) << below;
  for (const std::size_t above : {2u, 3u}) EXPECT_LT(std::fabs(light[above] - heavy[above]), 1.08) << above;
}

// A row on the light body under the heavy one: its pivot Sᵀ H S is 1 kg out of terms of 10⁶ kg, so its own step is the one
// that costs the result six digits.
TEST(Digits, CostIsThatOfTheLightBodysStep) {
  const VectorX<double> x = VectorX<double>::Ones(1);
  int found = 0;
  constexpr int seeds = 100;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Measured m = measure(sliders({1, 1, 1e6, 1}, 1), Damping<double>::uniform(1, 0), x, Computation::apply, seed, Costs::of_links_too);
    std::size_t most = 0;
    for (std::size_t i = 1; i < 4; ++i)
      if (m.links[i].cost > m.links[most].cost) most = i;
    found += most == 1 && m.links[1].cost > clear_cost && m.stages[1].cost > clear_cost;
    EXPECT_LT(m.stages[0].cost, clear_cost);
  }
  EXPECT_EQ(found, seeds);
}

// What is measured is Factor itself: rounding to nearest, the steps taken one by one give its project to the bit.
TEST(Digits, AreMeasuredOnTheFactorThatShips) {
  const Deterministic nearest;
  const Scene scene = open_scene("go2_standing");
  const Problem<double> problem = problem_of(scene);
  const auto m = static_cast<std::size_t>(problem.structure->rows);
  const auto damping = Damping<double>::uniform(problem.structure->rows, 1e-6);
  const Plan plan = make_plan(*problem.structure, Matrix::M_R, Branches::all);
  Factor<Stochastic> factor;
  BlockDiagonal<Stochastic> weights;
  factor.analyze(*problem.structure, plan);
  weights.analyze(*problem.structure);
  ASSERT_TRUE(weights.assign_inverse(damping.cast<Stochastic>()).ok());
  ASSERT_TRUE(factor.start(problem.cast<Stochastic>()).ok());
  ASSERT_TRUE(factor.update_weights(weights).ok());
  std::vector<Stochastic> x(m, 1), scaled(m), y(m), work(static_cast<std::size_t>(factor.workspace()));
  weights.multiply(x.data(), scaled.data());
  factor.project(scaled.data(), y.data(), work.data());
  const Measured shown = measure(problem, damping, VectorX<double>::Ones(problem.structure->rows), Computation::solve, 1);
  for (std::size_t r = 0; r < m; ++r) EXPECT_EQ(shown.motion[r].v, y[r].v) << r;
}

TEST(Digits, NumericalOutcomesAreReports) {
  const Problem<double> p = sliders({1, 1}, 1);
  const VectorX<double> x = VectorX<double>::Ones(1);
  EXPECT_EQ(measure(p, Damping<double>::uniform(1, 0), x, Computation::solve, 1).report.status, Status::zero_damping);
  EXPECT_EQ(measure(sliders({1, 0}, 1), Damping<double>::uniform(1, 1), x, Computation::apply, 1).report.status, Status::lost_pivot);
  EXPECT_THROW(static_cast<void>(measure(p, Damping<double>::uniform(1, 1), VectorX<double>::Ones(2), Computation::apply, 1)), std::logic_error);
}

}  // namespace
}  // namespace delassus::digits::digits_test
