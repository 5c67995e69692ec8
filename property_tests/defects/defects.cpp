#include "property_tests/defects/defects.h"

#include <algorithm>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "property_tests/defects/defects_wrong.h"

namespace delassus::laws {

const std::vector<DefectRow>& defects() {
  static const std::vector<DefectRow> table = [] {
    DefectRow unchanged = defect<Place::answer>("unchanged", "dense_cholesky, and nothing done to it", [](auto) {});
    unchanged.base = {};
    std::vector<DefectRow> all{unchanged};
    for (auto part : {problem_defects, damping_defects, answer_defects, pair_defects, rank_defects, paper_defects})
      for (DefectRow& d : part()) all.push_back(std::move(d));
    std::stable_partition(all.begin(), all.end(), [](const DefectRow& d) { return d.right(); });
    return all;
  }();
  return table;
}

const DefectRow& find_defect(std::string_view name) {
  for (const DefectRow& row : defects())
    if (row.name == name) return row;
  throw ModelError("", "defect", "there is no defect " + in_quotes(name), accepted_names(name, defects()) + "; `delassus list defects` says what each is");
}

std::string_view left_out(const DefectRow& defect) { return defect.allocates ? "no allocation" : ""; }

}  // namespace delassus::laws
