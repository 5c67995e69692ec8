// Implicit integrators of higher order: order measured, stiff scenes, energy over long times, bits, refusals.
#include <gtest/gtest.h>

#include <tuple>

#include "property_tests/unit/simulation/absence.h"
#include "simulation/runge_kutta.h"

namespace delassus::stepping_implicit_test {
namespace {

using namespace stepping;

constexpr double eps = 0x1p-53;

Settings by(const std::string& integrator, double h) {
  Settings s = step_of(h);
  s.integrator = integrator;
  return s;
}

// ---- order on scenes -------------------------------------------------------------------------------------------------

/// A free trunk with an arm and everything that acts without rows.
Scene smooth_without_rows() {
  Scene s = everything_smooth();
  s.model.constraints.clear();
  s.damping = {};
  s.motion.motors[0].effort = 1e9;
  return s;
}
Scene smooth_under_rows() {
  Scene s = everything_smooth();
  s.motion.motors[0].effort = 1e9;
  return s;
}
/// On a ball joint, turning about no axis of its own: ẋ is not ω.
Scene spherical_pendulum() {
  Model m;
  m.add(body("bob", ground, JointType::spherical, 1, {0.01, 0.02, 0.03}, {0.05, 0, -0.5}));
  m.bodies[0].joint.damping = {0.02, 0.02, 0.02};
  Scene s = scene_of(std::move(m), {0, 0, -9.81});
  s.motion.nu << 1, 2, -4;
  return s;
}

/// Dampers of all six degrees of freedom, in axes that turn with the body.
Scene damped_flight() {
  Scene s = free_body({0.1, 0.2, 0.25});
  s.model.bodies[0].joint.damping = {0.1, 0.05, 0.2, 3, 1, 0.5};
  return s;
}

/// They go where the explicit one goes, and with the declared order: fixed base, free flight, ball joint, springs, dampers and motors on a
/// floating base, a gear and a lock there, a loop.
TEST(Implicit, order_is_the_declared_one) {
  const std::vector<std::pair<const char*, Scene>> scenes{{"double pendulum", double_pendulum()}, {"free body", free_body({0.1, 0.2, 0.25})}, {"ball joint", spherical_pendulum()}, {"damped flight", damped_flight()},
                                                          {"smooth", smooth_without_rows()},      {"rows", smooth_under_rows()},             {"slider-crank", slider_crank(0.3, 0.8, 0.4, 5)}};
  for (const auto& [what, scene] : scenes) {
    const State<double> exact = run(scene, by("dormand_prince", 1.0 / 1600), 1600);
    ASSERT_GT(exact.q.size(), 0);
    for (const auto& [integrator, order, coarse] : {std::tuple{"implicit_midpoint", 2, 200}, {"sdirk4", 4, 50}}) {
      double error[2];
      for (const int k : {0, 1}) {
        const State<double> end = run(scene, by(integrator, 1.0 / (coarse << k)), coarse << k);
        ASSERT_GT(end.q.size(), 0) << what << integrator;
        error[k] = (end.q - exact.q).norm() + (end.nu - exact.nu).norm();
      }
      EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.3) << what << " " << integrator << " " << error[0] << " " << error[1];
      EXPECT_LT(error[1], 2e-3) << what << " " << integrator;
    }
  }
}

// ---- stiff -----------------------------------------------------------------------------------------------------------

/// A mass on a spring and a damper, along x.
Scene oscillator(double stiffness, double damping) {
  Model m;
  m.add(body("mass", ground, JointType::prismatic, 2, {1, 1, 1}, {0, 0, 0}, {1, 0, 0}));
  Scene s = scene_of(std::move(m));
  s.q[0] = 0.3, s.motion.nu[0] = 0.7;
  s.motion.springs.push_back({0, 0, stiffness, 0, damping, "scene:1"});
  return s;
}

/// (x, v) after steps of the tableau on the linear system, stage by stage in wider arithmetic; last, what rounding is measured by: terms of
/// every step, carried on by powers of R, which grow as 1 + 4 n where R(∞) = −1.
std::array<long double, 3> linear_steps(const Tableau& t, long double h, long double k, long double d, std::array<long double, 3> y, int steps) {
  long double weights = 1;
  for (int i = 0; i < t.stages; ++i) weights += std::abs(t.b[i]);
  for (int n = 0; n < steps; ++n) {
    y[2] += (1 + 4 * (steps - n)) * weights * (std::abs(y[0]) + h * std::abs(y[1]));
    std::array<long double, 7> kx{}, kv{};
    for (int i = 0; i < t.stages; ++i) {
      long double x = y[0], v = y[1];
      for (int j = 0; j < i; ++j) x += h * t.a[i][j] * kx[j], v += h * t.a[i][j] * kv[j];
      const long double g = h * t.a[i][i];
      kv[i] = -(k * (x + g * v) + d * v) / (1 + g * d + g * g * k);
      kx[i] = v + g * kv[i];
    }
    for (int i = 0; i < t.stages; ++i) y[0] += h * t.b[i] * kx[i], y[1] += h * t.b[i] * kv[i];
  }
  return y;
}

/// What is linear is solved at once: the step is the tableau's, to rounding, for h ω to 10⁶. There the explicit ones blow up.
TEST(Implicit, stiff_springs_and_dampers_to_rounding) {
  const double h = 0.01, mass = 2;
  for (const double h_omega : {0.1, 1.0, 1e3, 1e6})
    for (const double ratio : {0.0, 0.1, 10.0}) {  // of the critical damping
      const double omega = h_omega / h, k = mass * omega * omega, d = 2 * ratio * mass * omega;
      const Scene scene = oscillator(k, d);
      for (const auto& [integrator, tableau] : {std::pair{"implicit_midpoint", &implicit_midpoint()}, {"sdirk4", &sdirk4()}}) {
        for (const int steps : {1, 20}) {
          const State<double> end = run(scene, by(integrator, h), steps);
          ASSERT_GT(end.q.size(), 0) << integrator;
          const auto exact = linear_steps(*tableau, h, k / mass, d / mass, {scene.q[0], scene.motion.nu[0], 0}, steps);
          const auto size = static_cast<double>(exact[2]);
          EXPECT_LT(std::abs(end.q[0] - static_cast<double>(exact[0])) / (eps * size), 30) << integrator << " " << h_omega << " " << ratio;
          EXPECT_LT(h * std::abs(end.nu[0] - static_cast<double>(exact[1])) / (eps * size), 30) << integrator << " " << h_omega << " " << ratio;
        }
      }
      if (h_omega < 1e3) continue;
      const State<double> gone = run(scene, by("sdirk4", h), 2);
      EXPECT_LT(std::abs(gone.q[0]), 100 / h_omega * std::abs(scene.q[0])) << "L-stable";
      const State<double> up = run(scene, by("runge_kutta", h), 20);
      EXPECT_TRUE(up.q.size() == 0 || !(std::abs(up.q[0]) < 1e30));
    }
}

/// A double pendulum whose lower joint is held by a spring and a damper of this frequency, about; locked: by a row.
Scene held_pendulum(double omega, bool locked = false) {
  const double inertia = 0.1;  // of the lower body about its joint, about
  Scene s = double_pendulum();
  s.motion.nu[1] = 0;
  if (!locked) {
    s.motion.springs.push_back({1, 0, inertia * omega * omega, s.q[1], 0.2 * inertia * omega, "scene:1"});
    return s;
  }
  Constraint lock;
  lock.name = "lock";
  lock.kind = Constraint::Kind::joint_lock;
  lock.a.body = 1;
  s.model.constraints.push_back(lock);
  s.damping = Damping<double>::uniform(1, 0);
  return s;
}

/// That of a locked joint in the limit, with order 4 though h ω = 10³ … 10⁶.
TEST(Implicit, a_stiff_joint_is_a_locked_one) {
  const State<double> exact = run(held_pendulum(0, true), by("dormand_prince", 1.0 / 800), 800);
  ASSERT_GT(exact.q.size(), 0);
  for (const double h_omega : {1e3, 1e6}) {
    double error[2], speed[2];
    for (const int k : {0, 1}) {
      const int steps = 20 << k;
      const Scene stiff = held_pendulum(h_omega * steps);
      const State<double> end = run(stiff, by("sdirk4", 1.0 / steps), steps);
      ASSERT_GT(end.q.size(), 0);
      error[k] = std::abs(end.q[0] - exact.q[0]) + std::abs(end.nu[0] - exact.nu[0]);
      speed[k] = std::abs(end.nu[1]);
      const State<double> up = run(stiff, by("runge_kutta", 1.0 / steps), steps);
      EXPECT_TRUE(up.q.size() == 0 || !(up.q.norm() < 1e3));
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 4, 0.5) << h_omega << " " << error[0] << " " << error[1];
    EXPECT_LT(error[1], 1e-4);
    EXPECT_LT(speed[1], 1e-4) << h_omega;
  }
}

/// Once the spring is where its force is (a few long steps), steps of the pair follow the motion: what they add is what was asked, their number
/// grows as tolerance^(−1/3), and the explicit pair takes a hundred times as many. Below rounding of the spring's force it is refused.
TEST(Implicit, steps_of_a_stiff_scene_follow_their_error) {
  Scene stiff = held_pendulum(1e5), locked = held_pendulum(0, true);  // its deflection is below 1e-8
  const State<double> settled = run(stiff, by("sdirk4", 0.01), 5);
  ASSERT_GT(settled.q.size(), 0);
  stiff.q = locked.q = settled.q, stiff.motion.nu = locked.motion.nu = settled.nu;
  const State<double> exact = run(locked, by("dormand_prince", 1.0 / 800), 800);
  const auto taken = [&](const char* integrator, double asked, double t, State<double>& end) {
    Settings settings = by(integrator, t);
    settings.error = asked;
    Simulation<double> s(stiff, settings);
    const StepReport& r = s.step();
    EXPECT_TRUE(r.ok()) << r.message;
    EXPECT_LE(r.error, asked);
    end = s.state();
    return r.taken;
  };
  int steps[2];
  for (const int k : {0, 1}) {
    State<double> end;
    const double asked = k ? 1e-4 / 27 : 1e-4;
    steps[k] = taken("sdirk4", asked, 1, end);
    EXPECT_LT(std::abs(end.q[0] - exact.q[0]) + std::abs(end.nu[0] - exact.nu[0]), 10 * asked);
  }
  EXPECT_NEAR(double(steps[1]) / steps[0], 3, 0.6) << steps[0] << " " << steps[1];
  State<double> end;
  EXPECT_GT(100 * taken("dormand_prince", 1e-4, 0.01, end), 100 * steps[0]);
  Settings settings = by("sdirk4", 0.01);
  settings.error = 1e-16;
  Simulation<double> below(stiff, settings);
  EXPECT_EQ(below.step().report.status, Status::not_converged);
  EXPECT_NE(below.last().message.find("within rounding"), std::string::npos) << below.last().message;
}

/// A motor stiffer than the inertia it moves, at its effort on the way to its target: between cut and not cut no stage goes in circles.
TEST(Implicit, a_stiff_motor_at_its_effort) {
  for (const char* integrator : {"implicit_midpoint", "sdirk4"}) {
    Scene s = double_pendulum();
    s.motion.motors.push_back({0, 0, 0, 1e5, 1e3, 0, 20, "scene:1"});
    s.motion.motors.push_back({1, 0, 0, 1e5, 1e3, 0, 5, "scene:2"});
    Simulation<double> run_(s, by(integrator, 0.01));
    for (int k = 0; k < 500; ++k) ASSERT_TRUE(run_.step().ok()) << integrator << " step " << k << ": " << run_.last().message;
    if (std::string(integrator) == "sdirk4") {
      EXPECT_LT(run_.state().q.norm() + run_.state().nu.norm(), 1e-3);
    }
  }
}

// ---- long times ------------------------------------------------------------------------------------------------------

/// Largest |E − E₀|/scale in the first and in the last tenth of the steps.
std::array<double, 2> energy_errors(const Scene& scene, const Settings& settings, int steps) {
  Simulation<double> s(scene, settings);
  Observer<double> observe(scene);
  const double start = observe(s.state()).energy();
  std::array<double, 2> out{};
  for (int k = 0; k < steps; ++k) {
    if (!s.step().ok()) {
      ADD_FAILURE() << "step " << k << ": " << s.last().message;
      return out;
    }
    if (k >= steps / 10 && k < steps - steps / 10) continue;
    double& of = out[k < steps / 10 ? 0 : 1];
    of = std::max(of, std::abs(observe(s.state()).energy() - start));
  }
  return out;
}

/// Masses in series, springs between them.
Scene spring_chain() {
  Model m;
  for (Index i = 0; i < 5; ++i) m.add(body("mass " + std::to_string(i), i - 1, JointType::prismatic, 1, {1, 1, 1}, {0, 0, 0}, {1, 0, 0}));
  Scene s = scene_of(std::move(m));
  s.q << 0.1, -0.2, 0.1, 0, 0.3;
  s.motion.nu << 0, 1, 0, -1, 0.5;
  for (Index i = 0; i < 5; ++i) s.motion.springs.push_back({i, 0, 20.0 + 10 * double(i), 0, 0, "scene:1"});
  return s;
}

constexpr int long_run = 100000;

/// A pendulum to 2 rad: the energy swings in h² and stays, that of the explicit method is lost step by step.
TEST(Implicit, energy_of_a_pendulum_does_not_drift) {
  const double h = 0.05;
  const auto midpoint = energy_errors(pendulum(2), by("implicit_midpoint", h), long_run), half = energy_errors(pendulum(2), by("implicit_midpoint", h / 2), long_run / 10);
  EXPECT_LT(midpoint[1], 1.01 * midpoint[0]);
  EXPECT_NEAR(midpoint[0] / half[0], 4, 0.4);
  const auto classical = energy_errors(pendulum(2), by("runge_kutta", h), long_run);
  EXPECT_GT(classical[1], 5 * classical[0]) << "the judge sees a drift";
}

/// Quadratic: kept to what the iteration leaves.
TEST(Implicit, quadratic_invariants_are_kept) {
  Scene top = free_body({0.1, 0.2, 0.25});
  top.has_gravity = false;
  for (const Scene& scene : {top, spring_chain()}) {
    Observer<double> observe(scene);
    State<double> start;
    start.q = scene.q, start.nu = scene.motion.nu;
    const double energy = observe(start).energy();
    const auto midpoint = energy_errors(scene, by("implicit_midpoint", 0.05), long_run);
    EXPECT_LT(midpoint[1] / energy, long_run * 2 * eps);
    const auto classical = energy_errors(scene, by("runge_kutta", 0.05), long_run / 10);
    EXPECT_GT(classical[1] / energy, 1e-6) << "the judge sees a drift";
  }
  const State<double> end = run(top, by("implicit_midpoint", 0.05), long_run / 10);
  const V3 I(0.1, 0.2, 0.25);
  const double momentum = I.cwiseProduct(V3(top.motion.nu.head<3>())).norm();
  EXPECT_LT(std::abs(I.cwiseProduct(V3(end.nu.head<3>())).norm() / momentum - 1), long_run / 10 * 2 * eps);
}

/// Symmetric: with every velocity reversed it goes back where it came from, at a step at which the explicit method does not.
TEST(Implicit, midpoint_goes_back_where_it_came_from) {
  for (const auto& [integrator, back] : {std::pair{"implicit_midpoint", true}, {"runge_kutta", false}, {"sdirk4", false}}) {
    Scene scene = double_pendulum();
    const State<double> there = run(scene, by(integrator, 0.02), 200);
    ASSERT_GT(there.q.size(), 0);
    Scene reversed = scene;
    reversed.q = there.q, reversed.motion.nu = -there.nu;
    const State<double> start = run(reversed, by(integrator, 0.02), 200);
    const double off = (start.q - scene.q).norm() + (start.nu + scene.motion.nu).norm();
    EXPECT_EQ(off < 1e-10, back) << integrator << " " << off;
  }
}

// ---- bits, cost, refusals --------------------------------------------------------------------------------------------

TEST(Implicit, a_run_that_goes_on_repeats_every_bit) {
  Settings controlled = by("sdirk4", 0.1);
  controlled.error = 1e-6;
  for (const Settings& settings : {by("implicit_midpoint", 0.01), by("sdirk4", 0.01), controlled})
    for (const Scene& scene : {smooth_without_rows(), smooth_under_rows(), slider_crank(0.3, 0.8, 0.4, 5)}) {
      Simulation<double> through(scene, settings);
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(through.step().ok());
      Simulation<double> later(scene, settings);
      for (int k = 0; k < 3; ++k) ASSERT_TRUE(later.step().ok());  // what ran before does not matter
      later.restore(through.state());
      for (int k = 0; k < 20; ++k) {
        ASSERT_TRUE(through.step().ok());
        ASSERT_TRUE(later.step().ok());
        EXPECT_EQ(through.last().iterations, later.last().iterations);
      }
      EXPECT_TRUE(through.state().q == later.state().q && through.state().nu == later.state().nu);
      EXPECT_LE(through.last().residual, RungeKutta<double>::within);
      EXPECT_GT(through.last().iterations, 0);
    }
}

/// An iteration costs an evaluation of the explicit method, and what M̂ and its end ask for of every degree of freedom.
TEST(Implicit, iterations_cost_evaluations) {
  const Scene scene = smooth_without_rows();
  Simulation<double> s(scene, by("sdirk4", 0.01));
  ASSERT_TRUE(s.step().ok());
  const double iterations = s.last().iterations;
  EXPECT_GE(iterations, 10);
  EXPECT_LE(iterations, 40);
  const double evaluation = static_cast<double>(operations(scene, by("runge_kutta", 0.01), 1)) / 4, iteration = static_cast<double>(operations(scene, by("sdirk4", 0.01), 1)) / iterations;
  EXPECT_GT(iteration, evaluation);
  EXPECT_LT(iteration, 1.15 * evaluation);
}

/// What a scene does not call for has no bit and no operation in stages either.
TEST(Implicit, absent_is_absent_in_stages) {
  const Scene scene = smooth_under_rows();
  for (const char* effect : {"gravity", "springs", "joint damping", "motors", "armature", "wrenches", "couplings"}) {
    Settings without = by("sdirk4", 1e-3), program = without;
    const std::vector<EffectRow> smaller = table_without(effect);
    without.without = {effect};
    program.table = &smaller;
    Scene bare = scene;
    never_written(effect, bare);
    const State<double> end = run(scene, without, 5);
    for (const State<double>& other : {run(scene, program, 5), run(bare, by("sdirk4", 1e-3), 5)}) EXPECT_TRUE(other.q.size() > 0 && end.q == other.q && end.nu == other.nu) << effect;
    EXPECT_EQ(operations(scene, without, 2), operations(bare, by("sdirk4", 1e-3), 2)) << effect;
  }
}

TEST(Implicit, what_it_does_not_take_is_refused) {
  for (const char* integrator : {"implicit_midpoint", "sdirk4"}) {
    refused(thrown_box(), by(integrator, 1e-3), "contacts, contact friction");
    Scene soft = slider_crank(0.3, 0.8, 0.4, 5);
    soft.damping = Damping<double>::uniform(3, 1e-4);
    refused(soft, by(integrator, 1e-3), "hard rows only");
  }
  Settings controlled = by("implicit_midpoint", 1e-3);
  controlled.error = 1e-6;
  refused(pendulum(1), controlled, "steps of one length");
}

/// ẍ = −c x with nothing of it in M̂: changes fall by (h/2)² c. Too slowly: the attempt fails, and what it says is what it saw.
TEST(Implicit, a_slow_stage_is_not_taken) {
  Model m;
  m.add(body("mass", ground, JointType::prismatic, 1, {1, 1, 1}));
  for (const auto& [factor, ends] : {std::pair{0.1, true}, {0.4, true}, {0.9, false}, {1.1, false}}) {
    RungeKutta<double> method(m, implicit_midpoint());
    State<double> s;
    s.q = VectorX<double>{{1.5}}, s.nu = VectorX<double>{{0.5}};
    method.start(s);
    const double c = factor;
    EXPECT_EQ(method.attempt(2, [c](const State<double>& at, const RungeKutta<double>::Stage&, VectorX<double>& a) {
      a = VectorX<double>{{-c * at.q[0]}};
      return true;
    }), ends) << factor;
    if (ends) {
      EXPECT_NEAR(method.iterations(), std::log(eps) / std::log(factor), 4) << factor;
      EXPECT_LE(method.left(), RungeKutta<double>::within);
    } else {
      EXPECT_EQ(method.iterations(), RungeKutta<double>::most_iterations);
      EXPECT_GT(method.change(), 1e-4);
      EXPECT_EQ(method.stage(), 0);
    }
  }
}

/// A step in which the scene turns many times over: the run ends, says which stage and what to do, and stands where it was.
TEST(Implicit, a_stage_that_does_not_converge_ends_the_run) {
  for (const char* integrator : {"implicit_midpoint", "sdirk4"}) {
    const Scene scene = double_pendulum();
    Simulation<double> s(scene, by(integrator, 20));
    const StepReport& r = s.step();
    EXPECT_EQ(r.report.status, Status::not_converged);
    EXPECT_NE(r.message.find("stage 1 of " + std::string(integrator) + " does not converge"), std::string::npos) << r.message;
    EXPECT_NE(r.message.find("a smaller step than 20 s"), std::string::npos) << r.message;
    EXPECT_EQ(s.state().steps, 0);
    EXPECT_TRUE(s.state().q == scene.q && s.state().nu == scene.motion.nu);
  }
}

}  // namespace
}  // namespace delassus::stepping_implicit_test
