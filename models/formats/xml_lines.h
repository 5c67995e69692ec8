// Lines of the named elements of a robot's file, for messages about what a library has read from it.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace delassus {

class XmlLines {
 public:
  /// Knows nothing of a file that XML cannot be read from. What the file includes is not looked at. Cost O(size).
  explicit XmlLines(const std::string& file);
  /// The line of the one element of this kind and name; of `model::link`, where that is not there, of `link`. 0: none, or several.
  [[nodiscard]] int line(const std::string& kind, const std::string& name) const;
  [[nodiscard]] bool has(const std::string& kind, const std::string& name) const { return !lines(kind, name).empty(); }
  /// `link "arm" (line 7)`, as far as it is known; `(line 7 or 9)` of two.
  [[nodiscard]] std::string element(const std::string& kind, const std::string& name) const;

 private:
  [[nodiscard]] std::vector<int> lines(const std::string& kind, const std::string& name) const;
  std::map<std::pair<std::string, std::string>, std::vector<int>> lines_;
};

}  // namespace delassus
