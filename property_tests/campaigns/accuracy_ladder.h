// What every rung makes of the graded problems, and the tables of it (docs/accuracy_ladder.md).
#pragma once

#include "property_tests/campaigns/ladder_problems.h"

namespace delassus::laws {

/// One problem and every rung's answer.
struct LadderCell {
  std::size_t mechanism, level;
  std::vector<Answered> answers;     ///< in the order of the rungs
};

struct Campaign {
  std::vector<const OperatorRow*> rungs;
  std::vector<LadderCell> cells;
  std::size_t judged = 0;            ///< of the rungs, the one the claim is about
};

/// Within `most` of the truth; false where there is no answer.
[[nodiscard]] inline bool within(const Answered& x, double Errors::* error, double most) {
  const bool answer = x.report.ok() || x.report.status == Status::not_converged;
  return answer && x.finite && x.errors.*error <= most;
}

/// The page's tables.
void print_tables(const Campaign& campaign);

}  // namespace delassus::laws
