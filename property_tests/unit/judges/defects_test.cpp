// The random search finds every defect of the table and shrinks it to at most four bodies.
#include <gtest/gtest.h>

#include "property_tests/defects/defects.h"
#include "property_tests/laws/search.h"

namespace delassus::laws::defects_test {
namespace {

Found found_in(const DefectRow& d) {
  Search s;
  s.seed = 7;
  s.count = 3000;
  s.ops = {d.op};
  s.left_out = left_out(d);
  return search(s);
}

TEST(Defects, AreFoundAndShrunkToFourBodies) {
  std::printf("%-28s %9s %8s %6s %6s %6s  %s\n", "defect", "problems", "bodies", "shrunk", "steps", "s", "law");
  for (const DefectRow& d : defects()) {
    if (d.right()) continue;
    if (d.unseen) {
      std::printf("%-28s not searched for: %s\n", std::string(d.name).c_str(), d.unseen);
      continue;
    }
    const Found f = found_in(d);
    ASSERT_EQ(f.failures.size(), 1u) << d.name;
    const Failure& x = f.failures[0];
    std::printf("%-28s %9lld %8zu %6zu %6d %6.2f  %s\n", std::string(d.name).c_str(), static_cast<long long>(f.problems), x.found_bodies,
                x.spec.bodies.size(), x.tried, f.seconds, x.law.c_str());
    std::fflush(stdout);
    EXPECT_LE(x.spec.bodies.size(), 4u) << d.name << generators::to_json(x.spec);
    EXPECT_TRUE(check(find_law(x.law), d.op, make_case(x.spec)).failed()) << d.name;
  }
}

TEST(Defects, HaveDifferentNamesAndRightOperatorsThatExist) {
  std::vector<std::string_view> names;
  for (const DefectRow& d : defects()) {
    EXPECT_EQ(d.name, d.op.name);
    EXPECT_EQ(std::count(names.begin(), names.end(), d.name), 0) << d.name;
    names.push_back(d.name);
    if (!d.right() && d.base != "paper_corrected") { EXPECT_NO_THROW(static_cast<void>(find_operator(d.base))) << d.name; }
  }
  EXPECT_GE(names.size(), 70u);
  EXPECT_THROW(static_cast<void>(find_defect("none")), ModelError);
}

}  // namespace
}  // namespace delassus::laws::defects_test
