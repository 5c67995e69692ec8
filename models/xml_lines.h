// Lines of the named elements of a robot's file, for messages about what a library has read from it.
#pragma once

#include <map>
#include <string>
#include <utility>

namespace delassus {

class XmlLines {
 public:
  /// Knows nothing of a file that XML cannot be read from. What the file includes is not looked at. Cost O(size).
  explicit XmlLines(const std::string& file);
  /// The line of the one element of this kind and name; of `model::link`, where that is not there, of `link`. 0: none, or several.
  [[nodiscard]] int line(const std::string& kind, const std::string& name) const;
  /// `link "arm" (line 7)`, as far as it is known.
  [[nodiscard]] std::string element(const std::string& kind, const std::string& name) const;

 private:
  std::map<std::pair<std::string, std::string>, int> line_;
};

}  // namespace delassus
