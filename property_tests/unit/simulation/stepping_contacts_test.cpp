// Contacts, friction, bounce, limits and dry friction of joints in scenes that move, against closed forms.
#include <gtest/gtest.h>

#include "models/shapes/hull.h"
#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_contacts_test {
namespace {

using namespace stepping;

constexpr double g = 9.81;

V3 velocity_of(const State<double>& s, Index q = 0, Index dof = 0) {
  return Eigen::Quaterniond(s.q[q + 3], s.q[q + 4], s.q[q + 5], s.q[q + 6]).normalized().toRotationMatrix() * V3(s.nu.segment<3>(dof + 3));
}

/// Apexes at e²ᵏ H. A bounce happens at a gap of at most h |v|, and the fall between is off by as much: 4 h |v| each.
TEST(Contacts, bouncing_ball) {
  Model m;
  m.add(ball("ball", 1, 0.1));
  Scene scene = on_the_ground(std::move(m), {0, 0, -g}, -1);
  const double H = 1, e = 0.8, h = 1e-4;
  scene.q[2] = 0.1 + H;
  scene.motion.restitution = e;
  Simulation<double> s(scene, step_of(h));
  double before = -1, expected = H;
  int apexes = 0;
  for (int k = 0; k < 40000 && apexes < 5; ++k) {
    ASSERT_TRUE(s.step().ok()) << s.last().message;
    const double now = s.state().nu[5];
    if (before > 0 && now <= 0) {
      expected *= e * e;
      ++apexes;
      EXPECT_NEAR(s.state().q[2] - 0.1, expected, apexes * 4 * h * std::sqrt(2 * g * H));
    }
    before = now;
  }
  EXPECT_EQ(apexes, 5);
}

Scene block_on_a_slope(double angle, double mu) {
  Model m;
  m.add(box("block", 2, {0.2, 0.2, 0.05}));
  Scene s = on_the_ground(std::move(m), {g * std::sin(angle), 0, -g * std::cos(angle)}, mu);
  s.q[2] = 0.05;
  return s;
}

/// Below the friction angle nothing moves but what the solver's residual of 1e-10 m/s leaves, step by step; above it the block
/// gains g (sin α − μ cos α), to the same residual.
TEST(Contacts, sliding_block_sticks_or_slides) {
  const double mu = 0.5, h = 1e-3;
  const int n = 1000;
  const State<double> sticks = run(block_on_a_slope(std::atan(mu) - 0.01, mu), step_of(h), n);
  ASSERT_GT(sticks.q.size(), 0);
  EXPECT_LT(V3(sticks.q.head<3>() - V3(0, 0, 0.05)).norm(), n * h * 1e-9);
  const double angle = std::atan(mu) + 0.1, a = g * (std::sin(angle) - mu * std::cos(angle));
  const State<double> slides = run(block_on_a_slope(angle, mu), step_of(h), n);
  ASSERT_GT(slides.q.size(), 0);
  EXPECT_NEAR(velocity_of(slides)[0], n * h * a, n * 1e-9);
  EXPECT_NEAR(slides.q[2], 0.05, n * h * 1e-9);
}

/// Exact Coulomb friction does not lift what slides (the convex relaxation does, by μ |u_t| h a step).
TEST(Contacts, a_cube_thrown_along_the_floor_does_not_lift) {
  Scene scene = block_on_a_slope(0, 0.5);
  scene.motion.nu[3] = 6;
  Simulation<double> s(scene, step_of(1e-3));
  double highest = 0, lowest = 1;
  for (int k = 0; k < 1500; ++k) {
    ASSERT_TRUE(s.step().ok()) << s.last().message;
    highest = std::max(highest, s.state().q[2]);
    lowest = std::min(lowest, s.state().q[2]);
  }
  EXPECT_LT(highest - 0.05, 1e-8);
  EXPECT_GT(lowest - 0.05, -1e-8);
  EXPECT_LT(velocity_of(s.state()).norm(), 1e-8);
  EXPECT_NEAR(s.state().q[0], 36 / (2 * 0.5 * g), 6 * 1e-3);  // v²/2μg, a step
}

/// The relaxation says u_n = μ |u_t| of what slides: the cube rises by 2 mm in the first step of a millisecond.
TEST(Contacts, the_convex_relaxation_lifts_it) {
  Scene scene = block_on_a_slope(0, 0.5);
  scene.motion.nu[3] = 6;
  Settings relaxed = step_of(1e-3);
  relaxed.friction = FrictionLaw::relaxed;
  const State<double> first = run(scene, relaxed, 1);
  ASSERT_GT(first.q.size(), 0);
  const double u = velocity_of(first)[0];
  EXPECT_NEAR(first.q[2] - 0.05, 1e-3 * 0.5 * u, 1e-10);
  EXPECT_GT(u, 4);
}

/// A ball rolls down with 5/7 g sin α where μ ≥ 2/7 tan α.
TEST(Contacts, ball_rolls_down_a_slope) {
  const double angle = 0.3, h = 1e-3;
  Model m;
  m.add(ball("ball", 2, 0.1));
  Scene scene = on_the_ground(std::move(m), {g * std::sin(angle), 0, -g * std::cos(angle)}, 0.5);
  scene.q[2] = 0.1;
  const State<double> end = run(scene, step_of(h), 1000);
  ASSERT_GT(end.q.size(), 0);
  EXPECT_NEAR(velocity_of(end)[0], 1000 * h * g * std::sin(angle) * 5 / 7, 1e-6);
}

/// What the ground gives is the weight, for mass ratios up to 10⁶, the heavy one on top. Asked of the solver is 1e-9 m/s: above what the
/// rounding of u = G λ + g is worth, 30 eps |J| |M⁻¹Jᵀ| |λ| = 2.6e-10 m/s at a corner between the light cubes (eight impulses of
/// r m g h/4, each with (1 + 2 (a/2)²/(a²/6))/m = 4/m of a cube of side a). Three contacts stand one above the other: the uppermost cube
/// may be off by three residuals, as a speed and as an acceleration.
TEST(Contacts, stack_at_rest) {
  for (const double ratio : {1.0, 1e3, 1e6}) {
    Model m;
    const double masses[] = {1, 1, ratio};
    for (int k = 0; k < 3; ++k) m.add(box("box " + std::to_string(k), masses[k], {0.1, 0.1, 0.1}));
    Scene scene = on_the_ground(std::move(m), {0, 0, -g}, 0.5);
    for (int k = 0; k < 3; ++k) scene.q[7 * k + 2] = 0.1 + 0.2 * k;
    const double h = 1e-3;
    Settings settings = step_of(h);
    settings.residual = 1e-9;
    Simulation<double> s(scene, settings);
    const int n = 200;
    for (int k = 0; k < n; ++k) ASSERT_TRUE(s.step().ok()) << ratio << ": step " << k << ": " << s.last().message;
    double normal = 0;
    Index row = 0;
    for (const RowSet<double>& c : s.rows()) {
      if (c.other == ground) normal += s.impulses()[row];
      row += c.directions;
    }
    EXPECT_NEAR(normal / h / g / (2 + ratio), 1, 3 * settings.residual / (h * g)) << ratio;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.state().q[7 * k + 2], 0.1 + 0.2 * k, 3 * n * h * settings.residual + 1e-12) << ratio;
  }
}

Body cylinder(const std::string& name, double mass, double radius, double half, const Matrix3<double>& turn = Matrix3<double>::Identity()) {
  const double across = mass * (3 * radius * radius + 4 * half * half) / 12, along = mass * radius * radius / 2;
  Body b = body(name, ground, JointType::floating, mass, {0, 0, 0});
  b.inertia = turn * V3(across, across, along).asDiagonal() * turn.transpose();
  b.shapes.push_back({Shape::Kind::cylinder, V3(radius, half, 0), {turn, {0, 0, 0}}, -1, {}});
  return b;
}

/// A box, as the hull of its corners.
Body block(const std::string& name, double mass, const V3& half) {
  Body b = box(name, mass, half);
  std::vector<V3> corners;
  for (int k = 0; k < 8; ++k) corners.emplace_back(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
  b.shapes = {{Shape::Kind::hull, half, {}, -1, std::make_shared<const std::vector<V3>>(corners)}};
  return b;
}

/// Stacks with cylinders and hulls: the ground gives the weight, nothing moves but by the residual, no contact comes or goes.
TEST(Contacts, stacks_of_cylinders_and_hulls_at_rest) {
  const Matrix3<double> lying = Eigen::AngleAxisd(M_PI / 2, V3::UnitY()).toRotationMatrix();
  struct Stack {
    std::string name;
    std::vector<Body> bodies;
    std::vector<double> half;  // heights
    std::size_t points;
  };
  std::vector<Stack> stacks{
      {"cylinder on a box", {box("box", 2, {0.2, 0.2, 0.1}), cylinder("cylinder", 1, 0.1, 0.15)}, {0.1, 0.15}, 8},
      {"cylinder on cylinders", {cylinder("low", 1, 0.1, 0.1), cylinder("middle", 1, 0.1, 0.1), cylinder("high", 1, 0.1, 0.1)}, {0.1, 0.1, 0.1}, 12},
      {"cylinder lying on a box", {box("box", 2, {0.2, 0.2, 0.1}), cylinder("cylinder", 1, 0.1, 0.15, lying)}, {0.1, 0.1}, 6},
      {"box on a cylinder that lies on a box", {box("box", 2, {0.2, 0.2, 0.1}), cylinder("cylinder", 1, 0.1, 0.15), box("lid", 1, {0.2, 0.2, 0.05})}, {0.1, 0.15, 0.05}, 12},
      {"hull on a cylinder", {cylinder("cylinder", 1, 0.2, 0.1), block("hull", 1, {0.1, 0.1, 0.1})}, {0.1, 0.1}, 8},
      {"hull on a hull on a box", {box("box", 2, {0.2, 0.2, 0.1}), block("hull", 1, {0.1, 0.1, 0.1}), block("like it", 1, {0.1, 0.1, 0.1})}, {0.1, 0.1, 0.1}, 12},
  };
  for (const Stack& stack : stacks) {
    SCOPED_TRACE(stack.name);
    if (stack.name.find("hull") != std::string::npos && !has_hulls()) continue;
    Model m;
    double mass = 0;
    for (const Body& b : stack.bodies) m.add(b), mass += b.mass;
    Scene scene = on_the_ground(std::move(m), {0, 0, -g}, 0.5);
    std::vector<double> at;
    double top = 0;
    for (std::size_t k = 0; k < stack.half.size(); ++k) {
      at.push_back(top + stack.half[k]);
      top += 2 * stack.half[k];
      scene.q[static_cast<Index>(7 * k + 2)] = at[k];
    }
    const double h = 1e-3;
    Settings settings = step_of(h);
    settings.residual = 1e-9;
    Simulation<double> s(scene, settings);
    const int n = 300;
    for (int k = 0; k < n; ++k) {
      ASSERT_TRUE(s.step().ok()) << "step " << k << ": " << s.last().message;
      ASSERT_EQ(s.rows().size(), stack.points) << "step " << k;
    }
    double normal = 0;
    Index row = 0;
    for (const RowSet<double>& c : s.rows()) {
      if (c.other == ground) normal += s.impulses()[row];
      row += c.directions;
    }
    EXPECT_NEAR(normal / h / g / mass, 1, 3 * settings.residual / (h * g));
    for (std::size_t k = 0; k < at.size(); ++k) {
      const auto q = s.state().q.segment<7>(static_cast<Index>(7 * k));
      EXPECT_LE((q.head<3>() - V3(0, 0, at[k])).norm(), 6 * n * h * settings.residual + 1e-12) << k;
      EXPECT_LE(q.segment<3>(4).norm(), 6 * n * h * settings.residual / 0.1) << k;
    }
  }
}

/// A box that is let go on a corner tips, slides and lies. Where gaps above and below zero were closed at different rates its four corners
/// contradicted each other by 1e-8 m/s: up to 20,000 iterations a step, and two of these ended at step 81 and 93.
TEST(Contacts, a_tipped_box_comes_to_rest) {
  struct Tip { const char *rpy, *friction; };
  for (const Tip& tip : {Tip{"0.2, 0.1", "0.5"}, {"0.20006, 0.10006", "0.5"}, {"0.1, 0.11", "0.3"}, {"0.2, 0.12", "0.4"}, {"0.3, 0.13", "0.5"}}) {
    SCOPED_TRACE(std::string(tip.rpy) + ", friction " + tip.friction);
    Simulation<double> s(read("gravity: [0, 0, -9.81]\nboxes:\n  - {name: box, mass: 1, size: [0.1, 0.1, 0.1], pose: {xyz: [0, 0, 0.6], rpy: [" + std::string(tip.rpy) +
                              ", 0]}}\nground: {z: 0.525}\ncontacts: {detect: true, friction: " + tip.friction + "}\n"),
                         step_of(1e-3));
    int iterations = 0;
    for (int k = 0; k < 500; ++k) {
      ASSERT_TRUE(s.step().ok()) << k << ": " << s.last().message;
      iterations += s.last().iterations;
    }
    EXPECT_LE(iterations, 12 * 500);
    EXPECT_LT(s.state().nu.norm(), 1e-9);
    EXPECT_NEAR(s.state().q[2], 0.575, 1e-9);
  }
}

// Gaps that fit together ask for velocities that do, whatever their signs, until a penetration is deep.
TEST(Contacts, small_gaps_and_penetrations_are_closed_alike) {
  constexpr double h = 1e-3;
  for (const double gap : {-9e-6, -1e-9, 0.0, 1e-9, 1e-4}) EXPECT_EQ(target_of_gap(gap, h), -gap / h) << gap;
  EXPECT_NEAR(target_of_gap(-1e-4, h), 0.01 + 0.2 * 0.09, 1e-15);
  EXPECT_EQ(target_of_gap(-1.0, h), 1);
}

/// Dry friction holds a torque below its effort without any creep, and leaves (τ − f)/I of one above it.
TEST(Contacts, joint_friction) {
  Model m;
  m.add(body("wheel", ground, JointType::revolute, 1, {1, 1, 2}));
  m.bodies[0].joint.friction = {0.5};
  Scene scene = scene_of(std::move(m));
  scene.motion.motors.push_back({0, 0, 0.4, 0, 0, 0, 100, ""});
  EXPECT_LT(std::abs(run(scene, step_of(1e-3), 1000).q[0]), 1000 * 1e-3 * 1e-10);
  scene.motion.motors[0].torque = 0.9;
  EXPECT_NEAR(run(scene, step_of(1e-3), 1000).nu[0], 0.2, 1e-7);
}

/// A pendulum that falls on its limit stays there, above it by no more than rounding and the residual.
TEST(Contacts, joint_limit) {
  Scene scene = stopped_pendulum();
  scene.model.bodies[0].joint.friction.clear();
  scene.model.bodies[0].joint.lower = {0.1};
  scene.q[0] = 0.5;
  Simulation<double> s(scene, step_of(1e-3));
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(s.step().ok()) << s.last().message;
    ASSERT_GT(s.state().q[0], 0.1 - 1e-9);
  }
  EXPECT_NEAR(s.state().q[0], 0.1, 1e-9);
}

/// A list of contacts is the same as the points that detection finds, as long as the face stays on the ground.
TEST(Contacts, listed_points_are_those_of_detection) {
  Scene found = block_on_a_slope(0.7, 0.5), listed = found;
  listed.motion.detects = false;
  for (int k = 0; k < 4; ++k) {
    Constraint c;
    c.name = "foot";
    c.kind = Constraint::Kind::contact;
    c.friction = 0.5;
    c.a.body = 0;
    c.a.placement.translation = {k & 1 ? 0.2 : -0.2, k & 2 ? 0.2 : -0.2, -0.05};
    c.b.placement.translation = c.a.placement.translation + V3(0, 0, 0.05);
    listed.model.constraints.push_back(c);
  }
  listed.damping = Damping<double>::uniform(12, 0);
  const State<double> a = run(found, step_of(1e-3), 200), b = run(listed, step_of(1e-3), 200);
  ASSERT_EQ(a.q.size(), b.q.size());
  ASSERT_GT(a.q.size(), 0);
  EXPECT_LT((a.q - b.q).norm(), 1e-7);
}

TEST(Contacts, a_saved_state_repeats_every_bit_warm_starts_included) {
  Scene scene = thrown_box();
  scene.motion.restitution = 0;
  Simulation<double> first(scene, step_of(1e-3)), second(scene, step_of(1e-3));
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(first.step().ok()) << first.last().message;
  const State<double> saved = first.state();
  EXPECT_GT(saved.impulses.size(), 0u);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(first.step().ok()) << first.last().message;
  second.restore(saved);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(second.step().ok());
  EXPECT_TRUE(first.state().q == second.state().q);
  EXPECT_TRUE(first.state().nu == second.state().nu);
}

/// Nothing that is not used: an impulse above the residual ends the step, the state stays.
TEST(Contacts, a_step_that_fails_leaves_the_state) {
  Settings impossible = step_of(1e-3);
  impossible.residual = 0;
  impossible.solver = "pgs";
  Scene scene = thrown_box();
  Simulation<double> s(scene, impossible);
  const VectorX<double> q = s.state().q;
  int taken = 0;
  while (taken < 50 && s.step().ok()) ++taken;
  ASSERT_LT(taken, 50);
  EXPECT_NE(s.last().message.find("pgs"), std::string::npos);
  EXPECT_EQ(s.state().steps, taken);
  if (taken == 0) {
    EXPECT_TRUE(s.state().q == q);
  }
}

/// What moves so fast that its forces overflow ends with a status, not with an exception: what was computed is kept.
TEST(Contacts, numbers_that_overflow_end_the_step_with_a_status) {
  Model m;
  m.add(box("brick", 2, {0.1, 0.2, 0.3}));
  Scene scene = on_the_ground(std::move(m), {0, 0, -g}, 0.5);
  scene.q[2] = 0.3;
  scene.motion.nu.head<3>() << 1e160, 2e160, 3e160;
  Simulation<double> s(scene, step_of(1e-3));
  const VectorX<double> q = s.state().q;
  EXPECT_EQ(s.step().report.status, Status::not_finite);
  EXPECT_NE(s.last().message.find("not finite"), std::string::npos);
  EXPECT_TRUE(s.state().q == q);
}

}  // namespace
}  // namespace delassus::stepping_contacts_test
