// "did you mean": the distance of two names against its definition, and which name is offered.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "algorithms/errors/closest.h"

namespace delassus::names_test {
namespace {

/// By its definition, over all ways: a letter left out, put in, exchanged, or two neighbours swapped.
std::size_t by_definition(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  std::size_t least = std::min({by_definition(a.substr(1), b) + 1, by_definition(a, b.substr(1)) + 1, by_definition(a.substr(1), b.substr(1)) + (a[0] == b[0] ? 0 : 1)});
  if (a.size() > 1 && b.size() > 1 && a[0] == b[1] && a[1] == b[0]) least = std::min(least, by_definition(a.substr(2), b.substr(2)) + 1);
  return least;
}

TEST(Names, their_distance_is_the_least_number_of_changes) {
  std::mt19937 random(1);
  const auto word = [&] {
    std::string out(random() % 6, 'a');
    for (char& c : out) c = "abc"[random() % 3];
    return out;
  };
  for (int k = 0; k < 2000; ++k) {
    const std::string a = word(), b = word();
    EXPECT_EQ(edit_distance(a, b), by_definition(a, b)) << a << ' ' << b;
  }
}

std::string meant(const std::string& text, const std::vector<std::string>& names) { return did_you_mean(text, names); }

TEST(Names, the_nearest_is_offered_when_at_most_a_third_differs) {
  EXPECT_EQ(meant("elbow", {"elbow_l", "elbaw", "knee"}), "did you mean elbaw? ");
  EXPECT_EQ(meant("elbow", {"elbaw", "elbow_l", "knee"}), "did you mean elbaw? ");
  EXPECT_EQ(meant("elbow", {"elbew", "elbaw"}), "did you mean elbew? ") << "of two as near the first";
  EXPECT_EQ(meant("abcdef", {"abcdxy"}), "did you mean abcdxy? ") << "two of six";
  EXPECT_EQ(meant("abcdef", {"abcxyz"}), "") << "three of six";
  EXPECT_EQ(meant("abcdef", {"abcd"}), "did you mean abcd? ");
  EXPECT_EQ(meant("abcd", {"abcdef"}), "did you mean abcdef? ");
  EXPECT_EQ(meant("knee", {"hip", "ankle"}), "");
  EXPECT_EQ(meant("", {"hip"}), "");
  EXPECT_EQ(meant("hip", {}), "");
  EXPECT_EQ(meant("hip", {"hip"}), "did you mean hip? ");
  const std::string longest(200, 'a'), longer(201, 'a');
  EXPECT_EQ(meant(longest.substr(1), {longest}), "did you mean " + longest + "? ");
  EXPECT_EQ(meant(longest, {longest.substr(1)}), "did you mean " + longest.substr(1) + "? ");
  EXPECT_EQ(meant(longest, {longer}), "");
  EXPECT_EQ(meant(longer, {longest}), "");
  EXPECT_EQ(meant(longest, {longer, longest}), "did you mean " + longest + "? ") << "the long one is passed over";
}

}  // namespace
}  // namespace delassus::names_test
