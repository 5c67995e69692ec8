// The rooms of algorithms/ stand on floors: a file includes what is below it or beside it in its own room, never above.
//
//   dynamics       RNEA, CRBA, ABA, constrained forward dynamics
//   operators      the table and its rows
//   factors | mechanism
//   problem        the numbers between these two
//   kit            scalars and small vectors
//   errors         what goes wrong, in words
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, int> floor_of{{"errors", 0}, {"kit", 1}, {"problem", 2}, {"mechanism", 3}, {"factors", 3}, {"operators", 4}, {"dynamics", 5}, {"", 6}};

TEST(Rooms, ArrowsPointDown) {
  int arrows = 0;
  for (const auto& entry : fs::recursive_directory_iterator("algorithms")) {  // tests run in the source tree
    const fs::path& file = entry.path();
    if (file.extension() != ".h" && file.extension() != ".cpp") continue;
    const std::string room = fs::relative(file.parent_path(), "algorithms").string();
    const std::string here = room == "." ? "" : room;
    ASSERT_EQ(floor_of.count(here), 1u) << file << " stands in no room (property_tests/unit/mechanism/rooms_test.cpp)";
    std::ifstream in(file);
    const std::string marker = "#include \"";
    for (std::string line; std::getline(in, line);) {
      if (line.rfind(marker, 0) != 0) continue;
      const std::string included = line.substr(marker.size(), line.rfind('"') - marker.size());
      ASSERT_EQ(included.rfind("algorithms/", 0), 0u) << file << " includes " << included << " of another folder";
      const std::string there = fs::path(included).parent_path() == "algorithms" ? "" : fs::path(included).parent_path().filename().string();
      ASSERT_EQ(floor_of.count(there), 1u) << file << " includes " << included;
      EXPECT_TRUE(there == here || floor_of.at(there) < floor_of.at(here)) << file << " includes " << included << ", which stands above or beside it";
      ++arrows;
    }
  }
  EXPECT_GT(arrows, 100);
}

}  // namespace
