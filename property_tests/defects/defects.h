// The table of defects: operators that are wrong in one respect each. A law is worth as much as the defects it catches,
// and a defect that no law catches is a hole in the table of laws.
//
//   for (const DefectRow& d : defects()) check(d.op, make_case("generic", 5, 1)) …
#pragma once

#include <string>
#include <vector>

#include "property_tests/laws/laws.h"

namespace delassus::laws {

struct DefectRow {
  std::string_view name;
  std::string what;         ///< what is wrong; of the right ones, what they are
  std::string_view base;    ///< the right operator it was made from; empty: it is right itself
  OperatorRow op;           ///< its name is the defect's
  const char* unseen = nullptr;   ///< why the random search need not find it; nullptr: it must
  bool allocates = false;         ///< so does its right operator behind the same wrapper

  [[nodiscard]] bool right() const { return base.empty(); }
};

/// The right ones first.
[[nodiscard]] const std::vector<DefectRow>& defects();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const DefectRow& find_defect(std::string_view name);
/// The law that is not held against a defect, since its wrapper alone breaks it (`allocates`); empty: none.
[[nodiscard]] std::string_view left_out(const DefectRow& defect);

// The parts of the table.
[[nodiscard]] std::vector<DefectRow> problem_defects();   ///< defects_problem.cpp: the mechanism is misread
[[nodiscard]] std::vector<DefectRow> damping_defects();   ///< defects_damping.cpp: R⁻¹ is misread, or stale
[[nodiscard]] std::vector<DefectRow> answer_defects();    ///< defects_answer.cpp: the answer is spoilt
[[nodiscard]] std::vector<DefectRow> pair_defects();      ///< defects_pairs.cpp: ν is wrong, rows that come and go are
[[nodiscard]] std::vector<DefectRow> rank_defects();      ///< defects_rank.cpp: hard rows are called dependent wrongly
[[nodiscard]] std::vector<DefectRow> paper_defects();     ///< defects_paper.cpp: lines of the paper as printed

}  // namespace delassus::laws
