// Comparison of two files of results, slopes of swimmers, and what is said of them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "algorithms/errors/status.h"
#include "bench/compare.h"
#include "bench/scaling/figure2.h"
#include "bench/instruction_gate.h"

namespace delassus::bench::compare_judges_test {
namespace {

using nlohmann::json;

json time(double median, double spread = 0.1, int rounds = 15) {
  return {{"median", median}, {"quartiles", {median - spread / 2, median + spread / 2}}, {"rounds", rounds}};
}
json results(const json& update, long long operations = 100, long long bytes = 4000) {
  return {{"scenes", {{{"scene", "s"}, {"kinematics_microseconds", time(1)}, {"operators", {{{"operator", "op"}, {"microseconds", {{"update", update}, {"solve", nullptr}}},
          {"operations", {{"update", operations}, {"solve", nullptr}}}, {"bytes", bytes}}}}}}}};
}
const Change& change(const Comparison& c, const std::string& cell) {
  for (const Change& one : c.changes)
    if (one.cell == cell) return one;
  throw std::runtime_error(cell + " is not compared");
}

TEST(Compare, ATimeChangedWhenItsSpreadDoesNotExplainIt) {
  const auto update = [](const json& a, const json& b) { return change(compare(results(a), results(b), "a", "b"), "s · op · update"); };
  const Change slower = update(time(10), time(11));
  EXPECT_TRUE(slower.significant);
  EXPECT_NEAR(slower.relative, 0.1, 1e-12);
  EXPECT_NEAR(slower.notch, 2 * 1.57 * 0.1 / std::sqrt(15.0) / 10, 1e-12);
  EXPECT_FALSE(update(time(10), time(10.01)).significant);
  EXPECT_FALSE(update(time(10, 4), time(11, 4)).significant) << "the same change, widely spread";
  EXPECT_TRUE(update(time(10, 4, 400), time(11, 4, 400)).significant) << "and often measured";
  EXPECT_TRUE(update(time(11), time(10)).significant);
  EXPECT_FALSE(update(time(10), time(10)).significant);
}

TEST(Compare, CountsAreComparedExactly) {
  const Comparison c = compare(results(time(10), 100), results(time(10), 101), "a", "b");
  EXPECT_TRUE(change(c, "s · op · update · operations").significant);
  EXPECT_FALSE(change(c, "s · op · bytes").significant);
  EXPECT_EQ(c.worse(1.5), 1) << "no slack for counts";
  EXPECT_EQ(compare(results(time(10), 101), results(time(10), 100), "a", "b").worse(1.5), 0);
}

TEST(Compare, SlackIsForTimes) {
  EXPECT_EQ(compare(results(time(10)), results(time(14)), "a", "b").worse(1.5), 0);
  EXPECT_EQ(compare(results(time(10)), results(time(16)), "a", "b").worse(1.5), 1);
  EXPECT_EQ(compare(results(time(10, 40)), results(time(16, 40)), "a", "b").worse(1.5), 0) << "chance";
}

TEST(Compare, WhatOneFileLacksIsSaid) {
  json less = results(time(10));
  less["scenes"][0]["operators"][0].erase("bytes");
  const Comparison c = compare(results(time(10)), less, "a", "b");
  EXPECT_EQ(c.only_before, std::vector<std::string>{"s · op · bytes"});
  EXPECT_EQ(compare(less, results(time(10)), "a", "b").only_after, std::vector<std::string>{"s · op · bytes"});
  EXPECT_NE(comparison_text(c).find("1 cells in the first file alone"), std::string::npos);
  EXPECT_THROW(static_cast<void>(compare(results(time(10)), json::object(), "a", "b")), ModelError);
  const json lowest_alone{{"median", 10}, {"lowest", 9}, {"batches", 15}};
  EXPECT_NEAR(change(compare(results(lowest_alone), results(lowest_alone), "a", "b"), "s · op · update").notch, 2 * 1.57 * 2 / std::sqrt(15.0) / 10, 1e-12);
  EXPECT_THROW(static_cast<void>(compare(results({{"median", 10}}), results(time(10)), "a", "b")), ModelError) << "a file without spread";
}

TEST(Compare, TheDriftOfTheMachineIsTheChangeInCommon) {
  json a = results(time(10)), b = results(time(20));
  b["scenes"][0]["kinematics_microseconds"] = time(2);
  const Comparison c = compare(a, b, "a", "b");
  EXPECT_NEAR(c.drift, 1, 1e-12);
  EXPECT_NE(comparison_text(c).find("+100.0 % | ") , std::string::npos) << comparison_text(c);
  EXPECT_NE(comparison_text(c).find("+0.0 %"), std::string::npos);
}

TEST(Instructions, TwoPerCentEitherWay) {
  const json baseline{{"a", 1000}, {"b", 1000}};
  const auto off = [&](int a, int b) { return judge_instructions(baseline, {{"a", a}, {"b", b}}).off; };
  EXPECT_EQ(off(1000, 1000), 0);
  EXPECT_EQ(off(1019, 981), 0);
  EXPECT_EQ(off(1021, 1000), 1);
  EXPECT_EQ(off(979, 1021), 2);
  EXPECT_EQ(judge_instructions(baseline, {{"a", 1000}}).off, 1) << "a cell that was not counted";
  EXPECT_EQ(judge_instructions(baseline, {{"a", 1000}, {"b", 1000}, {"c", 1}}).off, 1) << "or has no baseline";
  std::size_t cells = 0;
  for (const auto& [scene, pairs] : gated_cells()) cells += pairs.size();
  EXPECT_GE(cells, 10);
}

TEST(Swimmers, SlopesAreThoseOfThePoints) {
  std::vector<std::pair<double, double>> cubic, with_constant;
  for (const double n : {3.0, 10.0, 30.0, 100.0, 300.0, 1000.0}) {
    cubic.emplace_back(n, 7 * n * n * n);
    with_constant.emplace_back(n, 2 * n + 1000);
  }
  EXPECT_NEAR(slope(cubic), 3, 1e-12);
  EXPECT_GT(slope(with_constant), 0.2);
  EXPECT_LT(slope(with_constant), 0.8) << "of the upper decade, a constant and all";
  EXPECT_TRUE(std::isnan(slope({{10, 1}})));
  EXPECT_TRUE(std::isnan(slope({{10, 1}, {1000, 5}}))) << "one of them is in the upper decade";
}

Figure2 swimmers() {
  Figure2 f;
  f.machine = {"p", "s", "c", "f", "r", "d", 2};
  for (const std::int64_t n : {10, 30, 100}) {
    SwimmerSize& s = f.sizes.emplace_back(SwimmerSize{n, n + 2, 6 * n, 1.0, {}});
    const auto x = static_cast<double>(n);
    s.cells = {{"linear", "", x, NAN, 2 * x, NAN, n}, {"square", n == 100 ? "left out from 100 links: too slow" : "", x * x, x * x, x * x, x * x, n * n}};
    if (n == 100) s.cells[1] = {"square", "left out from 100 links: too slow", NAN, NAN, NAN, NAN, -1};
  }
  return f;
}

TEST(Swimmers, SaysHowFarEachWentAndWhy) {
  const std::string text = figure2_text(swimmers());
  EXPECT_NE(text.find("left out from 100 links: too slow"), std::string::npos);
  EXPECT_NE(text.find("reached the end"), std::string::npos);
  EXPECT_NE(text.find("1.00"), std::string::npos);
  EXPECT_NE(text.find("2.00"), std::string::npos);
}

TEST(Swimmers, WhatIsWrittenIsRead) {
  const json written = swimmers();
  const Figure2 read = json::parse(written.dump()).get<Figure2>();
  EXPECT_EQ(json(read), written);
  EXPECT_EQ(figure2_text(read), figure2_text(swimmers()));
}

}  // namespace
}  // namespace delassus::bench::compare_judges_test
