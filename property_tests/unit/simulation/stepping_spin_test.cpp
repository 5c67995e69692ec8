// Torsional and rolling friction against closed forms. Each of these motions is uniformly decelerated in one direction of the cone, so
// that a step of the method is exact in its velocities: what is left is the solver's residual (1e-10 m/s at the arm of the rows, each
// step), and half a step in the time.
#include <gtest/gtest.h>

#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_spin_test {
namespace {

using namespace stepping;

constexpr double g = 9.81, mass = 2, radius = 0.1, I = 0.4 * mass * radius * radius, h = 1e-3;

Scene ball_on_the_ground(double mu, double torsional, double rolling, double slope = 0) {
  Model m;
  m.add(ball("ball", mass, radius));
  Scene s = on_the_ground(std::move(m), {g * std::sin(slope), 0, -g * std::cos(slope)}, mu);
  s.q[2] = radius;
  s.motion.torsional_friction = torsional;
  s.motion.rolling_friction = rolling;
  return s;
}

/// What n steps may be off in an angular velocity: the residual at the arm, and as much again of the body's own.
double off(int n, double arm) { return n * 1e-10 * (1 / arm + 1 / radius); }

Eigen::Quaterniond turned(const State<double>& s) { return Eigen::Quaterniond(s.q[3], s.q[4], s.q[5], s.q[6]).normalized(); }

/// ω falls by c m g/I and is zero from I ω₀/(c m g) on: with and without sliding friction beside it.
TEST(Spin, a_spinning_ball_stops) {
  const double c = 0.02, w0 = 10, rate = c * mass * g / I, end = w0 / rate;
  for (const double mu : {0.5, 0.0}) {
    Scene scene = ball_on_the_ground(mu, c, 0);
    scene.motion.nu[2] = w0;
    Simulation<double> s(scene, step_of(h));
    const double arm = mu > 0 ? c / mu : c;
    const int n = static_cast<int>(end / h), most = n + 20;
    ASSERT_GT(n, 100);
    for (int k = 1; k <= most; ++k) {
      ASSERT_TRUE(s.step().ok()) << s.last().message;
      EXPECT_NEAR(s.state().nu[2], std::max(0.0, w0 - k * h * rate), off(k, arm)) << k;
    }
    EXPECT_LT(V3(s.state().q.head<3>() - V3(0, 0, radius)).norm(), most * h * 1e-9);
  }
}

/// A disc that spins on one point at its centre is held by the same moment: c m g/I with its own inertia.
TEST(Spin, a_spinning_disc_on_a_point_stops) {
  const double c = 0.005, w0 = 3, moment = 0.04;
  Model m;
  m.add(body("disc", ground, JointType::floating, mass, {0.02, 0.02, moment}));
  m.bodies[0].shapes.push_back({Shape::Kind::sphere, V3(0.05, 0, 0), {}, -1, {}});
  Scene scene = on_the_ground(std::move(m), {0, 0, -g}, 0.8);
  scene.q[2] = 0.05;
  scene.motion.nu[2] = w0;
  scene.motion.torsional_friction = c;
  const double rate = c * mass * g / moment;
  const int n = static_cast<int>(0.5 * w0 / rate / h);
  const State<double> half = run(scene, step_of(h), n), stopped = run(scene, step_of(h), 2 * n + 10);
  ASSERT_GT(half.q.size(), 0);
  ASSERT_GT(stopped.q.size(), 0);
  EXPECT_NEAR(half.nu[2], w0 - n * h * rate, off(n, c / 0.8));
  EXPECT_NEAR(stopped.nu[2], 0, off(2 * n, c / 0.8));
}

/// Rolling that is decelerated creeps by s = u_t/(r ω), the root of k μ² s² + (k μ² − k ρ²/r² + μ²) s − k ρ²/r² = 0, k = m r²/I:
/// then m (1 + s) r ω' = −μ² s r N/D, I ω' = (μ² s r² − ρ²) N/D with D = √(μ² s² r² + ρ²), uniformly. For ρ ≪ μ r that is
/// the textbook's (1 + s) r ω' = −ρ g m r/(I + m r²), to the order (ρ/(μ r))².
TEST(Spin, a_rolling_ball_slows_down) {
  const double mu = 0.5, rho = 0.004, w0 = 20, k = mass * radius * radius / I;
  const double a = k * mu * mu, b = a - k * rho * rho / (radius * radius) + mu * mu, c = -k * rho * rho / (radius * radius);
  const double s = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a), D = std::sqrt(mu * mu * s * s * radius * radius + rho * rho);
  const double rate = (mu * mu * s * radius * radius - rho * rho) * mass * g / (I * D), deceleration = (1 + s) * radius * rate;
  const double textbook = -rho * g * mass * radius / (I + mass * radius * radius);
  EXPECT_NEAR(deceleration / textbook, 1, 2 * rho * rho / (mu * mu * radius * radius));
  Scene scene = ball_on_the_ground(mu, 0, rho);
  scene.motion.nu << 0, w0, 0, (1 + s) * radius * w0, 0, 0;
  Simulation<double> run(scene, step_of(h));
  const int stop = static_cast<int>(-w0 / rate / h);
  ASSERT_GT(stop, 100);
  for (int step = 1; step <= stop + 100; ++step) {
    ASSERT_TRUE(run.step().ok()) << run.last().message;
    const V3 v = turned(run.state()) * V3(run.state().nu.tail<3>());
    EXPECT_NEAR(run.state().nu[1], std::max(0.0, w0 + step * h * rate), off(step, rho / mu)) << step;
    EXPECT_NEAR(v[0], std::max(0.0, (1 + s) * radius * (w0 + step * h * rate)), radius * off(step, rho / mu)) << step;
  }
  const double way = 0.5 * (1 + s) * radius * w0 * w0 / -rate;
  EXPECT_NEAR(run.state().q[0], way, (1 + s) * radius * w0 * h);  // a step
}

/// On a slope it stays where (tan α/μ)² + (r tan α/ρ)² < 1, and rolls where that is above 1.
TEST(Spin, a_ball_rests_on_a_slope) {
  const double mu = 0.5, rho = 0.005, steepest = 1 / std::hypot(1 / mu, radius / rho);
  const int n = 300;
  const State<double> rests = run(ball_on_the_ground(mu, 0, rho, std::atan(0.95 * steepest)), step_of(h), n);
  const State<double> rolls = run(ball_on_the_ground(mu, 0, rho, std::atan(1.05 * steepest)), step_of(h), n);
  ASSERT_GT(rests.q.size(), 0);
  ASSERT_GT(rolls.q.size(), 0);
  EXPECT_LT(std::abs(rests.q[0]), n * h * radius * off(1, rho / mu));
  EXPECT_GT(rolls.nu[1], 100 * off(n, rho / mu));
}

/// Between two bodies the moment acts on both: a ball that spins on another that may turn gives it its angular momentum.
TEST(Spin, angular_momentum_goes_over) {
  Model m;
  Body lower = ball("lower", mass, radius);
  lower.joint.type = JointType::revolute;
  lower.joint.axis = {0, 0, 1};
  m.add(std::move(lower));
  m.add(ball("upper", mass, radius));
  Scene scene = scene_of(std::move(m), {0, 0, -g});
  scene.motion.detects = true;
  scene.motion.friction = 0.5;
  scene.motion.torsional_friction = 0.02;
  scene.motion.search.object = {0, 1};
  scene.q[1 + 2] = 2 * radius;
  scene.motion.nu[1 + 2] = 10;
  const State<double> end = run(scene, step_of(h), 300);
  ASSERT_GT(end.q.size(), 0);
  EXPECT_NEAR(end.nu[0], 5, off(300, 0.02 / 0.5));
  EXPECT_NEAR(end.nu[3], 5, off(300, 0.02 / 0.5));
}

}  // namespace
}  // namespace delassus::stepping_spin_test
