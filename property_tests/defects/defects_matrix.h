// The matrix defect × law: as measured, as a page shows it, and whether a page still says what is measured.
#pragma once

#include <string>
#include <vector>

#include "property_tests/defects/defects.h"

namespace delassus::laws {

/// One law held against one defect.
struct Entry {
  bool caught = false;
  double ratio = 0;   ///< the largest; the first that broke the law when it is caught

  /// Within a factor ten of the limit: another machine may round to the other side.
  [[nodiscard]] bool near() const { return ratio > pass_below / 10 && ratio < pass_below * 10; }
};

struct DefectMatrix {
  std::vector<const DefectRow*> defects;
  std::vector<std::vector<Entry>> entries;   ///< of every defect, in the order of laws()

  /// Laws that catch a defect, in the order of the table.
  [[nodiscard]] std::vector<std::string_view> caught_by(std::size_t defect) const;
};

/// Two tables in markdown: the laws, numbered, with what they catch; and the grid. A law and its exact twin share a column.
/// The laws of two threads share the last one and are entered only where no other law catches the defect: what else they
/// catch depends on when the threads meet.
[[nodiscard]] std::string page(const DefectMatrix& matrix);

/// Where a page's text and the measured matrix differ, entries near the limit aside; one line each.
[[nodiscard]] std::vector<std::string> differences(const DefectMatrix& matrix, const std::string& text);

}  // namespace delassus::laws
