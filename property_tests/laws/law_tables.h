// The laws as a whole, as tables for docs/verification.md: what applies to what, where no digit is promised, and how the
// ratios are distributed.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// Why the law does not apply; nullptr: it does. Some reasons are found by asking the operator, which may give up.
[[nodiscard]] const char* why_not(const LawRow& law, const OperatorRow& op, const Case& c);

/// Per law and operator, in the order of their tables: nullptr where the law applies to one at least of a few small pinned
/// problems, otherwise the reason met most often.
[[nodiscard]] std::vector<std::vector<const char*>> what_applies();

/// Laws that apply, and laws left out since 30 eps · bound reaches the answer, per family and operator.
class Promises {
 public:
  void add(std::string_view family, const OperatorRow& op, const char* why_not);
  /// A line per family and a column per operator where a tenth of the laws is left out: "left out of those that would apply".
  void print(std::ostream& out) const;

 private:
  struct Count {
    int applies = 0, unpromised = 0;
    [[nodiscard]] bool many() const { return unpromised > 0 && 10 * unpromised >= applies + unpromised; }
  };
  std::map<std::pair<std::string, std::string>, Count> counts_;  // (family, operator)
};

/// error / (eps · bound) of the laws that have a bound, per operator and bound.
class Ratios {
 public:
  void add(const Outcome& outcome);
  /// Of the ratios above zero: median, 99 %, largest.
  void print(std::ostream& out) const;

 private:
  std::map<std::pair<std::string, std::string>, std::vector<double>> ratios_;  // (operator, bound)
};

}  // namespace delassus::laws
