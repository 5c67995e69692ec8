// The catalogue of hard cases (generators/hard_cases.cpp): what every operator that solves makes of it.
//
//   hard_cases [--family NAME] [--largest N] [--markdown]
//
// The right-hand side is an acceleration that forces of about one newton cause; the truth is truth.h. Exit code 1 when an
// answer breaks a promise (answered.h).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>

#include "generators/families_hard.h"
#include "property_tests/answered.h"
#include "property_tests/route.h"

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

/// Dense operators are left out where their matrix is too large to be of use.
bool too_large(const OperatorRow& row, const Structure& s) { return row.name == "dense_cholesky" && s.dofs() > 1000; }

/// A row of text per operator: one cell per size.
using Table = std::map<std::size_t, std::vector<std::string>>;

int check_size(const HardCase& h, Index n, Table& table) {
  const Case c = make_case(h.family, n, 1);
  const Truth truth(c.problem, c.damping);
  Question q{c, truth.regular() ? &truth : nullptr, truth.reachable(vectors<double>(c.rows(), 1, 1)), {}};
  if (q.truth) q.lambda = truth.solve(q.a);
  int broken = 0;
  for (std::size_t k = 0; k < operators().size(); ++k) {
    const OperatorRow& row = operators()[k];
    if (!row.solves) continue;
    table[k].emplace_back("–");
    if (too_large(row, *c.problem.structure)) continue;
    const Answered cell = answered(row, q);
    table[k].back() = cell_text(cell, q.truth != nullptr);
    if (cell.broken.empty()) continue;
    std::cout << "broken: " << c.label << ", " << row.name << ": " << cell.broken << '\n';
    ++broken;
  }
  return broken;
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

Options read(int argc, char** argv) {
  Options o;
  for (int k = 1; k < argc; ++k) {
    const std::string key = argv[k];
    if (key == "--markdown") o.markdown = true;
    else if (key == "--family" && k + 1 < argc) o.family = generators::find_family(argv[++k]).name;
    else if (key == "--largest" && k + 1 < argc) o.largest = std::stoll(argv[++k]);
    else throw ModelError("command line", key, "is unknown or has no value", "--family NAME --largest N --markdown");
  }
  return o;
}

int run(const Options& o) {
  int broken = 0;
  if (!o.markdown) std::cout << "status unless ok, log10 of λ error, motion error, backward error, (bound); one cell per size\n";
  for (const HardCase& h : generators::hard_cases())
    if (o.family.empty() || o.family == h.family) broken += check_family(o, h);
  if (!o.markdown) std::cout << '\n' << broken << " promises broken\n";
  return broken == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(read(argc, argv));
  } catch (const std::exception& e) {
    std::cerr << "hard_cases: " << e.what() << '\n';
    return 2;
  }
}
