// What a scene does not call for has no bit, no operation, no byte in the run: the proofs, for every effect of the table.
#include <gtest/gtest.h>

#include "property_tests/unit/simulation/absence.h"

namespace delassus::absence_test {
namespace {

using namespace stepping;

template <class T> const PlanLine& line_of(const StepPlan<T>& plan, const std::string& effect) {
  for (const PlanLine& line : plan.lines)
    if (line.effect->name == effect) return line;
  throw std::logic_error("no line of " + effect);
}

bool same_bits(const State<double>& a, const State<double>& b) { return a.q.size() > 0 && a.q == b.q && a.nu == b.nu; }

TEST(Absence, bits_and_operations_are_those_of_a_program_without_the_row) {
  for (const auto& [effect, make] : callers()) {
    const Scene scene = make();
    const std::vector<EffectRow> smaller = table_without(effect);
    ASSERT_EQ(smaller.size() + 1, effects().size());
    Settings without = step_of(1e-3), program = without;
    without.without = {effect};
    program.table = &smaller;
    EXPECT_TRUE(same_bits(run(scene, without, 20), run(scene, program, 20))) << effect;
    EXPECT_EQ(operations(scene, without, 5), operations(scene, program, 5)) << effect;
    EXPECT_FALSE(same_bits(run(scene, without, 20), run(scene, step_of(1e-3), 20))) << effect << ": the scene does not call for it";
  }
}

TEST(Absence, bits_and_operations_are_those_of_a_scene_without_the_key) {
  for (const auto& [effect, make] : callers()) {
    if (effect == "velocity products") continue;  // no key: they follow from the joints
    const Scene scene = make();
    Scene bare = scene;
    never_written(effect, bare);
    Settings without = step_of(1e-3);
    without.without = {effect};
    EXPECT_TRUE(same_bits(run(scene, without, 20), run(bare, step_of(1e-3), 20))) << effect;
    EXPECT_EQ(operations(scene, without, 5), operations(bare, step_of(1e-3), 5)) << effect;
    EXPECT_LT(operations(bare, step_of(1e-3), 5), operations(scene, step_of(1e-3), 5)) << effect;
  }
}

TEST(Absence, the_proofs_see_a_leak) {
  const std::vector<EffectRow> leaky = table_with_a_leak();
  const Scene scene = everything_smooth();
  Scene bare = scene;
  bare.motion.springs.clear();
  Settings without = step_of(1e-3), program = without;
  without.table = program.table = &leaky;
  without.without = {"springs"};
  EXPECT_FALSE(same_bits(run(scene, without, 20), run(bare, program, 20)));
}

TEST(Absence, what_is_not_in_the_plan_has_no_byte_and_no_term) {
  for (const auto& [effect, make] : callers()) {
    const Scene scene = make();
    const StepPlan<double> with(scene, step_of(1e-3));
    EXPECT_TRUE(line_of(with, effect).in) << effect;
    EXPECT_GT(line_of(with, effect).bytes, 0) << effect;
    Settings left_out = step_of(1e-3);
    left_out.without = {effect};
    const StepPlan<double> plan(scene, left_out);
    EXPECT_FALSE(line_of(plan, effect).in) << effect;
    EXPECT_EQ(line_of(plan, effect).bytes, 0) << effect;
    EXPECT_EQ(line_of(plan, effect).terms, "") << effect;
    Index expected = with.bytes() - line_of(with, effect).bytes;
    for (const PlanLine& line : with.lines)
      if (line.effect->needs == effect) expected -= line.bytes;  // what has nothing to act on goes too
    EXPECT_EQ(plan.bytes(), expected) << effect;
  }
}

TEST(Absence, velocity_products_are_proved_away) {
  const Scene cube = free_body({0.4, 0.4, 0.4}), brick = free_body({0.4, 0.4, 0.5});
  EXPECT_FALSE(line_of(StepPlan<double>(cube, {}), "velocity products").in);
  EXPECT_TRUE(line_of(StepPlan<double>(brick, {}), "velocity products").in);
  Model lift;
  lift.add(body("a", ground, JointType::prismatic, 1, {1, 2, 3}));
  lift.add(body("b", 0, JointType::prismatic, 1, {1, 2, 3}, {0.1, 0.2, 0.3}, {1, 0, 0}));
  EXPECT_FALSE(line_of(StepPlan<double>(scene_of(lift), {}), "velocity products").in);
  EXPECT_FALSE(line_of(StepPlan<double>(pendulum(1), {}), "velocity products").in);
  EXPECT_TRUE(line_of(StepPlan<double>(double_pendulum(), {}), "velocity products").in);
}

/// All terms forced on agree within rounding where what is proved away is zero, and cost what was saved.
TEST(Absence, everything_forced_on_agrees_within_rounding) {
  for (const Scene& scene : {free_body({0.4, 0.4, 0.4}), pendulum(1)}) {
    Settings all = step_of(1e-3);
    all.everything = true;
    const State<double> a = run(scene, step_of(1e-3), 100), b = run(scene, all, 100);
    ASSERT_EQ(a.q.size(), b.q.size());
    EXPECT_LT((a.q - b.q).norm() / (0x1p-53 * 100 * (1 + a.q.norm())), 30);
    EXPECT_GT(operations(scene, all, 5), operations(scene, step_of(1e-3), 5) + 5 * 100);
  }
}

/// Every row of the table is held by the tests above.
TEST(Absence, every_effect_has_a_caller) {
  for (const EffectRow& row : effects()) {
    const bool as_loops = row.name == "other joints";  // the same rows without assembly
    EXPECT_EQ(callers().count(as_loops ? "loops" : std::string(row.name)), 1u) << row.name;
  }
}

}  // namespace
}  // namespace delassus::absence_test
