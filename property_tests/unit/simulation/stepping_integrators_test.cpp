// Integrators of higher order: the order measured, closed forms, and what they refuse.
#include <gtest/gtest.h>

#include <tuple>

#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_integrators_test {
namespace {

using namespace stepping;

constexpr double eps = 0x1p-53;

Settings rk(double h) {
  Settings s = step_of(h);
  s.integrator = "runge_kutta";
  return s;
}

/// A free trunk with an arm and everything that acts without rows; its centre of mass away from the floating frame.
Scene smooth_without_rows() {
  Scene s = everything_smooth();
  s.model.constraints.clear();
  s.damping = {};
  s.motion.motors[0].effort = 1e9;  // a cut is a kink: order 4 ends there
  return s;
}

/// The error falls by 2⁴ for h/2 (measured against h/8, which is off by 1/4096 of the first).
TEST(Integrators, runge_kutta_is_of_order_four) {
  for (const Scene& scene : {double_pendulum(), free_body({0.1, 0.2, 0.25}), smooth_without_rows()}) {
    const State<double> exact = run(scene, rk(1.0 / 800), 800);
    ASSERT_GT(exact.q.size(), 0);
    double error[2];
    for (const int k : {0, 1}) {
      const State<double> end = run(scene, rk(1.0 / (100 << k)), 100 << k);
      error[k] = (end.q - exact.q).norm() + (end.nu - exact.nu).norm();
    }
    EXPECT_NEAR(error[0] / error[1], 16, 3);
    EXPECT_LT(error[1], 1e-4);
  }
}

/// The pair's answer: 2⁵ for h/2.
TEST(Integrators, dormand_prince_is_of_order_five) {
  for (const Scene& scene : {double_pendulum(), free_body({0.1, 0.2, 0.25}), smooth_without_rows()}) {
    Settings pair = step_of(1.0 / 1600);
    pair.integrator = "dormand_prince";
    const State<double> exact = run(scene, pair, 1600);
    ASSERT_GT(exact.q.size(), 0);
    double error[2];
    for (const int k : {0, 1}) {
      pair.step = 1.0 / (100 << k);
      const State<double> end = run(scene, pair, 100 << k);
      error[k] = (end.q - exact.q).norm() + (end.nu - exact.nu).norm();
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 5, 0.5) << "nearer to five than to any other order: terms of h⁶ are not small beside it";
    EXPECT_LT(error[1], 1e-6);
  }
}

Settings controlled(double h, double error) {
  Settings s = step_of(h);
  s.integrator = "dormand_prince";
  s.error = error;
  return s;
}

/// What steps add in a second is at most what was asked: a symmetric top, whose ω turns without growth of errors. As many steps as the
/// order of the estimate says: tolerance^(−1/4).
TEST(Integrators, steps_follow_their_error) {
  Scene scene = free_body({0.2, 0.2, 0.35});
  scene.has_gravity = false;
  const V3 w = scene.motion.nu.head<3>();
  const double t = 8, angle = (0.35 - 0.2) * w[2] / 0.2 * t;
  const V3 exact(w[0] * std::cos(angle) - w[1] * std::sin(angle), w[0] * std::sin(angle) + w[1] * std::cos(angle), w[2]);
  int taken[2];
  for (const int k : {0, 1}) {
    const double asked = k ? 1e-6 / 256 : 1e-6;
    Simulation<double> s(scene, controlled(t, asked));
    const StepReport& r = s.step();
    ASSERT_TRUE(r.ok()) << r.message;
    EXPECT_LE(r.error, asked);
    EXPECT_GT(r.error, asked / 100);
    EXPECT_GT(r.rejected, 0);  // 8 s at once are too long
    EXPECT_EQ(s.time(), t);
    EXPECT_LT((V3(s.state().nu.head<3>()) - exact).norm(), std::sqrt(3.0) * asked * t);
    taken[k] = r.taken;
  }
  EXPECT_NEAR(double(taken[1]) / taken[0], 4, 0.5);
}

/// The length of the next step belongs to the state.
TEST(Integrators, controlled_steps_repeat_every_bit) {
  const Scene scene = smooth_without_rows();
  Simulation<double> through(scene, controlled(0.1, 1e-7));
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(through.step().ok());
  const State<double> saved = through.state();
  EXPECT_GT(saved.trial, 0);
  Simulation<double> later(scene, controlled(0.1, 1e-7));
  later.restore(saved);
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(through.step().ok());
    ASSERT_TRUE(later.step().ok());
    EXPECT_EQ(through.last().taken, later.last().taken);
  }
  EXPECT_TRUE(through.state().q == later.state().q && through.state().nu == later.state().nu);
}

TEST(Integrators, an_accuracy_is_refused_by_name) {
  Settings euler = step_of(1e-3);
  euler.error = 1e-6;
  refused(pendulum(1), euler, "steps of one length");
  refused(pendulum(1), controlled(1e-3, -1), "finite number > 0");
  refused(pendulum(1), controlled(1e-3, std::nan("")), "finite number > 0");
  refused(thrown_box(), controlled(1e-3, 1e-6), "contacts, contact friction");
  Simulation<double> within_rounding(double_pendulum(), controlled(1, 1e-30));
  const StepReport& r = within_rounding.step();
  EXPECT_EQ(r.report.status, Status::not_converged);
  EXPECT_NE(r.message.find("within rounding"), std::string::npos) << r.message;
  EXPECT_EQ(within_rounding.state().steps, 0);
  EXPECT_TRUE(within_rounding.state().q == double_pendulum().q);
}

/// It goes where Euler goes: both have one limit, Euler off by order h.
TEST(Integrators, euler_converges_to_it) {
  const Scene scene = smooth_without_rows();
  const State<double> exact = run(scene, rk(1.0 / 1000), 1000);
  double error[2];
  for (const int k : {0, 1}) error[k] = (run(scene, step_of(1.0 / (4000 << k)), 4000 << k).q - exact.q).norm();
  EXPECT_NEAR(error[0] / error[1], 2, 0.1);
}

TEST(Integrators, parabola_to_rounding) {
  const Scene scene = free_body({0.4, 0.4, 0.4});
  const double h = 0.01, t = 100 * h;
  const State<double> end = run(scene, rk(h), 100);
  const V3 x = V3(scene.q.head<3>()) + t * V3(scene.motion.nu.tail<3>()) + t * t / 2 * V3(0, 0, -9.81);
  EXPECT_LT((V3(end.q.head<3>()) - x).norm() / (eps * 100 * 10), 30);
}

/// The symmetric top: ω turns about the axis of symmetry with (I₃ − I₁) ω₃/I₁ in body axes.
TEST(Integrators, symmetric_top_in_closed_form) {
  Scene scene = free_body({0.2, 0.2, 0.35});
  scene.has_gravity = false;
  const V3 w = scene.motion.nu.head<3>();
  const double t = 2, angle = (0.35 - 0.2) * w[2] / 0.2 * t, h = 1e-3;
  const V3 exact(w[0] * std::cos(angle) - w[1] * std::sin(angle), w[0] * std::sin(angle) + w[1] * std::cos(angle), w[2]);
  const State<double> end = run(scene, rk(h), 2000);
  const double rate = (0.35 - 0.2) * w[2] / 0.2;
  EXPECT_LT((V3(end.nu.head<3>()) - exact).norm(), w.norm() * rate * t * std::pow(rate * h, 4));  // h⁴ f⁽⁵⁾/120 and more
  Observer<double> observe(scene);
  State<double> start;
  start.q = scene.q, start.nu = scene.motion.nu;
  EXPECT_LT((observe(end).angular - observe(start).angular).norm() / observe(start).angular.norm(), std::pow(w.norm() * h, 4) * w.norm() * t);
}

/// Reversing every velocity leads back, of a scene that conserves energy, to order h⁴.
TEST(Integrators, time_reversed) {
  Scene scene = double_pendulum();
  State<double> there = run(scene, rk(1e-3), 1000);
  Scene back = scene;
  back.q = there.q, back.motion.nu = -there.nu;
  const State<double> start = run(back, rk(1e-3), 1000);
  EXPECT_LT((start.q - scene.q).norm(), 1e-8);
  EXPECT_LT((start.nu + scene.motion.nu).norm(), 1e-8);
}

// ---- loops ---------------------------------------------------------------------------------------------------------

/// The time that a slider-crank without forces takes to an angle: ∫ √(I(θ)/2T) dθ, by Simpson's rule; I(θ) from the closed form of its
/// motion and the masses of slider_crank().
double time_to(double r, double l, double from, double to, double rate) {
  const auto inertia = [&](double a) {
    const double s = r * std::sin(a) / l, c = std::sqrt(1 - s * s), b = r * std::cos(a) / (l * c);  // sin β, cos β, dβ/dθ
    const double x = -r * std::sin(a) - l / 2 * s * b, y = r * std::cos(a) - l / 2 * c * b, slider = -r * std::sin(a) - l * s * b;
    return 0.02 + r * r / 4 + 0.03 * b * b + x * x + y * y + 2 * slider * slider;
  };
  const double twice_energy = inertia(from) * rate * rate;
  const auto slowness = [&](double a) { return std::sqrt(inertia(a) / twice_energy); };
  const int n = 4000;
  const double step = (to - from) / n;
  double sum = slowness(from) + slowness(to);
  for (int k = 1; k < n; ++k) sum += (k % 2 ? 4 : 2) * slowness(from + k * step);
  return sum * step / 3;
}

/// Accelerations under the loop's rows: the order is the method's, though every step is brought back onto the loop.
TEST(Integrators, slider_crank_in_closed_form) {
  const double r = 0.3, l = 0.8, rate = 5;
  const Scene scene = slider_crank(r, l, 0.4, rate);
  for (const auto& [integrator, order, coarse] : {std::tuple{"runge_kutta", 4, 64}, {"dormand_prince", 5, 32}}) {
    double error[2];
    for (const int k : {0, 1}) {
      const int steps = coarse << k;
      Settings settings = step_of(1.0 / steps);
      settings.integrator = integrator;
      Simulation<double> s(scene, settings);
      Observer<double> observe(scene);
      for (int step = 0; step < steps; ++step) {
        ASSERT_TRUE(s.step().ok()) << name(s.last().report.status) << " at step " << step;
        EXPECT_LT(s.last().left, 1e-12);
        const double angle = s.state().q[0], beta = std::asin(r * std::sin(angle) / l), turned = s.state().nu[0];
        const double x_rate = -r * turned * std::sin(angle) - r * turned * std::cos(angle) * std::tan(beta);
        EXPECT_LT(std::abs(s.state().nu[2] - x_rate), 1e-9 * rate) << "the accuracy that is asked of the operator is 1e-10";
      }
      EXPECT_GT(s.state().q[0], 3);
      error[k] = std::abs(time_to(r, l, 0.4, s.state().q[0], rate) - 1);
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.5) << integrator << " " << error[0] << " " << error[1];
    EXPECT_LT(error[1], 1e-4) << integrator;
  }
}

/// A free body on a hinge of rows: ω × v of the floating frame is not left out of J̇ν. Against the revolute joint, whose order is four.
TEST(Integrators, rows_on_a_floating_body) {
  const Scene joint = pendulum(1);
  Model m;
  m.add(body("bob", ground, JointType::floating, 1, {0.01, 0.02, 0.03}, {0, 0, -0.5}));
  Constraint hinge;
  hinge.name = "hinge";
  hinge.kind = Constraint::Kind::hinge;
  hinge.a.body = 0, hinge.b.body = ground;
  hinge.a.placement.rotation = hinge.b.placement.rotation = frame_about(V3(0, 1, 0));
  hinge.a.placement.translation = {0.2, 0, -0.3};
  Eigen::Quaterniond turned(Eigen::AngleAxisd(1, V3(0, 1, 0)));
  m.constraints.push_back(hinge);
  Scene rows = scene_of(std::move(m), {0, 0, -9.81});
  const V3 arm(0.2, 0, -0.3), origin = -(turned * arm), omega(0, 2, 0);
  rows.q << origin, turned.w(), turned.x(), turned.y(), turned.z();
  rows.motion.nu << omega, V3(-omega.cross(arm));
  Scene other = joint;  // the same about its pin: the frame of the body moved to the hinge
  other.model.bodies[0].com = V3(0, 0, -0.5) - arm;
  other.motion.nu[0] = 2;
  const State<double> exact = run(other, rk(1.0 / 1600), 1600);
  double error[2];
  for (const int k : {0, 1}) {
    const State<double> end = run(rows, rk(1.0 / (50 << k)), 50 << k);
    ASSERT_GT(end.q.size(), 0);
    error[k] = (V3(end.q.head<3>()) + Eigen::AngleAxisd(exact.q[0], V3(0, 1, 0)) * arm).norm();
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 4, 0.5) << error[0] << " " << error[1];
  EXPECT_LT(error[1], 1e-4);
}

/// A gear and a lock beside everything that acts without rows: Euler goes to the same limit.
TEST(Integrators, euler_converges_to_it_under_rows) {
  Scene scene = everything_smooth();
  scene.motion.motors[0].effort = 1e9;
  const State<double> exact = run(scene, rk(1.0 / 1000), 1000);
  ASSERT_GT(exact.q.size(), 0);
  double error[2];
  for (const int k : {0, 1}) error[k] = (run(scene, step_of(1.0 / (4000 << k)), 4000 << k).q - exact.q).norm();
  EXPECT_NEAR(error[0] / error[1], 2, 0.1);
}

/// Error control goes over loops as it goes without.
TEST(Integrators, controlled_steps_of_a_loop) {
  const double r = 0.3, l = 0.8, rate = 5, asked = 1e-7;
  Simulation<double> s(slider_crank(r, l, 0.4, rate), controlled(1.0 / 8, asked));
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(s.step().ok()) << s.last().message;
  EXPECT_LT(std::abs(time_to(r, l, 0.4, s.state().q[0], rate) - 1) * rate, 30 * asked) << "errors of ν grow with the angle: ½ t² rate";
}

TEST(Integrators, rows_are_refused_by_the_names_of_their_effects) {
  try {
    Simulation<double> s(thrown_box(), rk(1e-3));
    ADD_FAILURE() << "accepted";
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find("contacts, contact friction"), std::string::npos) << e.what();
  }
  Scene soft = slider_crank(0.3, 0.8, 0.4, 5);
  soft.damping = Damping<double>::uniform(3, 1e-4);
  EXPECT_THROW(Simulation<double>(soft, rk(1e-3)), ModelError);
  Settings unknown = step_of(1e-3);
  unknown.integrator = "rk4";
  EXPECT_THROW(Simulation<double>(pendulum(1), unknown), ModelError);
}

}  // namespace
}  // namespace delassus::stepping_integrators_test
