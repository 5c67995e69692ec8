// Hard rows that depend on each other, but for the last digits of a file: closed all the same.
#include <gtest/gtest.h>

#include "property_tests/unit/simulation/stepping_scenes.h"
#include "simulation/yielding.h"

namespace delassus::stepping_yielding_test {
namespace {

using namespace stepping;

// A slider on which three rows ask for d = 1, 3 and 8 µm, the last of which gives way by R⁻¹, and a row that nothing moves: with
// E = ε/m of the first two, d = −Σ g/E / (m + Σ 1/E): their mean, −2 µm, but for 4e-6 of it.
TEST(Yielding, is_the_mean_of_what_contradicts) {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 1);
  s->add_joint_constraint(4, 0);
  Problem<double> p(s);
  p.S[0] << 0, 0, 0, 1, 0, 0;
  p.H[0] = spatial_inertia<double>(2, {0, 0, 0}, Matrix3<double>::Identity());
  p.joint_K = {1, 1, 1, 0};
  Damping<double> damping = Damping<double>::uniform(4, 0);
  damping.diagonal[2] = 0.5;
  Yielding<double> y(s);
  ASSERT_TRUE(y.update(p, damping).ok());
  const MatrixX<double> none = MatrixX<double>::Zero(1, 1), gap = VectorX<double>{{1e-6, 3e-6, 8e-6, 5e-6}};
  MatrixX<double> d(1, 1), lambda(4, 1);
  ASSERT_TRUE(y.solve(none, -gap, 1, Accuracy{1e-12}, d, lambda).ok());
  const double E = Yielding<double>::epsilon / 2, exact = -(4e-6 / E + 8e-6 / 0.5) / (2 + 2 / E + 1 / 0.5);
  EXPECT_NEAR(d(0, 0), exact, 1e-12 * std::abs(exact)) << "what is asked of the operator";
  EXPECT_NEAR(d(0, 0), -2e-6, 1e-11);
  // without contradiction: a point leaves of −2 µm as much as ε/2 of it, the next one a millionth of that
  ASSERT_TRUE(y.solve(none, -VectorX<double>{{2e-6, 2e-6, 2e-6, 0}}, 1, Accuracy{1e-12}, d, lambda).ok());
  EXPECT_GT(std::abs(d(0, 0) + 2e-6), 1e-13);
  ASSERT_TRUE(y.solve(none, -VectorX<double>{{2e-6, 2e-6, 2e-6, 0}}, 2, Accuracy{1e-12}, d, lambda).ok());
  EXPECT_LT(std::abs(d(0, 0) + 2e-6), 1e-17);
}

// Cassie on its rods with hard rows: each linkage is planar up to the file's last decimals, so that four rows depend on the others and what
// a step leaves open of them contradicts them by 1e-9 m. Left open it grows from step to step, until no velocity fulfils the rows.
TEST(Yielding, cassie_on_hard_rows_stays_closed) {
  Scene s = open_scene("docs/moving/cassie.yaml");
  s.damping = Damping<double>::uniform(static_cast<Index>(s.damping.diagonal.size()), 0);
  s.motion.contact_damping = 0;
  Simulation<double> run(s, step_of(1e-3));
  double drift = 0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(run.step().ok()) << k << ": " << run.last().message;
    EXPECT_LE(run.last().left, 1e-12) << k;
    drift = std::max(drift, run.last().drift);
  }
  EXPECT_GT(drift, 1e-9);
}

/// Cassie on her guide in the air, leaf springs at work.
Scene cassie_in_the_air() {
  Scene s = open_scene("docs/moving/cassie.yaml");
  s.damping = Damping<double>::uniform(static_cast<Index>(s.damping.diagonal.size()), 0);
  s.motion.detects = false, s.has_ground = false;
  s.motion.motors.clear();  // cut at their effort: not smooth
  std::erase_if(s.model.constraints, [](const Constraint& c) { return c.kind == Constraint::Kind::contact; });
  return s;
}

// Explicit steps, whose stages are beside the rows: no stage ends the run, loops are closed, and the error is that of the method's order.
TEST(Yielding, explicit_steps_of_cassie_keep_their_order) {
  const auto end_of = [](double h, int steps) {
    Settings settings = step_of(h);
    settings.integrator = "runge_kutta";
    settings.without = {"joint limits"};
    Simulation<double> run(cassie_in_the_air(), settings);
    for (int k = 0; k < steps; ++k) {
      EXPECT_TRUE(run.step().ok()) << k << ": " << name(run.last().report.status) << run.last().message;
      EXPECT_LE(run.last().left, 1e-12) << k;
    }
    return run.state().nu;
  };
  const VectorX<double> coarse = end_of(2.5e-4, 32), fine = end_of(1.25e-4, 64), finer = end_of(6.25e-5, 128);
  EXPECT_NEAR((coarse - fine).norm() / (fine - finer).norm(), 16, 4);
}

}  // namespace
}  // namespace delassus::stepping_yielding_test
