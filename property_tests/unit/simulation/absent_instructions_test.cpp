// What a scene does not call for has no instruction in the run: counted one by one, of every effect; and what is allowed but unused has few.
#include <gtest/gtest.h>

#include <set>
#include <typeindex>

#include "property_tests/unit/simulation/single_step.h"
#include "property_tests/unit/simulation/absence.h"

namespace delassus::absent_instructions_test {
namespace {

using namespace stepping;

/// The classes of all terms of a plan.
std::set<std::type_index> classes_of(const StepPlan<double>& p) {
  std::set<std::type_index> out;
  const auto take = [&](const auto& list) {
    for (const auto* term : list) out.insert(typeid(*term));
  };
  take(p.inertias), take(p.forces), take(p.detections), take(p.rows), take(p.events), take(p.rests);
  return out;
}

/// What an effect brings into the plan of a scene: the code of the classes of its terms.
std::vector<Code> own_code(const Scene& scene, const Settings& with, const Settings& without) {
  std::vector<const std::type_info*> own;
  const StepPlan<double> all(scene, with), rest(scene, without);
  const auto others = classes_of(rest);
  const auto take = [&](const auto& list) {
    for (const auto* term : list)
      if (others.count(typeid(*term)) == 0) own.push_back(&typeid(*term));
  };
  take(all.inertias), take(all.forces), take(all.detections), take(all.rows), take(all.events), take(all.rests);
  return own.empty() ? std::vector<Code>{} : code_of(own);
}

/// Instructions of the third step; none where it fails.
Instructions of_a_step(const Scene& scene, const Settings& settings, const std::vector<Code>& code = {}) {
  Simulation<double> s(scene, settings);
  if (!s.step().ok() || !s.step().ok()) return {};
  bool ok = false;
  const Instructions n = count_instructions([&] { ok = s.step().ok(); }, code);
  return ok ? n : Instructions{};
}

Settings leaving_out(const std::string& effect) {
  Settings s = step_of(1e-3);
  s.without = {effect};
  return s;
}

#define NEEDS_COUNTS() \
  if (!can_count_instructions()) GTEST_SKIP() << "this machine, or this build, cannot stop behind each instruction"

struct AbsentInstructions : testing::TestWithParam<std::string> {};

TEST_P(AbsentInstructions, none_is_executed_and_a_step_has_those_of_the_smaller_program) {
  NEEDS_COUNTS();
  const std::string effect = GetParam();
  const Scene scene = callers().at(effect)();
  Scene bare = scene;
  never_written(effect, bare);
  const std::vector<EffectRow> smaller = table_without(effect);
  Settings program = step_of(1e-3);
  program.table = &smaller;
  Settings as_bare = step_of(1e-3);  // without what the key brings along
  for (const EffectRow& row : effects())
    if (row.call(scene).called && !row.call(bare).called) as_bare.without.emplace_back(row.name);
  const std::vector<Code> own = own_code(scene, step_of(1e-3), leaving_out(effect));
  const Instructions with = of_a_step(scene, step_of(1e-3), own), without = of_a_step(scene, leaving_out(effect), own), of_smaller = of_a_step(scene, program),
                     of_bare = of_a_step(bare, step_of(1e-3)),
                     without_as_bare = as_bare.without == std::vector{effect} ? without : of_a_step(scene, as_bare);
  ASSERT_GT(without.all, 0);
  EXPECT_EQ(without.inside, 0);
  if (own.empty()) {
    EXPECT_GT(with.all, without.all);  // rows of equations have no code of their own
  } else {
    EXPECT_GT(with.inside, 0);  // of all there may be fewer: with it a solver may end sooner
  }
  EXPECT_EQ(without.all, of_smaller.all);
  if (effect != "velocity products") {
    EXPECT_EQ(without_as_bare.all, of_bare.all);
  }
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& [effect, make] : callers()) out.push_back(effect);
  return out;
}
std::string as_a_word(const testing::TestParamInfo<std::string>& info) {
  std::string out = info.param;
  std::replace(out.begin(), out.end(), ' ', '_');
  return out;
}
INSTANTIATE_TEST_SUITE_P(Effects, AbsentInstructions, testing::ValuesIn(names()), as_a_word);

TEST(AbsentInstructions, a_leak_is_seen) {
  NEEDS_COUNTS();
  const std::vector<EffectRow> leaky = table_with_a_leak();
  const Scene scene = everything_smooth();
  const std::vector<Code> own = own_code(scene, step_of(1e-3), leaving_out("springs"));
  Settings program = leaving_out("springs");
  program.table = &leaky;
  const Instructions leaks = of_a_step(scene, program, own), tight = of_a_step(scene, leaving_out("springs"), own);
  EXPECT_GT(leaks.inside, 0);
  EXPECT_GT(leaks.all, tight.all);
}

/// A cube that slides: what is asked for and never happens, in parts of a step without it.
Scene sliding_cube() {
  Scene s = resting_box();
  s.motion.sleeping = {};
  s.motion.nu[3] = 0.02;
  return s;
}

TEST(AllowedButUnused, sleeping_where_nothing_sleeps_and_restitution_where_nothing_bounces) {
  NEEDS_COUNTS();
  Scene drowsy = sliding_cube(), bouncy = sliding_cube();
  drowsy.motion.sleeping = {1e-3, 1e-3, 0.01};
  bouncy.motion.restitution = 0.5;
  const auto absent = static_cast<double>(of_a_step(sliding_cube(), step_of(1e-3)).all);
  ASSERT_GT(absent, 0);
  for (const Scene& allowed : {drowsy, bouncy}) {
    const auto n = static_cast<double>(of_a_step(allowed, step_of(1e-3)).all);
    std::printf("%.0f instructions a step, %.0f without: %.2f %%\n", n, absent, 100 * (n / absent - 1));
    EXPECT_GT(n, absent);
    EXPECT_LE(n, 1.02 * absent);
  }
}

/// The price list of docs/simulation.md.
void print_prices() {
  std::printf("| effect | in the step of | with it | without | its own |\n|---|---|---|---|---|\n");
  for (const auto& [effect, make] : callers()) {
    const Scene scene = make();
    const Instructions with = of_a_step(scene, step_of(1e-3), own_code(scene, step_of(1e-3), leaving_out(effect))), without = of_a_step(scene, leaving_out(effect));
    const StepPlan<double> plan(scene, step_of(1e-3));
    const auto bodies = scene.model.bodies.size();
    std::printf("| %s | %zu %s, path %s | %lld | %lld | %lld |\n", effect.c_str(), bodies, bodies == 1 ? "body" : "bodies", std::string(plan.path->name()).c_str(),
                static_cast<long long>(with.all), static_cast<long long>(without.all), static_cast<long long>(with.inside));
  }
}

}  // namespace
}  // namespace delassus::absent_instructions_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc == 2 && std::string(argv[1]) == "--markdown") return delassus::absent_instructions_test::print_prices(), 0;
  return RUN_ALL_TESTS();
}
