// What many outcomes come to: per law and operator the worst ratio, and what was skipped and why.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

class Summary {
 public:
  void add(const Outcome& outcome);
  /// One line per law and operator: checked, failed, skipped, worst ratio and where; then the reasons for skips; then
  /// the first `most` failures.
  void print(std::ostream& out, std::size_t most = 20) const;
  [[nodiscard]] std::int64_t checked() const { return checked_; }
  [[nodiscard]] std::int64_t failed() const { return static_cast<std::int64_t>(failures_.size()); }

 private:
  struct Cell {
    std::int64_t checked = 0, failed = 0, skipped = 0;
    Verdict worst;
    std::string where;
  };
  std::map<std::pair<std::string, std::string>, Cell> cells_;    // (operator, law)
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::int64_t>> reasons_;
  std::vector<Outcome> failures_;
  std::int64_t checked_ = 0;
};

/// One line: law, operator, case, ratio and note.
void print(std::ostream& out, const Outcome& outcome);

}  // namespace delassus::laws
