// Integrators of higher order: the order measured, closed forms, and what they refuse.
#include <gtest/gtest.h>

#include "property_tests/unit/stepping_scenes.h"

namespace delassus {
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

TEST(Integrators, rows_are_refused_by_the_names_of_their_effects) {
  try {
    Simulation<double> s(thrown_box(), rk(1e-3));
    ADD_FAILURE() << "accepted";
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find("contacts, contact friction"), std::string::npos) << e.what();
  }
  EXPECT_THROW(Simulation<double>(slider_crank(0.3, 0.8, 0.4, 5), rk(1e-3)), ModelError);
  Settings unknown = step_of(1e-3);
  unknown.integrator = "rk4";
  EXPECT_THROW(Simulation<double>(pendulum(1), unknown), ModelError);
}

}  // namespace
}  // namespace delassus
