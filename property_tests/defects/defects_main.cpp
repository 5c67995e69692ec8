// Tests of the tests: every defect of the table must be caught by a law, every law must catch a defect, and the right
// operators the defects were made from must keep every law.
//
//   defects [NAME …]           what catches each defect, and what went uncaught; only these defects
//   defects --markdown         the matrix defect × law for a page
//   defects --page FILE        everything, and the page must show this matrix
//
// Exit code 0: nothing went uncaught, no right operator breaks a law.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>

#include "property_tests/unit/allocations.h"
#include "property_tests/defects/defects_matrix.h"
#include "cli/program/options.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

struct Pinned {
  const char* family;
  Index n;
  std::uint64_t seed;
};
/// Small problems that have what the defects need; `large` only for what they let pass.
constexpr Pinned pinned[] = {{"generic", 4, 1}, {"generic", 5, 2}, {"humanoid", 7, 1}, {"massless", 3, 1}, {"block_damping", 2, 1},
                             {"several_trees", 4, 1}, {"mixed_damping", 10, 1}, {"hard", 4, 1}, {"no_rows", 2, 1},
                             {"crank_rocker", 3, 1}, {"jansen", 7, 1}, {"bennett", 3, 3}};
constexpr Pinned large = {"chain", 66, 1};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Pinned& p : pinned) all.push_back(make_case(p.family, p.n, p.seed));
  return all;
}

/// The outcome, and no excuse for not converging that comes from what another law made of the case.
Outcome outcome(const LawRow& law, const OperatorRow& op, const Case& c) {
  const Outcome o = check(law, op, c);
  if (!o.skipped || std::string_view(o.skipped).substr(0, 13) != "not_converged") return o;
  return check(law, op, make_case(c.problem, c.damping, c.label, c.seed, c.exact));
}

/// Every law against one defect.
std::vector<Entry> held(const DefectRow& defect, const std::vector<Case>& on) {
  std::vector<Entry> entries;
  for (const LawRow& law : laws::laws()) {
    Entry& e = entries.emplace_back();
    for (auto c = on.begin(); c != on.end() && !e.caught && law.name != left_out(defect); ++c) {
      const Outcome o = outcome(law, defect.op, *c);
      if (o.skipped) continue;
      e.caught = o.failed();
      e.ratio = e.caught ? o.verdict.ratio : std::max(e.ratio, o.verdict.ratio);
      if (e.caught && defect.right())
        std::cout << defect.name << " is right and breaks " << o.law << " [" << o.label << "] " << o.verdict.ratio << ' ' << o.verdict.note << '\n';
    }
  }
  return entries;
}

void print(const DefectRow& defect, const std::vector<std::string_view>& by, double seconds) {
  std::printf("%-28s %5.2f s  %3zu laws:", std::string(defect.name).c_str(), seconds, by.size());
  for (std::size_t k = 0; k < by.size() && k < 8; ++k) std::printf("%s %s", k > 0 ? "," : "", std::string(by[k]).c_str());
  std::puts(by.size() > 8 ? ", …" : "");
}

DefectMatrix measure(const std::vector<const DefectRow*>& rows, bool quiet) {
  DefectMatrix m;
  const std::vector<Case> on = cases();
  for (const DefectRow* d : rows) {
    const auto start = std::chrono::steady_clock::now();
    m.defects.push_back(d);
    m.entries.push_back(held(*d, on));
    if (!d->right() && m.caught_by(m.entries.size() - 1).empty()) m.entries.back() = held(*d, {make_case(large.family, large.n, large.seed)});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (!quiet) print(*d, m.caught_by(m.entries.size() - 1), seconds.count());
  }
  return m;
}

/// Prints what went uncaught; how many.
int missed(const DefectMatrix& m, bool all) {
  std::vector<std::string> misses;
  std::set<std::string_view> catching;
  for (std::size_t d = 0; d < m.defects.size(); ++d) {
    const auto by = m.caught_by(d);
    if (by.empty() != m.defects[d]->right()) misses.push_back("defect on the wrong side: " + std::string(m.defects[d]->name));
    if (!m.defects[d]->right()) catching.insert(by.begin(), by.end());
  }
  for (const LawRow& law : laws::laws())
    if (all && !catching.contains(law.name) && !(law.name == "no allocation" && !allocation_count))
      misses.push_back("law that catches nothing: " + std::string(law.name));
  for (const std::string& miss : misses) std::cerr << miss << '\n';
  return static_cast<int>(misses.size());
}

/// Prints where the page differs; how many places.
int outdated(const DefectMatrix& m, const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const std::vector<std::string> all = differences(m, text.str());
  for (const std::string& line : all) std::cerr << file << ": " << line << '\n';
  return static_cast<int>(all.size());
}

struct Options {
  std::vector<std::string> names;
  std::string page;
  bool markdown = false;
};

int run(const Options& o) {
  std::vector<const DefectRow*> rows;
  for (const std::string& name : o.names) rows.push_back(&find_defect(name));
  if (rows.empty())
    for (const DefectRow& d : defects()) rows.push_back(&d);
  const DefectMatrix m = measure(rows, o.markdown);
  const int wrong = missed(m, o.names.empty()) + (o.page.empty() ? 0 : outdated(m, o.page));
  if (o.markdown) std::cout << page(m);
  else std::cout << (wrong == 0 ? "every defect is caught, every law catches one\n" : "FAILED\n");
  return wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  count_allocations();
  options::Command app{"Tests of the tests: every defect must be caught by a law, every law must catch a defect (docs/defects.md).\n"
               "Exit code 1 when something goes uncaught, or a right operator breaks a law."};
  Options o;
  options::Option* names = app.add_option("NAME", o.names, "these defects alone (see `delassus list defects`)");
  app.add_flag("--markdown", o.markdown, "the matrix defect × law for a page")->excludes(names);
  app.add_option("--page", o.page, "a page that must show this matrix")->excludes(names)->check(options::existing_file());
  return options::run(app, argc, argv, [&] { return run(o); });
}
