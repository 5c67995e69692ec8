#include "cli/solvers.h"

#include <cstdio>

#include "bench/text.h"
#include "simulation/solvers.h"

namespace delassus::cli {

json solvers_list() {
  json out = json::array();
  for (const simulation::SolverRow& s : simulation::solvers()) {
    json takes = {"equality rows"};
    if (s.half_lines) takes.push_back("half lines");
    if (s.boxes) takes.push_back("boxes");
    if (s.relaxed) takes.push_back("relaxed Coulomb");
    if (s.exact) takes.push_back("exact Coulomb");
    out.push_back({{"name", s.name}, {"summary", s.summary}, {"equations", s.equations}, {"certificate", s.certificate}, {"source", s.source},
                   {"cost", s.cost}, {"takes", takes}, {"hard_rows", s.hard_rows}, {"given_matrix", s.given_matrix}});
  }
  return out;
}

void print_solvers_markdown(const json& solvers) {
  std::vector<std::vector<std::string>> cells{{"solver", "what it is", "takes", "hard rows", "given matrix", "an iteration", "cost", "certificate", "source"}};
  const auto yes = [](bool b) { return std::string(b ? "yes" : "no"); };
  for (const json& s : solvers) {
    std::string takes;
    for (const std::string what : s["takes"]) takes += (takes.empty() ? "" : ", ") + what;
    cells.push_back({"`" + s["name"].get<std::string>() + "`", s["summary"], takes, yes(s["hard_rows"]), yes(s["given_matrix"]),
                     "`" + s["equations"].get<std::string>() + "`", s["cost"], s["certificate"], s["source"]});
  }
  std::printf("%s", bench::markdown_table(cells, 9).c_str());
}

}  // namespace delassus::cli
