// The loop: for every operator, on every family, every law that applies.
//
//   property_tests [--op NAME] [--family NAME] [--law NAME] [--seeds K] [--shard i/n] [--table ratios|promises] [--verbose] [--times]
//                  [--defect NAME]     a wrong operator instead of all: the loop must fail
//
// Prints the worst ratio per law and operator and why anything was skipped. Exit code 0: every law holds; 1: not.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>

#include "property_tests/unit/allocations.h"
#include "property_tests/defects/defects.h"
#include "property_tests/laws/law_tables.h"
#include "cli/program/options.h"
#include "property_tests/laws/summary.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

struct Options {
  std::string op, family, law, table, defect;
  std::uint64_t seeds = 5;
  options::Shard shard;
  bool verbose = false, times = false;
};

/// What a run is reduced to.
struct Tables {
  Summary summary;
  Ratios ratios;
  Promises promises;
};

/// Of five seeds, operators that differ only in how a matrix of the rows is formed take one each, in turn, and so do iterations in
/// maximal coordinates. One that is asked for by name takes all.
bool takes(const Options& o, const OperatorRow& op, std::uint64_t seed) {
  const bool formed = op.holds == Holds::rows_squared && op.solve_error != ErrorClass::refined;
  if (!o.op.empty() || !o.table.empty() || o.seeds != 5 || !(formed || op.maximal)) return true;
  return seed - 1 == static_cast<std::uint64_t>(&op - operators().data()) % 5;
}

void check_case(const Options& o, std::string_view family, const Case& c, Tables& to) {
  std::vector<const OperatorRow*> all;
  for (const OperatorRow& op : operators()) all.push_back(&op);
  if (!o.defect.empty()) all = {&find_defect(o.defect).op};
  for (const OperatorRow* row : all)
    for (const LawRow& law : laws::laws()) {
      const OperatorRow& op = *row;
      if ((!o.op.empty() && op.name != o.op) || (!o.law.empty() && law.name != o.law) || (o.defect.empty() && !takes(o, op, c.seed))) continue;
      if (o.table == "promises") {
        to.promises.add(family, op, why_not(law, op, c));
        continue;
      }
      const Outcome outcome = check(law, op, c);
      to.summary.add(outcome);
      to.ratios.add(outcome);
      if (o.verbose || outcome.failed()) print(std::cout, outcome);
    }
}

int run(const Options& o) {
  if (!o.op.empty()) static_cast<void>(find_operator(o.op));  // these throw, listing the names
  if (!o.defect.empty()) static_cast<void>(find_defect(o.defect));
  if (!o.family.empty()) static_cast<void>(generators::find_family(o.family));
  if (!o.law.empty()) static_cast<void>(find_law(o.law));
  Tables to;
  std::uint64_t cell = 0;
  for (const generators::FamilyRow& family : generators::families()) {
    if (!o.family.empty() && family.name != o.family) continue;
    std::vector<Index> sizes = family.sizes;
    const bool listed = std::find(sizes.begin(), sizes.end(), family.exact_size) != sizes.end();
    if (family.exact_size >= 0 && !listed) sizes.push_back(family.exact_size);
    for (const Index n : sizes)
      for (std::uint64_t seed = 1; seed <= o.seeds; ++seed)
        if (cell++ % o.shard.of == o.shard.number - 1) {
          const std::clock_t start = std::clock();
          const Case c = make_case(family.name, n, seed);
          check_case(o, family.name, c, to);
          if (o.times) std::cout << static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC << " s  " << c.label << '\n';
        }
  }
  if (o.table == "promises") to.promises.print(std::cout);
  else if (o.table == "ratios") to.ratios.print(std::cout);
  else to.summary.print(std::cout);
  return to.summary.failed() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  count_allocations();
  options::Command app{"Every law that applies, on every family, for every operator.\nExit code 1 when a law is broken."};
  Options o;
  app.add_option("--op", o.op, "only this operator");
  app.add_option("--defect", o.defect, "a wrong operator instead of all (see `delassus list defects`)");
  app.add_option("--family", o.family, "only this family");
  app.add_option("--law", o.law, "only this law");
  app.add_option("--seeds", o.seeds, "problems of every family and size")->check(options::whole(1))->capture_default_str();
  options::add_shard(app, o.shard);
  app.add_option("--table", o.table, "a table of docs/verification.md in place of the summary: ratios; promises: of what would be checked, without checking it")
      ->check(options::one_of({"ratios", "promises"}));
  app.add_flag("--verbose", o.verbose, "every check");
  app.add_flag("--times", o.times, "processor time of every problem");
  return options::run(app, argc, argv, [&] { return run(o); });
}
