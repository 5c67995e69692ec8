// Shrinking: it ends, is repeatable, keeps what the predicate asks for, and leaves nothing it could have dropped.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "generators/arbitrary.h"
#include "generators/build.h"
#include "generators/classes.h"
#include "generators/families.h"
#include "generators/shrink.h"

namespace delassus::generators::shrink_test {
namespace {

bool in_class(const Spec& spec, std::string_view name) {
  const Built built = build(spec);
  const std::vector<bool> in = classes_of(spec, built);
  for (std::size_t k = 0; k < in.size(); ++k)
    if (classes()[k].name == name) return in[k];
  ADD_FAILURE() << "no class " << name;
  return false;
}

TEST(Shrink, EveryMoveLeavesASpecThatBuildsAndIsSimpler) {
  std::set<MoveKind> seen;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Spec spec = arbitrary(seed);
    if (spec.bodies.size() > 30) continue;
    for (const Move& m : moves(spec)) {
      const std::optional<Spec> next = moved(spec, m);
      if (!next) continue;
      seen.insert(m.kind);
      EXPECT_NE(to_json(*next), to_json(spec)) << static_cast<int>(m.kind);
      EXPECT_NO_THROW(static_cast<void>(build(*next))) << to_json(*next);
    }
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(MoveKind::ends)) << "a kind of move never applied";
}

TEST(Shrink, WhatHangsOnADroppedBodyGoesToItsNearestAncestor) {
  Spec spec = find_family("chain").make(5, 1);
  spec.links.resize(1);
  spec.links[0].kind = ConstraintKind::generic;
  spec.links[0].bodies = {3, 4, 0};
  const std::optional<Spec> next = moved(spec, {MoveKind::drop_bodies, 2, 2});
  ASSERT_TRUE(next);
  ASSERT_EQ(next->bodies.size(), 3u);
  EXPECT_EQ(next->bodies[2].parent, 1);
  EXPECT_EQ(next->links[0].bodies, (std::vector<Index>{1, 2, 0}));
}

TEST(Shrink, WhateverFailsShrinksToNothing) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Shrunk s = shrink(arbitrary(seed), [](const Spec&) { return true; });
    EXPECT_TRUE(s.finished);
    EXPECT_TRUE(s.spec.bodies.empty() && s.spec.links.empty() && s.spec.joints.empty()) << to_json(s.spec);
  }
}

TEST(Shrink, IsRepeatableAndKeepsTheFailure) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Spec spec = arbitrary(seed);
    const auto fails = [](const Spec& s) { return s.bodies.size() % 3 == 1 || s.links.size() > 2; };
    if (!fails(spec)) continue;
    const Shrunk first = shrink(spec, fails), again = shrink(spec, fails);
    EXPECT_EQ(to_json(first.spec), to_json(again.spec));
    EXPECT_EQ(first.tried, again.tried);
    EXPECT_TRUE(fails(first.spec));
  }
}

TEST(Shrink, StopsAfterTheTriesItMayMake) {
  const Shrunk s = shrink(find_family("lattice").make(16, 1), [](const Spec& x) { return x.bodies.size() > 12; }, 5);
  EXPECT_EQ(s.tried, 5);
  EXPECT_FALSE(s.finished);
}

/// What each class needs at the least, reached from a large example.
TEST(Shrink, ReachesTheSmallestOfAClass) {
  const struct {
    const char *family, *in;
    Index n;
    std::size_t bodies, constraints;
  } cases[] = {{"ring", "closed loops", 12, 2, 1},       {"lattice", "coupled loops", 16, 3, 2},
               {"humanoid", "joint friction", 26, 1, 1}, {"mass_ratio", "mass ratio above 1e6", 10, 2, 0},
               {"several_trees", "several trees", 18, 2, 0}, {"mixed_damping", "20-decade damping", 18, 1, 2}};
  for (const auto& c : cases) {
    const Spec spec = find_family(c.family).make(c.n, 1);
    ASSERT_TRUE(in_class(spec, c.in)) << c.family;
    const Shrunk s = shrink(spec, [&](const Spec& x) { return in_class(x, c.in); });
    EXPECT_TRUE(s.finished) << c.in << " after " << s.tried;
    EXPECT_EQ(s.spec.bodies.size(), c.bodies) << c.in << to_json(s.spec);
    EXPECT_LE(s.spec.links.size() + s.spec.joints.size(), c.constraints) << c.in << to_json(s.spec);
  }
}

TEST(Shrink, SimplifiesWhatDoesNotMatter) {
  const Spec spec = find_family("near_singular").make(6, 1);
  const Shrunk s = shrink(spec, [](const Spec& x) { return !x.bodies.empty(); });
  ASSERT_EQ(s.spec.bodies.size(), 1u);
  const BodySpec& b = s.spec.bodies[0];
  EXPECT_EQ(b.joint, JointKind::revolute);
  EXPECT_EQ(b.mass_decade, std::optional<int>(0));
  EXPECT_FALSE(b.bend_decade);
  EXPECT_EQ(b.axis, (std::array<int, 3>{0, 0, 1}));
}

}  // namespace
}  // namespace delassus::generators::shrink_test
