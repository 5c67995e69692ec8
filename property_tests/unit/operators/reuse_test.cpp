// Operators used for one problem after another; laws where blocks of the damping cover parts of constraints.
#include <gtest/gtest.h>

#include <algorithm>

#include "property_tests/defects/defects_wrong.h"
#include "property_tests/unit/operators/reuse.h"

namespace delassus::laws::reuse_test {
namespace {

TEST(Reuse, LeavesNoTrace) {
  const Case cases[] = {make_case("generic", 5, 1), make_case("chain", 2, 1), make_case("several_trees", 4, 1), make_case("block_damping", 3, 1),
                        make_case("hard", 3, 1), make_case("no_rows", 4, 1), make_case("joint_friction", 4, 1),
                        with_partial_blocks(make_case("generic", 4, 1), 1)};
  for (const OperatorRow& row : operators())
    for (const Case& before : cases)
      for (const Case& c : cases) EXPECT_EQ(trace_of_use(row, before, c), "");
}

TEST(Reuse, LostPivotsAreForgottenWithBetterNumbersOnly) {
  for (const OperatorRow& row : operators())
    for (const bool held : {true, false}) EXPECT_EQ(lost_pivot_forgotten(row, held), "");
}

void expect_laws(const Case& c) {
  c.damping.validate(*c.problem.structure);
  for (const OperatorRow& row : operators())
    for (const Outcome& o : check(row, c)) EXPECT_FALSE(o.failed()) << o.op << ", " << o.law << " on " << o.label << ": " << o.verdict.note;
}

TEST(Reuse, LawsHoldForPartialBlocks) {
  std::uint64_t seed = 1;
  for (const char* family : {"generic", "joint_friction", "several_trees"}) expect_laws(with_partial_blocks(make_case(family, 3, 1), seed++));
}

TEST(Reuse, LawsHoldForASingularBlock) {
  Case c = make_case("hard", 3, 1);
  const Index rows = c.problem.structure->link_constraints.at(0).rows, row = c.problem.structure->link_constraints[0].row;
  c.damping.blocks.push_back({row, MatrixX<double>::Ones(rows, rows)});
  expect_laws(c);
}

TEST(Reuse, LawsHoldWithoutFreedoms) { expect_laws(without_freedoms()); }

TEST(Reuse, LawsHoldForRowsOnAFreeJoint) { expect_laws(rows_on_a_free_joint()); }

TEST(Reuse, LawsHoldForMoreRowsThanFreedoms) { expect_laws(three_rows_on_one_freedom()); }

/// As if A had no more independent rows than there are freedoms: the others get no force.
OperatorRow rank_of_freedoms() {
  return defect<Place::answer>("rank_of_freedoms", "", [](auto a) {
           if (a.solve && a.s.rows > a.s.dofs()) a.y.bottomRows(a.s.rows - a.s.dofs()).setZero();
         }).op;
}

TEST(Reuse, MoreRowsThanFreedomsCanFail) {
  const std::vector<Outcome> all = check(rank_of_freedoms(), three_rows_on_one_freedom());
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const Outcome& o) { return o.failed(); }));
}

}  // namespace
}  // namespace delassus::laws::reuse_test
