// Sleeping: by exact bits. What is awake does not see what sleeps, what sleeps does not move, and who never sleeps pays nothing.
#include <gtest/gtest.h>

#include "algorithms/kit/counted.h"
#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_sleep_test {
namespace {

using namespace stepping;

constexpr double h = 1e-3;
const SceneMotion::Sleeping limits{0.02, 0.02, 0.01};  // ten steps

/// A tower of two boxes at x, and a ball that is thrown at it from `from` with `speed`.
Scene tower(double x, double from, double speed, bool sleeps = true) {
  Model m;
  for (const char* name : {"lower", "upper"}) m.add(box(name, 1, {0.1, 0.1, 0.1}));
  if (speed != 0) m.add(ball("ball", 0.5, 0.05));
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0.6);
  for (Index k = 0; k < 2; ++k) s.q[7 * k] = x, s.q[7 * k + 2] = 0.1 + 0.2 * static_cast<double>(k);
  if (speed != 0) s.q[14] = from, s.q[16] = 0.3, s.motion.nu[15] = speed;
  if (sleeps) s.motion.sleeping = limits;
  return s;
}

Index asleep(const State<double>& s) {
  return std::count_if(s.rest.begin(), s.rest.end(), [](const auto& r) { return r.island >= 0; });
}

void steps(Simulation<double>& s, int n) {
  for (int k = 0; k < n; ++k) ASSERT_TRUE(s.step().ok()) << k << ": " << s.last().message;
}

/// Asleep after ten steps, with ν = 0; then no bit of q changes, there is no row, and a step does nothing.
TEST(Sleep, what_rests_falls_asleep_and_stays) {
  Simulation<double> s(tower(0, 0, 0), step_of(h));
  steps(s, 9);
  EXPECT_EQ(asleep(s.state()), 0);
  EXPECT_EQ(s.last().islands, 1);
  steps(s, 1);
  EXPECT_EQ(asleep(s.state()), 2);
  EXPECT_TRUE((s.state().nu.array() == 0).all());
  EXPECT_EQ(s.state().rest[0].island, s.state().rest[1].island) << "one island";
  const State<double> fell = s.state();
  steps(s, 1);
  EXPECT_EQ(s.last().rows, 0);
  EXPECT_EQ(s.last().islands, 0);
  steps(s, 100);
  EXPECT_EQ(s.last().path, "asleep");
  EXPECT_TRUE(s.state().q == fell.q);
  EXPECT_TRUE((s.state().nu.array() == 0).all());
  EXPECT_EQ(s.state().steps, fell.steps + 101);
  EXPECT_EQ(s.state().impulses.size(), fell.impulses.size());
}

/// One alone, whose island is the same with its rows and without: at its first step asleep it is not moved, and keeps its impulses.
TEST(Sleep, one_alone_is_not_moved) {
  Scene scene = resting_box();
  scene.motion.sleeping = limits;
  Simulation<double> s(scene, step_of(h));
  steps(s, 10);
  ASSERT_EQ(asleep(s.state()), 1);
  const State<double> fell = s.state();
  ASSERT_FALSE(fell.impulses.empty());
  steps(s, 1);
  EXPECT_EQ(s.last().rows, 0);
  EXPECT_TRUE(s.state().q == fell.q);
  EXPECT_EQ(s.state().impulses.size(), fell.impulses.size());
}

/// A step with everything asleep has no operation.
TEST(Sleep, asleep_costs_nothing) {
  Simulation<Counted> s(tower(0, 0, 0), step_of(h));
  for (int k = 0; k < 12; ++k) ASSERT_TRUE(s.step().ok());
  operation_count = {};
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(s.step().ok());
  EXPECT_EQ(operation_count.total(), 0);
}

/// Sleeping on, nothing sleeps: the bits of a scene without the key.
TEST(Sleep, who_never_sleeps_has_the_same_bits) {
  Scene scene = thrown_box(), bare = scene;
  scene.motion.sleeping = {1e-9, 1e-9, 0.5};
  const State<double> a = run(scene, step_of(h), 200), b = run(bare, step_of(h), 200);
  ASSERT_GT(a.q.size(), 0);
  EXPECT_TRUE(a.q == b.q);
  EXPECT_TRUE(a.nu == b.nu);
  EXPECT_TRUE(b.rest.empty() && b.rest_force.size() == 0) << "no byte in the state of who does not ask";
}

/// A ball that rolls far from a tower has the bits it has without the tower, from before until after that falls asleep; and the tower
/// sleeps with the bits that it has alone.
TEST(Sleep, awake_and_asleep_do_not_see_each_other) {
  Scene both = tower(0, 5, 1);
  both.motion.sleeping.after = 0.05;
  Scene ball_alone = both, tower_alone = tower(0, 0, 0);
  tower_alone.motion.sleeping = both.motion.sleeping;
  Model m;
  m.add(both.model.bodies[2]);
  ball_alone.model = std::move(m);
  ball_alone.q = both.q.tail<7>(), ball_alone.motion.nu = both.motion.nu.tail<6>();
  ball_alone.motion.search.object = {0};
  Simulation<double> a(both, step_of(h)), b(ball_alone, step_of(h)), c(tower_alone, step_of(h));
  for (int k = 0; k < 200; ++k) {
    steps(a, 1), steps(b, 1), steps(c, 1);
    ASSERT_TRUE(a.state().q.tail<7>() == b.state().q) << k;
    ASSERT_TRUE(a.state().nu.tail<6>() == b.state().nu) << k;
    ASSERT_TRUE(a.state().q.head<14>() == c.state().q) << k;
  }
  EXPECT_EQ(asleep(a.state()), 2);
  EXPECT_EQ(asleep(b.state()), 0);
}

/// The ball that comes wakes all of the tower, before it touches: the tower then moves as one that had only now been put there, with the
/// impulses it fell asleep with; and it falls asleep again.
TEST(Sleep, a_contact_wakes_the_island) {
  const Scene scene = tower(0, -1, 5);
  Simulation<double> s(scene, step_of(h));
  int woke = -1;
  for (int k = 0; k < 400 && woke < 0; ++k) {
    const State<double> before = s.state();
    steps(s, 1);
    if (asleep(before) == 2 && asleep(s.state()) == 0) {
      woke = k;
      Scene now = scene;
      now.q = before.q, now.motion.nu = before.nu, now.motion.sleeping = {};
      Simulation<double> fresh(now, step_of(h));
      State<double> start = before;
      start.rest.clear(), start.rest_force.resize(0);
      fresh.restore(start);
      steps(fresh, 1);
      EXPECT_TRUE(fresh.state().q == s.state().q);
      EXPECT_TRUE(fresh.state().nu == s.state().nu);
    } else if (asleep(before) == 2) {
      ASSERT_TRUE(before.q.head<14>() == s.state().q.head<14>());
    }
  }
  ASSERT_GT(woke, 10);
  steps(s, 30);
  EXPECT_GT(V3(s.state().q.segment<3>(7) - scene.q.segment<3>(7)).norm(), 1e-3) << "the upper box was hit";
}

/// A saved state goes on with every bit: asleep, and just before something wakes.
TEST(Sleep, a_saved_state_repeats_every_bit) {
  const Scene scene = tower(0, -1, 5);
  for (const int at : {5, 50, 170}) {
    Simulation<double> first(scene, step_of(h)), second(scene, step_of(h));
    steps(first, at);
    const State<double> saved = first.state();
    steps(first, 120);
    second.restore(saved);
    steps(second, 120);
    EXPECT_TRUE(first.state().q == second.state().q) << at;
    EXPECT_TRUE(first.state().nu == second.state().nu) << at;
    EXPECT_EQ(asleep(first.state()), asleep(second.state())) << at;
  }
}

/// The same state in a scene with another wrench or motor wakes, in one with the same sleeps on.
TEST(Sleep, another_force_wakes) {
  Scene scene = tower(0, 0, 0);
  scene.motion.wrenches.push_back({{1, {}}, {0.5, 0, 0}, {0, 0, 0}, ""});
  Simulation<double> s(scene, step_of(h));
  steps(s, 50);
  ASSERT_EQ(asleep(s.state()), 2);
  Scene pushed = scene;
  pushed.motion.wrenches[0].force[0] = 20;
  Simulation<double> on(scene, step_of(h)), other(pushed, step_of(h));
  on.restore(s.state());
  other.restore(s.state());
  steps(on, 3), steps(other, 3);
  EXPECT_EQ(asleep(on.state()), 2);
  EXPECT_TRUE(on.state().q == s.state().q);
  EXPECT_EQ(asleep(other.state()), 0);
  EXPECT_GT(other.state().nu[6 + 3], 0.01) << "20 N against 5.9 N of friction";
  Scene arm = pendulum(0);
  arm.has_gravity = false, arm.motion.sleeping = limits;
  arm.motion.motors.push_back({0, 0, 0, 10, 5, 0, 100, ""});
  Simulation<double> held(arm, step_of(h));
  steps(held, 30);
  ASSERT_EQ(asleep(held.state()), 1);
  arm.motion.motors[0].target = 1;
  Simulation<double> moved(arm, step_of(h));
  moved.restore(held.state());
  steps(moved, 5);
  EXPECT_EQ(asleep(moved.state()), 0);
  EXPECT_GT(moved.state().nu[0], 0);
}

/// What turns at an apex, or flies slowly, is no rest: `after` is longer than it stays.
TEST(Sleep, a_turning_point_is_no_rest) {
  Scene s = pendulum(1);
  s.motion.sleeping = {0.01, 0.01, 0.05};
  Simulation<double> run(s, step_of(h));
  steps(run, 3000);
  EXPECT_EQ(asleep(run.state()), 0);
}

/// Falling asleep takes the kinetic energy below the two thresholds, and nothing else.
TEST(Sleep, energy_of_falling_asleep_is_bounded) {
  Scene scene = tower(0, 0, 0);
  scene.motion.nu[3] = scene.motion.nu[9] = 0.01;
  scene.ground_friction = 1e-3;
  Simulation<double> s(scene, step_of(h));
  Observer<double> observe(scene);
  double before = observe(s.state()).energy();
  for (int k = 0; k < 30; ++k) {
    const bool awake = asleep(s.state()) == 0;
    steps(s, 1);
    const double now = observe(s.state()).energy();
    if (awake && asleep(s.state()) > 0) {
      EXPECT_LE(before - now, 2 * (0.5 * 1 * limits.linear * limits.linear + 0.5 * (0.2 * 0.2 / 6) * limits.angular * limits.angular));
    }
    EXPECT_LE(now, before + 1e-12);
    before = now;
  }
  EXPECT_EQ(asleep(s.state()), 2);
}

}  // namespace
}  // namespace delassus::stepping_sleep_test
