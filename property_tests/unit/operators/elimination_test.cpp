// The plan of elimination against a model of it made of sets.
#include <gtest/gtest.h>

#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/unit/operators/plan_model.h"

namespace delassus::elimination_test {
namespace {

TEST(Elimination, PlansAreWhatTheModelSays) {
  for (const auto& family : generators::families())
    for (const Index n : {1, 2, 5, 13, 24})
      for (const std::uint64_t seed : {1, 2}) {
        const auto s = generators::build(family.make(n, seed)).problem.structure;
        const Plan of_M_R = make_plan(*s, Matrix::M_R);
        EXPECT_EQ(plan_broken(mass_plan(*s, of_M_R), *s, Matrix::M, Branches::with_rows, &of_M_R), "") << family.name << " n=" << n << " seed=" << seed;
        for (const Matrix matrix : {Matrix::M, Matrix::M_R})
          for (const Branches branches : {Branches::with_rows, Branches::all})
            EXPECT_EQ(plan_broken(make_plan(*s, matrix, branches), *s, matrix, branches), "") << family.name << " n=" << n << " seed=" << seed;
      }
}

TEST(Elimination, TheModelNoticesWrongPlans) {
  const auto s = generators::build(generators::find_family("lattice").make(9, 1)).problem.structure;
  const auto broken = [&](const auto& change) {
    Plan wrong = make_plan(*s, Matrix::M_R);
    change(wrong);
    return plan_broken(wrong, *s, Matrix::M_R, Branches::with_rows);
  };
  const auto entry = []<class E>(std::span<const E> list, int k = 0) -> E& { return const_cast<E&>(list[k]); };  // of memory that may change
  EXPECT_EQ(broken([](Plan&) {}), "");
  EXPECT_NE(broken([&](Plan& p) { std::swap(entry(p.body, 0), entry(p.body, 4)), std::swap(entry(p.step, p.body[0]), entry(p.step, p.body[4])); }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.members).step += 1; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.members).block = -1; }), "");
  EXPECT_NE(broken([&](Plan& p) { std::swap(entry(p.pairs, 0), entry(p.pairs, 1)); }), "");
  EXPECT_NE(broken([](Plan& p) { p.blocks += 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active = 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.matrix = Matrix::M; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.runs).end -= 1; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.runs).chain = !p.runs.front().chain; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active_run += 1; }), "");
  const Plan of_M_R = make_plan(*s, Matrix::M_R);
  EXPECT_NE(plan_broken(make_plan(*s, Matrix::M), *s, Matrix::M, Branches::with_rows, &of_M_R), "") << "its own order";
}

}  // namespace
}  // namespace delassus::elimination_test
