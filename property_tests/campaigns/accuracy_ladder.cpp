// The graded problems (ladder_problems.h): 25 mechanisms at nine dampings, every rung, a = J ν.
//
//   accuracy_ladder [--judge NAME] [--family NAME] [--markdown]
//
// Exit code 1 when
//   the default (`ladder`) has no answer, or one further than 1e-10 off in motion or 1e-6 in force, on any problem;
//   any rung breaks a promise (answered.h): an answer called ok is beyond its certificate or the bound of its error class.
// --judge: another operator in the place of the default, under the default's promises.
#include "property_tests/campaigns/accuracy_ladder.h"

#include <cstdlib>
#include <iostream>
#include <sstream>

#include "cli/program/options.h"
#include "property_tests/laws/route.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

constexpr double motion_wanted = 1e-10, force_wanted = 1e-6;
constexpr std::string_view default_rung = "ladder";

struct Options {
  std::string judge, family;
  bool markdown = false;
};

LadderCell measure(const Campaign& campaign, std::size_t mechanism, std::size_t level, const Problem<double>& problem, double largest) {
  const Mechanism& m = mechanisms()[mechanism];
  const Level& l = levels[level];
  const Damping<double> damping = damping_at(l, largest, problem.structure->rows, 1);
  const Case c = make_case(problem, damping, std::string(m.family) + " n=" + std::to_string(m.n) + " at " + std::string(l.name), 1);
  const Truth truth(problem, damping);
  Question q{c, &truth, constraint_acceleration(problem, vectors<double>(problem.structure->dofs(), 1, 1)), {}};
  q.lambda = truth.solve(q.a);
  LadderCell cell{mechanism, level, {}};
  for (const OperatorRow* row : campaign.rungs) cell.answers.push_back(answered(*row, q));
  return cell;
}

/// Prints what is broken; how many.
int broken(const Campaign& campaign, const LadderCell& cell) {
  const Mechanism& m = mechanisms()[cell.mechanism];
  int count = 0;
  const auto report = [&](const OperatorRow& row, const std::string& what) {
    std::cout << m.family << " n=" << m.n << " at " << levels[cell.level].name << ", " << row.name << ": " << what << '\n';
    ++count;
  };
  for (std::size_t k = 0; k < campaign.rungs.size(); ++k) {
    const Answered& x = cell.answers[k];
    if (!x.broken.empty()) report(*campaign.rungs[k], x.broken);
    if (k != campaign.judged) continue;
    std::ostringstream off;
    off << "off by " << x.errors.motion << " in motion, " << x.errors.force << " in force, status " << name(x.report.status);
    if (!within(x, &Errors::motion, motion_wanted) || !within(x, &Errors::force, force_wanted)) report(*campaign.rungs[k], off.str());
  }
  return count;
}

int run(const Options& o) {
  if (!o.family.empty()) static_cast<void>(generators::find_family(o.family));  // throws, listing the names
  OperatorRow judged = find_operator(default_rung);
  if (!o.judge.empty()) judged.makers = find_operator(o.judge).makers;
  Campaign campaign;
  for (const OperatorRow& row : operators()) {
    if (row.name == default_rung) campaign.judged = campaign.rungs.size();
    if (row.solves && !row.maximal) campaign.rungs.push_back(row.name == default_rung ? &judged : &row);
  }
  int failures = 0;
  for (std::size_t m = 0; m < mechanisms().size(); ++m) {
    if (!o.family.empty() && o.family != mechanisms()[m].family) continue;
    const Case c = make_case(mechanisms()[m].family, mechanisms()[m].n, 1);
    const double largest = largest_eigenvalue(c.problem);
    for (std::size_t l = 0; l < std::size(levels); ++l) {
      campaign.cells.push_back(measure(campaign, m, l, c.problem, largest));
      failures += broken(campaign, campaign.cells.back());
    }
  }
  if (o.markdown) print_tables(campaign);
  else std::cout << campaign.cells.size() << " problems, " << failures << " promises broken\n";
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"The graded problems: R λmax from 1e-8 to 1e14, every rung (docs/accuracy_ladder.md).\n"
               "Exit code 1 when a promise is broken."};
  Options o;
  app.add_option("--judge", o.judge, "hold this operator to the promises of the default rung");
  app.add_option("--family", o.family, "only this mechanism");
  app.add_flag("--markdown", o.markdown, "tables for a page");
  return options::run(app, argc, argv, [&] { return run(o); });
}
