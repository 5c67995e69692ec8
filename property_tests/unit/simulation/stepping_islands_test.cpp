// Islands: what does not meet is solved apart, by exact bits; and apart is together, to the residual of the solvers.
#include <gtest/gtest.h>

#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_islands_test {
namespace {

using namespace stepping;

/// One scene behind the other. What they say of gravity, ground and contacts is that of the first.
Scene beside(const Scene& a, const Scene& b) {
  Scene both = a;
  const Index n = static_cast<Index>(a.model.bodies.size());
  const auto moved = [n](Index body) { return body == ground ? ground : body + n; };
  both.motion.search.object.resize(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) both.motion.search.object[static_cast<std::size_t>(i)] = i;
  for (Body x : b.model.bodies) {
    x.parent = moved(x.parent);
    x.name += " of the other";
    both.motion.search.object.push_back(both.model.add(std::move(x)));
  }
  for (Constraint c : b.model.constraints) {
    c.name += " of the other";
    c.a.body = moved(c.a.body), c.b.body = moved(c.b.body);
    for (auto& t : c.terms) t.body = moved(t.body);
    both.model.constraints.push_back(std::move(c));
  }
  const auto append = [](VectorX<double>& x, const VectorX<double>& y) {
    x.conservativeResize(x.size() + y.size());
    x.tail(y.size()) = y;
  };
  append(both.q, b.q);
  append(both.motion.nu, b.motion.nu);
  Index rows = 0;
  for (const Constraint& c : both.model.constraints) rows += row_count(both.model, c);
  both.damping = Damping<double>::uniform(rows, 0);
  for (auto s : b.motion.springs) s.body += n, both.motion.springs.push_back(s);
  return both;
}

/// Every kind of path: bricks side by side, a cube that is thrown, a pile, two loops, a pendulum with a limit and dry friction, a free top.
std::vector<std::pair<std::string, Scene>> mechanisms() {
  Scene cube = thrown_box();
  Model m;
  for (int k = 0; k < 3; ++k) m.add(box("box " + std::to_string(k), 1 + k, {0.1, 0.1, 0.1}));
  Scene pile = on_the_ground(std::move(m), {0, 0, -9.81}, 0.5);
  for (Index k = 0; k < 3; ++k) pile.q[7 * k] = 20 + 0.03 * static_cast<double>(k), pile.q[7 * k + 2] = 0.1 + 0.2001 * static_cast<double>(k);
  Scene loop = slider_crank(0.3, 0.8, 0.4, 5), hinge = stopped_pendulum(), top = free_body({0.1, 0.2, 0.25});
  top.q[2] = 50;
  Model f;
  for (const char* name : {"left", "right"}) f.add(box(name, 1, {0.2, 0.1, 0.05}));  // slow and 5 mm apart: what is fast elsewhere must not join them
  Scene bricks = on_the_ground(std::move(f), {0, 0, -9.81}, 0.5);
  for (Index k = 0; k < 2; ++k) bricks.q[7 * k] = -20 + 0.405 * static_cast<double>(k), bricks.q[7 * k + 2] = 0.051;
  bricks.motion.nu << 0.02, 0.03, 0.1, 0, 0, 0, 0.01, -0.02, 0, 0.01, 0, 0;
  Scene slow = slider_crank(0.25, 0.9, 1.1, 0.1);  // closed by fewer steps than the other
  return {{"bricks", bricks}, {"cube", cube}, {"pile", pile}, {"loop", loop}, {"slow loop", slow}, {"pendulum", hinge}, {"top", top}};
}

/// The scene of one, with the effects of all: the ground, contacts, gravity and restitution of the first.
Scene alone(const Scene& s) {
  Scene out = thrown_box();
  Scene empty = out;
  empty.model = {}, empty.q.resize(0), empty.motion.nu.resize(0), empty.damping = {};
  return beside(empty, s);
}

TEST(Islands, bits_of_an_island_do_not_depend_on_what_else_there_is) {
  const auto all = mechanisms();
  std::vector<State<double>> own;
  for (const auto& [name, s] : all) {
    own.push_back(run(alone(s), step_of(1e-3), 150));
    ASSERT_GT(own.back().q.size(), 0) << name;
  }
  for (const bool reversed : {false, true}) {
    Scene both = alone(all[reversed ? all.size() - 1 : 0].second);
    std::vector<std::size_t> order{reversed ? all.size() - 1 : 0};
    for (std::size_t k = 1; k < all.size(); ++k) {
      order.push_back(reversed ? all.size() - 1 - k : k);
      both = beside(both, all[order.back()].second);
    }
    const State<double> end = run(both, step_of(1e-3), 150);
    ASSERT_GT(end.q.size(), 0);
    Index q = 0, dof = 0;
    for (const std::size_t k : order) {
      EXPECT_TRUE(end.q.segment(q, own[k].q.size()) == own[k].q) << all[k].first;
      EXPECT_TRUE(end.nu.segment(dof, own[k].nu.size()) == own[k].nu) << all[k].first;
      q += own[k].q.size(), dof += own[k].nu.size();
    }
  }
}

/// The same in one problem differs: the proof above would see it.
TEST(Islands, the_proof_sees_islands_that_are_solved_together) {
  const auto all = mechanisms();
  Settings together = step_of(1e-3);
  together.together = true;
  const State<double> own = run(alone(all[1].second), step_of(1e-3), 150), end = run(beside(alone(all[1].second), all[2].second), together, 150);
  ASSERT_GT(end.q.size(), 0);
  EXPECT_FALSE(end.q.head(own.q.size()) == own.q);
}

/// Two balls in line that meet in flight, one after the other: two islands, one, two. Apart and together agree to the residual, and the
/// count of islands is that of what touches.
TEST(Islands, they_meet_and_part) {
  Model m;
  for (const char* name : {"left", "right"}) m.add(ball(name, 1, 0.1));
  Scene scene = on_the_ground(std::move(m), {0, 0, -9.81}, 0);  // with friction they would lift each other off the ground
  scene.q[2] = 0.1, scene.q[7] = 0.5, scene.q[9] = 0.1;
  scene.motion.nu[3] = 2;
  scene.motion.restitution = 0.9;
  Settings one = step_of(1e-3);
  one.together = true;
  Simulation<double> apart(scene, step_of(1e-3)), together(scene, one);
  std::vector<Index> seen;
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(apart.step().ok()) << apart.last().message;
    ASSERT_TRUE(together.step().ok()) << together.last().message;
    if (seen.empty() || seen.back() != apart.last().islands) seen.push_back(apart.last().islands);
    EXPECT_EQ(together.last().islands, 1);
    EXPECT_EQ(apart.last().rows, together.last().rows) << k;
    ASSERT_LT((apart.state().nu - together.state().nu).norm(), (k + 1) * 1e-10 * 100) << k;  // the residual at an arm of 0.1 m, both
  }
  EXPECT_EQ(seen, (std::vector<Index>{2, 1, 2}));
}

TEST(Islands, a_run_repeats_its_bits_also_from_a_saved_state) {
  const auto all = mechanisms();
  const Scene scene = beside(alone(all[2].second), all[3].second);
  Simulation<double> first(scene, step_of(1e-3)), second(scene, step_of(1e-3));
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(first.step().ok()) << first.last().message;
  const State<double> saved = first.state();
  EXPECT_GT(saved.impulses.size(), 0u);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(first.step().ok());
  second.restore(saved);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(second.step().ok());
  EXPECT_TRUE(first.state().q == second.state().q);
  EXPECT_TRUE(first.state().nu == second.state().nu);
}

/// Contacts join a loop and a box: the loop is closed all the same, and its box carries the ground's reaction.
TEST(Islands, a_loop_that_is_touched_stays_closed) {
  Scene loop = slider_crank(0.3, 0.8, 0.4, 0);
  loop.model.bodies[2].shapes.push_back({Shape::Kind::box, V3(0.1, 0.1, 0.05), {}, 0.5, {}});
  Model m;
  m.add(box("crate", 1, {0.1, 0.1, 0.1}));
  Scene crate = on_the_ground(std::move(m), {0, 0, -9.81}, 0.5);
  crate.q[0] = loop.q[2] + 0.25, crate.q[2] = 0.1;
  crate.motion.nu[3] = -1;
  crate.ground_friction = 0.1;
  Scene both = beside(crate, loop);
  both.motion.search.object = {0, 1, 1, 1};
  both.model.bodies[3].shapes[0].placement.translation = {0, 0, 0.1};
  Simulation<double> s(both, step_of(1e-3));
  Index fewest = 9, most = 0;
  double fastest = 0;
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(s.step().ok()) << k << ": " << s.last().message;
    fewest = std::min(fewest, s.last().islands), most = std::max(most, s.last().islands);
    ASSERT_LT(s.last().left, 1e-11) << k;
    fastest = std::max(fastest, std::abs(s.state().nu[6]));
    const double angle = s.state().q[7];
    ASSERT_LT(std::abs(s.state().q[9] - (0.3 * std::cos(angle) + std::sqrt(0.64 - 0.09 * std::sin(angle) * std::sin(angle)))), 1e-11) << k;
  }
  EXPECT_EQ(fewest, 1);
  EXPECT_EQ(most, 2);
  EXPECT_GT(fastest, 0.1) << "the crate never pushed it";
}

}  // namespace
}  // namespace delassus::stepping_islands_test
