// Tests of the tests: every defect of the table must be caught by a law, every law must catch a defect, and the right
// operators the defects were made from must keep every law.
//
//   defects [NAME …]           the matrix defect × law, and what went uncaught; only these defects
//   defects --markdown         the same as two tables for a page
//
// The matrix of the last full run is kept beside the program; --markdown prints it again when the program has not
// changed since. Exit code 0: nothing went uncaught but the open findings of
// the table; one that is caught by now has to be struck from them.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "property_tests/allocations.h"
#include "property_tests/defects.h"

namespace {

using namespace delassus;
using namespace delassus::laws;
using Names = std::vector<std::string_view>;

struct Pinned {
  const char* family;
  Index n;
  std::uint64_t seed;
};
/// Small problems that have what the defects need; `large` only for what they let pass.
constexpr Pinned pinned[] = {{"generic", 4, 1}, {"generic", 5, 2}, {"humanoid", 6, 1}, {"massless", 3, 1}, {"block_damping", 2, 1},
                             {"several_trees", 4, 1}, {"mixed_damping", 10, 1}, {"hard", 4, 1}, {"no_rows", 2, 1}};
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

/// Names of the laws this operator breaks on some case, in the order of the table.
Names broken(const DefectRow& defect, const std::vector<Case>& on) {
  Names by;
  for (const LawRow& law : laws::laws()) {
    if (law.name == left_out(defect)) continue;
    for (const Case& c : on) {
      const Outcome o = outcome(law, defect.op, c);
      if (!o.failed()) continue;
      by.push_back(law.name);
      if (defect.right())
        std::cout << defect.name << " is right and breaks " << o.law << " [" << o.label << "] " << o.verdict.ratio << ' ' << o.verdict.note << '\n';
      break;
    }
  }
  return by;
}

std::string joined(const Names& names, std::size_t most) {
  std::string text;
  for (std::size_t k = 0; k < names.size() && k < most; ++k) text += (k ? ", " : "") + std::string(names[k]);
  return names.size() > most ? text + ", …" : text;
}

struct Matrix {
  std::vector<const DefectRow*> rows;
  std::vector<Names> by;   ///< of every row
  std::map<std::string_view, Names> catches;
  int missed = 0;
};

Matrix measure(const std::vector<const DefectRow*>& rows, bool all, bool print) {
  Matrix m;
  m.rows = rows;
  const std::vector<Case> on = cases();
  for (const DefectRow* d : rows) {
    const auto start = std::chrono::steady_clock::now();
    m.by.push_back(broken(*d, on));
    if (m.by.back().empty() && !d->right()) m.by.back() = broken(*d, {make_case(large.family, large.n, large.seed)});
    m.missed += m.by.back().empty() == (d->right() || d->open) ? 0 : 1;
    if (d->open && print) std::cout << d->name << " is an open finding: " << d->open << '\n';
    for (const std::string_view law : m.by.back())
      if (!d->right()) m.catches[law].push_back(d->name);
    if (!print) continue;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%-28s %5.2f s  %3zu laws: %s\n", std::string(d->name).c_str(), seconds.count(), m.by.back().size(), joined(m.by.back(), 8).c_str());
  }
  for (const LawRow& law : laws::laws()) {
    if (!all || m.catches.count(law.name) || (law.name == "no allocation" && !allocation_count)) continue;
    std::cout << "law that catches nothing: " << law.name << '\n';
    ++m.missed;
  }
  return m;
}

std::string markdown(const Matrix& m) {
  std::ostringstream out;
  out << "| defect | made of | what is wrong | caught by laws | the first of them |\n|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < m.rows.size(); ++k)
    if (!m.rows[k]->right())
      out << "| `" << m.rows[k]->name << "` | `" << m.rows[k]->base << "` | " << m.rows[k]->what << " | " << m.by[k].size() << " | "
          << (m.rows[k]->open ? std::string("open: ") + m.rows[k]->open : joined(m.by[k], 3)) << " |\n";
  out << "\n| law | defects it catches | that no other law catches |\n|---|---|---|\n";
  for (const LawRow& law : laws::laws()) {
    Names alone;
    for (std::size_t k = 0; k < m.rows.size(); ++k)
      if (m.by[k] == Names{law.name}) alone.push_back(m.rows[k]->name);
    const auto at = m.catches.find(law.name);
    out << "| `" << law.name << "` | " << (at == m.catches.end() ? 0 : at->second.size()) << " | " << joined(alone, 9) << " |\n";
  }
  return out.str();
}

/// The page's tables of the last full run, when it was of this program.
std::string kept(const std::filesystem::path& program, const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::exists(file) || std::filesystem::last_write_time(file, none) < std::filesystem::last_write_time(program, none)) return {};
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

int run(int argc, char** argv) {
  const std::filesystem::path program = std::filesystem::canonical("/proc/self/exe"), file = program.string() + ".md";
  const bool page = argc > 1 && std::string_view(argv[1]) == "--markdown";
  if (page)
    if (const std::string text = kept(program, file); !text.empty()) return std::cout << text, EXIT_SUCCESS;
  std::vector<const DefectRow*> rows;
  for (int k = page ? argc : 1; k < argc; ++k) rows.push_back(&find_defect(argv[k]));
  const bool all = rows.empty();
  if (all)
    for (const DefectRow& d : defects()) rows.push_back(&d);
  const Matrix m = measure(rows, all, !page);
  if (all && m.missed == 0) std::ofstream(file) << markdown(m);
  if (page) std::cout << markdown(m);
  else std::cout << (m.missed == 0 ? "every defect is caught, every law catches one\n" : "FAILED\n");
  return m.missed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  count_allocations();
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "defects: " << e.what() << '\n';
    return 2;
  }
}
