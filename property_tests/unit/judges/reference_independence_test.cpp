// The references share no code with the operators: following every #include "…" from reference/ reaches nothing but
// reference/ and the headers that say what a problem and a scalar is.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::set<std::string> allowed{
    "algorithms/problem/problem.h",  "algorithms/mechanism/kinematics.h", "algorithms/mechanism/loop_closing.h", "algorithms/mechanism/model.h",
    "algorithms/errors/status.h",    "algorithms/kit/spatial.h",          "algorithms/kit/scalars.h",            "algorithms/kit/test_scalars.h",
    "algorithms/kit/quad.h",         "algorithms/kit/counted.h",          "algorithms/kit/exact.h",              "algorithms/kit/stochastic.h",
    "simulation/contact_problem.h"};  // a plain value

fs::path root() { return fs::current_path(); }  // tests run in the source tree

std::vector<std::string> quoted_includes(const fs::path& file) {
  std::vector<std::string> found;
  std::ifstream in(file);
  const std::string marker = "#include \"";
  for (std::string line; std::getline(in, line);)
    if (line.rfind(marker, 0) == 0) found.push_back(line.substr(marker.size(), line.rfind('"') - marker.size()));
  return found;
}

TEST(ReferenceIndependence, IncludesNoOperatorHeader) {
  ASSERT_TRUE(fs::exists(root() / "reference"));
  std::vector<std::string> pending;
  for (const auto& entry : fs::directory_iterator(root() / "reference"))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      pending.push_back("reference/" + entry.path().filename().string());
  ASSERT_GT(pending.size(), 5u);
  std::set<std::string> seen;
  while (!pending.empty()) {
    const std::string file = pending.back();
    pending.pop_back();
    if (!seen.insert(file).second) continue;
    EXPECT_TRUE(file.rfind("reference/", 0) == 0 || allowed.count(file) == 1) << file << " is reached from reference/";
    for (const std::string& next : quoted_includes(root() / file)) pending.push_back(next);
  }
  EXPECT_EQ(seen.count("algorithms/delassus.h"), 0u);
  EXPECT_EQ(seen.count("algorithms/operators/operator.h"), 0u);
}

}  // namespace
