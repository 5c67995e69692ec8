// The catalogue of hard cases (generators/hard_cases.cpp): what every operator that solves makes of it.
//
//   hard_cases [--family NAME] [--largest N] [--markdown]
//
// The right-hand side of the tables is an acceleration that forces of about one newton cause; where that is beyond 10^±100,
// promises are held for one of about one m/s² too. The truth is truth.h. Exit code 1 when an answer breaks a promise
// (answered.h).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>

#include "generators/families_hard.h"
#include "property_tests/campaigns/answered.h"
#include "cli/program/options.h"
#include "property_tests/laws/route.h"

namespace {

using namespace delassus;
using namespace delassus::laws;
using generators::HardCase;

struct Options {
  std::string family;
  Index largest = 20000;
  bool markdown = false;
};

/// log10, one digit after the point; "exact" for 0.
std::string digits(double x) {
  if (x == 0) return "exact";
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", std::log10(x));
  return text;
}

/// λ, motion and backward error, the bound; the status when it is not ok.
std::string cell_text(const Answered& cell, bool compared) {
  const bool known = compared && cell.finite;
  std::string text = cell.report.ok() ? "" : std::string(name(cell.report.status));
  if (!known) return cell.report.ok() ? "ok" : text;
  for (const double x : {cell.errors.force, cell.errors.motion, cell.errors.backward}) {
    if (!text.empty()) text += ' ';
    text += digits(x);
  }
  if (cell.report.error_bound >= 0) text.append(" (").append(digits(cell.report.error_bound)).append(")");
  return text;
}

/// Of those that have no bound and hold a matrix of the rows the page shows dense_cholesky alone.
bool shown(const OperatorRow& row) { return row.solve_error == ErrorClass::refined || row.holds != Holds::rows_squared; }

/// Dense operators are left out where their matrix is too large to be of use, iterations in maximal coordinates where they are of none.
bool too_large(const OperatorRow& row, const Structure& s) {
  if (!shown(row) && (s.rows > 300 || s.dofs() > 1000)) return true;
  if (row.holds != Holds::sparse && s.rows > 1000) return true;
  return (row.holds == Holds::all_squared && s.dofs() > 1000) || (row.maximal && s.bodies() > 200);
}

/// A row of text per operator: one cell per size.
using Table = std::map<std::size_t, std::vector<std::string>>;

/// What is asked of a case; the first question is that of the table.
std::vector<Question> questions(const Case& c, const Truth& truth) {
  std::vector<Question> all{{c, truth.regular() ? &truth : nullptr, truth.reachable(vectors<double>(c.rows(), 1, 1)), {}}};
  const double size = all[0].a.size() > 0 ? all[0].a.cwiseAbs().maxCoeff() : 1;
  if (!(size > 1e-100 && size < 1e100)) all.push_back({c, all[0].truth, vectors<double>(c.rows(), 1, 2), {}});
  for (Question& q : all)
    if (q.truth) q.lambda = truth.solve(q.a);
  return all;
}

/// One operator's answers; `cell` becomes that to the first question. Returns how many lines it printed.
int check_operator(const HardCase& h, Index n, const OperatorRow& row, const std::vector<Question>& asked, std::string& cell) {
  std::string broken;
  for (const Question& q : asked) {
    const Answered given = answered(row, q);
    if (&q == &asked.front()) cell = cell_text(given, q.truth != nullptr);
    if (broken.empty()) broken = given.broken;
  }
  if (broken.empty()) return 0;
  std::cout << "broken: " << h.family << " n=" << n << ", " << row.name << ": " << broken << '\n';
  return 1;
}

int check_size(const HardCase& h, Index n, Table& table) {
  const Case c = make_case(h.family, n, 1);
  const Truth truth(c.problem, c.damping);
  const std::vector<Question> asked = questions(c, truth);
  int wrong = 0;
  for (std::size_t k = 0; k < operators().size(); ++k) {
    const OperatorRow& row = operators()[k];
    if (!row.solves) continue;
    table[k].emplace_back("–");
    if (!too_large(row, *c.problem.structure)) wrong += check_operator(h, n, row, asked, table[k].back());
  }
  return wrong;
}

void print(const Options& o, const HardCase& h, const Table& table) {
  const std::string family(h.family), because(h.because), what(generators::find_family(h.family).summary);
  std::cout << (o.markdown ? "\n### " : "\n") << family << '\n' << what << ". " << because << (o.markdown ? "\n\n| rung |" : "\n");
  for (const Index n : h.sizes)
    if (n <= o.largest && o.markdown) std::cout << " n = " << n << " |";
  if (o.markdown) std::cout << "\n|---|";
  for (std::size_t k = 0; o.markdown && k < table.begin()->second.size(); ++k) std::cout << "---|";
  std::cout << (o.markdown ? "\n" : "");
  for (const auto& [k, cells] : table) {
    if (o.markdown && !shown(operators()[k])) continue;
    std::cout << (o.markdown ? "| `" : "  ") << operators()[k].name << (o.markdown ? "` |" : "");
    for (const std::string& cell : cells) std::cout << (o.markdown ? " " : "; ") << cell << (o.markdown ? " |" : "");
    std::cout << '\n';
  }
}

int check_family(const Options& o, const HardCase& h) {
  int broken = 0;
  Table table;
  for (const Index n : h.sizes)
    if (n <= o.largest) broken += check_size(h, n, table);
  if (!table.empty()) print(o, h, table);
  return broken;
}

int run(const Options& o) {
  int broken = 0;
  if (!o.family.empty()) static_cast<void>(generators::find_family(o.family));  // throws, listing the names
  if (!o.markdown) std::cout << "status unless ok, log10 of λ error, motion error, backward error, (bound); one cell per size\n";
  for (const HardCase& h : generators::hard_cases())
    if (o.family.empty() || o.family == h.family) broken += check_family(o, h);
  if (!o.markdown) std::cout << '\n' << broken << " promises broken\n";
  return broken == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"The catalogue of hard cases: what every operator that solves makes of it.\n"
               "Exit code 1 when an answer breaks a promise."};
  Options o;
  app.add_option("--family", o.family, "only this family of the catalogue");
  app.add_option("--largest", o.largest, "leave out sizes above this")->check(options::whole(0))->capture_default_str();
  app.add_flag("--markdown", o.markdown, "tables for a page");
  return options::run(app, argc, argv, [&] { return run(o); });
}
