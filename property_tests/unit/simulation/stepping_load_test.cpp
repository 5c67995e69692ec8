// Many boxes that settle: what a step does per contact does not depend on how many there are.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "algorithms/kit/counted.h"
#include "property_tests/unit/allocations.h"
#include "property_tests/campaigns/settling.h"
#include "property_tests/unit/simulation/single_step.h"
#include "property_tests/unit/simulation/stepping_scenes.h"
#include "simulation/islands.h"
#include "simulation/solvers.h"

namespace delassus::laws {
std::int64_t (*allocation_count)() = nullptr;  // set by count_allocations
}

namespace delassus::stepping_load_test {
namespace {

using namespace stepping;

double processor_time() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Counted: iterations of solvers and allocations. Ten times the stacks are ten times the islands, each with the bits it has alone.
TEST(Load, what_is_counted_grows_with_the_contacts) {
  laws::count_allocations();
  const Settling few = settle(stacks(100), 60, 1e-10, processor_time), many = settle(stacks(1000), 60, 1e-10, processor_time);
  ASSERT_EQ(few.wrong + many.wrong, "");
  EXPECT_EQ(few.islands, 20);
  EXPECT_EQ(few.last_contacts, 400);
  EXPECT_EQ(many.contacts, 10 * few.contacts);
  EXPECT_EQ(many.iterations, 10 * few.iterations);
  EXPECT_LT(many.speed, 1e-2);
  if (laws::allocation_count == nullptr) GTEST_SKIP() << "allocations are not counted here";
  EXPECT_LT(many.allocations, 11 * few.allocations) << "beside what a step allocates whatever it holds";
}

TEST(Load, operations_of_a_step_grow_with_the_boxes) {
  const auto operations = [](const Scene& scene) {
    Simulation<Counted> s(scene, step_of(1e-3));
    for (int k = 0; k < 50; ++k) EXPECT_TRUE(s.step().ok());
    operation_count = {};
    EXPECT_TRUE(s.step().ok());
    EXPECT_EQ(s.last().path, "cones");
    return static_cast<double>(operation_count.additions + operation_count.multiplications + operation_count.divisions);
  };
  const double few = operations(stacks(50)), many = operations(stacks(200));
  EXPECT_NEAR(many / few, 4, 0.01);
}

// One island: an iteration costs as much as its contacts, and there are no more of them for its length.
TEST(Load, a_wall_needs_no_more_iterations_for_its_length) {
  const Settling few = settle(wall(50), 40, 1e-8, processor_time), many = settle(wall(400), 40, 1e-8, processor_time);
  ASSERT_EQ(few.wrong + many.wrong, "");
  EXPECT_EQ(few.islands, 1);
  EXPECT_EQ(many.islands, 1);
  EXPECT_LT(many.iterations_at_end, 2 * few.iterations_at_end);
}

// Whether a solver takes a problem is asked in every step: a search among the constraints for every contact.
TEST(Load, what_is_refused_is_known_by_a_search_for_each_contact) {
  if (!can_count_instructions()) GTEST_SKIP() << "instructions are not counted here";
  const auto instructions = [](Index contacts) {
    auto s = std::make_shared<Structure>();
    for (Index i = 0; i < contacts; ++i) s->add_body(ground, 6);
    for (Index i = 0; i < contacts; ++i) s->add_link_constraint(3, {i});
    ContactProblem<double> p;
    p.mechanism = std::make_shared<const Problem<double>>(s);
    p.resize(3 * contacts);
    for (Index i = 0; i < contacts; ++i) append_contact(p, 0.5);
    const auto solver = find_solver("proximal").make();
    EXPECT_EQ(solver->refusal(p), "");
    return static_cast<double>(count_instructions([&] { (void)solver->refusal(p); }).all);
  };
  EXPECT_LT(instructions(400) / instructions(50), 8 * std::log(400) / std::log(50));
}

// Islands are made by instructions like their own bodies: eight times as many, not sixty-four.
TEST(Load, islands_are_made_by_instructions_like_their_bodies) {
  if (!can_count_instructions()) GTEST_SKIP() << "instructions are not counted here";
  const auto instructions = [](Index trees) {
    Structure s;
    for (Index i = 0; i < trees; ++i) s.add_body(ground, 6);
    for (Index i = 0; i < trees; ++i) s.add_link_constraint(3, {i});
    const Islands islands(s);
    std::size_t bodies = 0;
    const auto make = [&] {
      bodies = 0;
      for (Index t = 0; t < trees; ++t) bodies += Part<double>(s, islands, {t}).bodies.size();
    };
    make();
    EXPECT_EQ(bodies, static_cast<std::size_t>(trees));
    return static_cast<double>(count_instructions(make).all);
  };
  EXPECT_LT(instructions(48) / instructions(6), 8.5);
}

}  // namespace
}  // namespace delassus::stepping_load_test
