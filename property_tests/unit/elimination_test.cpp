// The plan of elimination against a model of it made of sets.
#include <gtest/gtest.h>

#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/plan_model.h"

namespace delassus {
namespace {

TEST(Elimination, PlansAreWhatTheModelSays) {
  for (const auto& family : generators::families())
    for (const Index n : {1, 2, 5, 13, 24})
      for (const std::uint64_t seed : {1, 2}) {
        const auto s = generators::build(family.make(n, seed)).problem.structure;
        for (const Matrix matrix : {Matrix::M, Matrix::M_R})
          for (const Branches branches : {Branches::with_rows, Branches::all})
            EXPECT_EQ(plan_broken(make_plan(*s, matrix, branches), *s, matrix, branches), "") << family.name << " n=" << n << " seed=" << seed;
      }
}

TEST(Elimination, TheModelNoticesWrongPlans) {
  const auto s = generators::build(generators::find_family("lattice").make(9, 1)).problem.structure;
  const Plan plan = make_plan(*s, Matrix::M_R);
  const auto broken = [&](const auto& change) {
    Plan wrong = plan;
    change(wrong);
    return plan_broken(wrong, *s, Matrix::M_R, Branches::with_rows);
  };
  EXPECT_EQ(broken([](Plan&) {}), "");
  EXPECT_NE(broken([](Plan& p) { std::swap(p.body[0], p.body[4]), std::swap(p.step[p.body[0]], p.step[p.body[4]]); }), "");
  EXPECT_NE(broken([](Plan& p) { p.members.front().step += 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.members.front().block = -1; }), "");
  EXPECT_NE(broken([](Plan& p) { std::swap(p.pairs[0], p.pairs[1]); }), "");
  EXPECT_NE(broken([](Plan& p) { p.blocks += 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active = 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.matrix = Matrix::M; }), "");
  EXPECT_NE(broken([](Plan& p) { p.runs.front().end -= 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.runs.front().chain = !p.runs.front().chain; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active_run += 1; }), "");
}

}  // namespace
}  // namespace delassus
