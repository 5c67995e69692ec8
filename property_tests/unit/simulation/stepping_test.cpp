// Stepping a scene: physics in closed form, with tolerances from the order of the integrator and its step.
#include <gtest/gtest.h>

#include "algorithms/dynamics/dynamics.h"
#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_test {
namespace {

using namespace stepping;

constexpr double eps = 0x1p-53;

Matrix3<double> rotation_of(const State<double>& s) { return Eigen::Quaterniond(s.q[3], s.q[4], s.q[5], s.q[6]).normalized().toRotationMatrix(); }

// ---- exact in the step's own order -------------------------------------------------------------------------------

/// v = v₀ + n h g, x = x₀ + n h v₀ + g h² n (n + 1)/2, to rounding, however the body turns: cube (nothing but gravity is in the plan)
/// and brick.
TEST(Stepping, free_fall_and_parabola) {
  for (const V3& moments : {V3(0.4, 0.4, 0.4), V3(0.1, 0.2, 0.25)}) {
    const Scene scene = free_body(moments);
    const double h = 1e-3;
    const int n = 2000;
    const State<double> end = run(scene, step_of(h), n);
    const V3 x0 = scene.q.head<3>(), v0 = scene.motion.nu.tail<3>(), t = V3(0, 0, -9.81) * h;
    const V3 v = v0 + n * t, x = x0 + n * h * v0 + t * (h * n * (n + 1) / 2);
    const V3 got = rotation_of(end) * end.nu.tail<3>();
    const double speed = 30, way = 30;
    EXPECT_LT((got - v).norm() / (eps * n * speed), 30);
    EXPECT_LT((V3(end.q.head<3>()) - x).norm() / (eps * n * way), 30);
  }
}

/// Implicit in spring and damper: (m + h d + h² k) v⁺ = m v − h k x, x⁺ = x + h v⁺, by other lines.
TEST(Stepping, spring_mass_damper_is_implicit_euler) {
  Model m;
  m.add(body("mass", ground, JointType::prismatic, 2, {1, 1, 1}));
  m.bodies[0].joint.damping = {0.5};
  Scene scene = scene_of(std::move(m));
  scene.q[0] = 0.1;
  scene.motion.springs.push_back({0, 0, 50, 0.02, 0.25, ""});
  for (const double h : {1e-3, 0.1, 1e6}) {
    double x = 0.1, v = 0;
    for (int k = 0; k < 100; ++k) {
      v = (2 * v - h * 50 * (x - 0.02)) / (2 + h * 0.75 + h * h * 50);
      x += h * v;
    }
    const State<double> end = run(scene, step_of(h), 100);
    EXPECT_LT(std::abs(end.q[0] - x) / (eps * 100 * 0.1), 30) << h;
  }
}

// ---- closed forms, to first order --------------------------------------------------------------------------------

double period(double angle, double h) {
  Simulation<double> s(pendulum(angle), step_of(h));
  double last = 0, before = angle, first = -1;
  for (int k = 1; k < 2000000; ++k) {
    if (!s.step().ok()) return NAN;
    const double now = s.state().q[0];
    if (before < 0 && now >= 0) {
      last = h * (k - now / (now - before));
      if (first >= 0) return last - first;
      first = last;
    }
    before = now;
  }
  return NAN;
}

/// T = 4 √(I/(m g l)) K(sin θ₀/2). The method is conjugate to the leapfrog: of order 2 in the period, with an amplitude that is off by
/// order h; T grows by less than its half per radian of amplitude below two.
TEST(Stepping, pendulum_period_is_the_elliptic_integral) {
  const double angle = 2.0, I = 0.02 + 0.25, w = std::sqrt(9.81 * 0.5 / I);
  const double exact = 4 / w * std::comp_ellint_1(std::sin(angle / 2));
  const double coarse = std::abs(period(angle, 2e-3) - exact), fine = std::abs(period(angle, 1e-3) - exact);
  EXPECT_LT(coarse / exact, 2e-3 * w);
  EXPECT_LT(fine / exact, 1e-3 * w);
  EXPECT_GT(coarse / fine, 1.7);
}

/// Euler's equations by a method of order four and small steps.
V3 euler_top(V3 w, const V3& I, double t, int n) {
  const auto rate = [&](const V3& x) { return V3(-x.cross(V3(I.cwiseProduct(x)))).cwiseQuotient(I).eval(); };
  const double h = t / n;
  for (int k = 0; k < n; ++k) {
    const V3 a = rate(w), b = rate(w + h / 2 * a), c = rate(w + h / 2 * b), d = rate(w + h * c);
    w += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return w;
}

TEST(Stepping, torque_free_top_converges_with_order_one) {
  const V3 I(0.1, 0.2, 0.25);
  Scene scene = free_body(I);
  scene.has_gravity = false;
  const V3 exact = euler_top(scene.motion.nu.head<3>(), I, 2, 20000);
  Observer<double> observe(scene);
  State<double> start;
  start.q = scene.q, start.nu = scene.motion.nu;
  const auto before = observe(start);
  double error[2], energy[2], spin[2];
  for (const int k : {0, 1}) {
    const State<double> end = run(scene, step_of(k ? 2.5e-4 : 5e-4), k ? 8000 : 4000);
    const auto after = observe(end);
    error[k] = (end.nu.head<3>() - exact).norm();
    energy[k] = after.kinetic - before.kinetic;
    spin[k] = (after.angular - before.angular).norm();
    EXPECT_LT((after.linear - before.linear).norm() / (eps * 8000 * before.linear.norm()), 30);
  }
  for (const double* e : {error, energy, spin}) EXPECT_NEAR(e[0] / e[1], 2, 0.1);
  EXPECT_LT(error[1], 0.05 * exact.norm());
}

TEST(Stepping, order_of_convergence_is_one) {
  const Scene scene = double_pendulum();
  const State<double> exact = run(scene, step_of(1.0 / 65536), 65536);
  double error[3];
  for (const int k : {0, 1, 2}) error[k] = (run(scene, step_of(1.0 / (512 << k)), 512 << k).q - exact.q).norm();
  // the fine run is off by 1/64 and 1/32 of these
  EXPECT_NEAR(error[0] / error[1], 2, 0.25);
  EXPECT_NEAR(error[1] / error[2], 2, 0.25);
}

/// x = r cos θ + √(l² − r² sin² θ) after every step to what closing leaves; without forces the energy drifts with order h.
TEST(Stepping, slider_crank) {
  const double r = 0.3, l = 0.8;
  const Scene scene = slider_crank(r, l, 0.4, 5);
  double drift[2];
  for (const int k : {0, 1}) {
    Simulation<double> s(scene, step_of(k ? 5e-4 : 1e-3));
    Observer<double> observe(scene);
    const double before = observe(s.state()).kinetic;
    for (int step = 0; step < (k ? 2000 : 1000); ++step) {
      ASSERT_TRUE(s.step().ok()) << name(s.last().report.status) << " at step " << step;
      const double angle = s.state().q[0], x = r * std::cos(angle) + std::sqrt(l * l - r * r * std::sin(angle) * std::sin(angle));
      ASSERT_LT(std::abs(s.state().q[2] - x), 1e-11) << step;  // 1e-12 and the slope of the closed form
    }
    EXPECT_GT(std::abs(s.state().q[0] - 0.4), 3);
    drift[k] = std::abs(observe(s.state()).kinetic - before) / before;
    EXPECT_LT(drift[k], 0.05);
  }
  EXPECT_LT(drift[1], drift[0]);
}

// ---- balance and symmetry ----------------------------------------------------------------------------------------

/// M̂ (ν⁺ − ν) = h (τ − c) + Jᵀλ with c of rnea, M by crba: routes the step does not take. ω × v of the floating base is h times the
/// turn of its axes (docs/simulation.md).
TEST(Stepping, momentum_balance_of_every_step) {
  Scene scene = everything_smooth();
  scene.motion.springs.clear(), scene.motion.motors.clear(), scene.motion.wrenches.clear();
  scene.model.bodies[1].joint.damping.clear();
  const double h = 1e-2;
  Simulation<double> s(scene, step_of(h));
  Dynamics<double> dynamics(scene.model, scene.gravity);
  for (int step = 0; step < 50; ++step) {
    const State<double> before = s.state();
    ASSERT_TRUE(s.step().ok()) << name(s.last().report.status);
    const Report report = dynamics.update(before.q, before.nu, scene.damping);
    ASSERT_TRUE(report.ok());
    VectorX<double> change = s.change();
    change.segment<3>(3) -= h * V3(before.nu.head<3>()).cross(V3(before.nu.segment<3>(3)));
    MatrixX<double> M;
    dynamics.crba(M);
    TreeOperators<double> tree(dynamics.problem().structure);
    ASSERT_TRUE(tree.update(dynamics.problem()).ok());
    MatrixX<double> impulse(s.impulses().size(), 1), push(M.rows(), 1), nu(M.rows(), 1), rate(impulse.rows(), 1);
    impulse.col(0) = s.impulses();
    tree.J_transposed(impulse, push);
    const VectorX<double> off = M * change + h * dynamics.bias_forces() - push.col(0);
    const double size = M.cwiseAbs().maxCoeff() * change.cwiseAbs().sum() + impulse.cwiseAbs().sum();
    EXPECT_LT(off.norm(), 1e-9 * size);  // the accuracy that is asked of the operator is 1e-10
    nu.col(0) = before.nu + s.change();
    tree.J(nu, rate);
    EXPECT_LT(rate.norm(), 1e-9);
  }
}

TEST(Stepping, dissipation_and_conservation) {
  Scene scene = double_pendulum();
  scene.model.bodies[0].joint.damping = {0.2};
  Observer<double> observe(scene);
  Simulation<double> damped(scene, step_of(1e-4));
  const double start = observe(damped.state()).energy();
  double last = start;
  for (int k = 0; k < 100; ++k) {
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(damped.step().ok());
    const double now = observe(damped.state()).energy();
    EXPECT_LT(now, last + 1e-4 * std::abs(start));  // order h of the explicit part within 0.01 s
    last = now;
  }
  EXPECT_LT(last, start - 0.1);
}

/// A robot 2²⁰ m away moves by the same bits.
TEST(Stepping, translation_changes_no_bit_of_the_velocities) {
  Scene near = everything_smooth(), far = near;
  near.q.head<3>() << 0, 0, 0;
  far.q.head<3>() << 0x1p20, -0x1p21, 0x1p20;
  const State<double> a = run(near, step_of(0x1p-10), 200), b = run(far, step_of(0x1p-10), 200);
  ASSERT_GT(a.nu.size(), 0);
  EXPECT_TRUE(a.nu == b.nu);
  EXPECT_TRUE(a.q.tail<7>() == b.q.tail<7>());
}

/// Lengths in units of 2 m, masses in units of 8 kg, the second as it is: every bit of the angles is the same.
TEST(Stepping, units_of_powers_of_two_change_no_bit) {
  Scene a = double_pendulum(), b = a;
  for (Body& body : b.model.bodies) {
    body.mass *= 8;
    body.com *= 2;
    body.inertia *= 32;
    body.joint.placement.translation *= 2;
  }
  b.gravity *= 2;
  const State<double> x = run(a, step_of(1e-3), 500), y = run(b, step_of(1e-3), 500);
  EXPECT_TRUE(x.q == y.q);
  EXPECT_TRUE(x.nu == y.nu);
}

/// A pinned chain that a stiff spring has brought to rest: what the forces leave is rounding, of which no digit can be asked. It ended at step 167.
TEST(Stepping, equations_hold_what_is_at_rest) {
  Model m;
  for (int k = 0; k < 3; ++k) {
    Body b = body(std::string(1, static_cast<char>('a' + k)).c_str(), k == 0 ? ground : k - 1, JointType::revolute, 1, {0.02, 0.02, 0.01}, {0, 0, -0.25});
    b.joint.axis = {0, 1, 0};
    if (k > 0) b.joint.placement.translation = {0, 0, -0.5};
    m.add(std::move(b));
  }
  Constraint pin;
  pin.kind = Constraint::Kind::point, pin.loop = true;
  pin.a.body = 2, pin.a.placement.translation = {0, 0, -0.5};
  pin.b.body = ground;
  m.constraints.push_back(pin);
  Scene scene = scene_of(std::move(m), {0, 0, -9.81});
  scene.q << 2, -1, -1;
  Poses<double> at;
  poses(scene.model, scene.q, at);
  scene.model.constraints[0].b.placement = world_pose(at, 2) * pin.a.placement;
  scene.motion.springs.push_back({1, 0, 1e6, -1, 1000, "scene:1"});
  Simulation<double> s(scene, step_of(5e-3));
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(s.step().ok()) << "step " << k << ": " << name(s.last().report.status);
  EXPECT_LT(s.state().nu.norm(), 1e-12);
}

TEST(Stepping, a_saved_state_repeats_every_bit) {
  const Scene scene = everything_smooth();
  Simulation<double> first(scene, step_of(1e-3)), second(scene, step_of(1e-3));
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(first.step().ok());
  const State<double> saved = first.state();
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(first.step().ok());
  second.restore(saved);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(second.step().ok());
  EXPECT_TRUE(first.state().q == second.state().q);
  EXPECT_TRUE(first.state().nu == second.state().nu);
  EXPECT_EQ(first.state().steps, 100);
  EXPECT_EQ(second.time(), first.time());
}

TEST(Stepping, motors_are_cut_at_their_effort) {
  Model m;
  m.add(body("wheel", ground, JointType::revolute, 1, {1, 1, 2}));
  Scene scene = scene_of(std::move(m));
  scene.motion.motors.push_back({0, 0, 0, 1, 3, 10, 3, ""});
  const State<double> end = run(scene, step_of(1e-3), 10);
  EXPECT_NEAR(end.nu[0], 10 * 1e-3 * 3 / 2, 1e-12);
  EXPECT_NEAR(run(scene, step_of(1e-2), 4000).q[0], 10, 1e-6);  // e^(−t/2) after 40 s
}

}  // namespace
}  // namespace delassus::stepping_test
