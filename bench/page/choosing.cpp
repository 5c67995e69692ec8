#include "bench/page/choosing.h"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/accuracy.h"
#include "bench/page/page.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

double solve_of(const Cell& c) { return c.solve_status.empty() || !c.answered(&Phases::solve) ? NAN : c.time.solve.lowest; }
double one_solve(const Cell& c) { return c.time.update.lowest + solve_of(c); }
double many_solves(const Cell& c) { return c.time.update.lowest + 100 * solve_of(c); }
double new_damping(const Cell& c) { return c.time.new_damping.lowest + solve_of(c); }
double one_application(const Cell& c) { return c.answered(&Phases::apply) ? c.time.update.lowest + c.time.apply.lowest : NAN; }

std::string choice_cell(const Choice& c) {
  if (c.best.empty()) return "<td class=\"soft\">–</td>";
  std::string s = "<td><b>" + breakable(c.best) + "</b>";
  if (!c.second.empty()) s += "<br><small>" + breakable(c.second) + " " + three_digits(c.lead) + "×</small>";
  if (c.best != accuracy::default_rung && c.second != accuracy::default_rung && !std::isnan(c.by_default))
    s += "<br><small>" + breakable(accuracy::default_rung) + " " + three_digits(c.by_default) + "×</small>";
  return s + "</td>";
}

}  // namespace

const std::vector<UseCase>& use_cases() {
  static const std::vector<UseCase> cases{
      {"new configuration, one solve", one_solve, false},          {"one configuration, 100 solves", many_solves, false},
      {"new damping, one solve", new_damping, false},              {"one solve with error bound", one_solve, true},
      {"100 solves with error bound", many_solves, true},          {"new damping, with error bound", new_damping, true},
      {"new configuration, one application", one_application, false}};
  return cases;
}

Choice choose(const SceneResult& scene, const UseCase& use, const std::vector<OperatorInfo>& operators) {
  Choice choice;
  double best = INFINITY, second = INFINITY, of_default = NAN;
  for (std::size_t i = 0; i < scene.cells.size() && i < operators.size(); ++i) {
    if (use.certified && operators[i].solve_error != "refined") continue;
    const double t = use.cost(scene.cells[i]);
    if (operators[i].name == accuracy::default_rung) of_default = t;
    if (t < best) {
      second = best, choice.second = choice.best;
      best = t, choice.best = operators[i].name;
    } else if (t < second) {
      second = t, choice.second = operators[i].name;
    }
  }
  choice.lead = second / best;
  choice.by_default = of_default / best;
  return choice;
}

std::string choosing_section(const Results& r) {
  std::string s = "<h2 id=\"choosing\">Which operator</h2><p>The fastest for what you do again and again, below it the next and how much longer it takes, and the default "
    "where it is neither. Without error bound <em>ok</em> means that nothing broke down, not that digits are left (stiff rows: <a href=\"#accuracy\">accuracy</a>). "
    "As a rule: few rows, dense; many rows on a few bodies, the sweeps; not sure, <code>ladder</code>, which finds its own way to the accuracy asked for.</p>"
    "<div class=\"wide tables\"><table class=\"matrix\"><thead><tr><th>scene</th><th>rows</th>";
  for (const UseCase& use : use_cases()) s += std::string("<th>") + use.name + "</th>";
  s += "</tr></thead><tbody>";
  std::vector<const SceneResult*> by_rows;
  for (const SceneResult& scene : r.scenes)
    if (scene.rows > 0) by_rows.push_back(&scene);
  std::stable_sort(by_rows.begin(), by_rows.end(), [](const SceneResult* x, const SceneResult* y) { return x->rows < y->rows; });
  for (const SceneResult* scene : by_rows) {
    s += "<tr><td><a href=\"#" + escape(scene->name) + "\">" + escape(scene->name) + "</a></td><td>" + std::to_string(scene->rows) + "</td>";
    for (const UseCase& use : use_cases()) s += choice_cell(choose(*scene, use, r.operators));
    s += "</tr>";
  }
  return s + "</tbody></table></div>";
}

}  // namespace delassus::bench
