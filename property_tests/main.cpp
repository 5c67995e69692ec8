// The loop: for every operator, on every family, every law that applies.
//
//   property_tests [--op NAME] [--family NAME] [--law NAME] [--seeds K] [--shard i/n] [--verbose] [--times]
//   property_tests --table ratios|promises …       a table of docs/verification.md in place of the summary; promises: of what
//                                                   would be checked, without checking it
//
// Prints the worst ratio per law and operator and why anything was skipped. Exit code 0: every law holds; 1: not.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <stdexcept>
#include <string>

#include "property_tests/allocations.h"
#include "property_tests/law_tables.h"
#include "property_tests/summary.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

struct Options {
  std::string op, family, law, table;
  std::uint64_t seeds = 5;
  int shard = 0, shards = 1;
  bool verbose = false, times = false;
};

constexpr const char* accepted = "--op --family --law --seeds --shard --table --verbose --times";

void read_shard(const std::string& text, Options& o) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw ModelError("command line", "--shard", text, "i/n with 1 <= i <= n");
  o.shard = std::stoi(text.substr(0, slash)) - 1;
  o.shards = std::stoi(text.substr(slash + 1));
  if (o.shard < 0 || o.shard >= o.shards) throw ModelError("command line", "--shard", text, "i/n with 1 <= i <= n");
}

Options read(int argc, char** argv) {
  Options o;
  for (int k = 1; k < argc; ++k) {
    const std::string key = argv[k];
    if (key == "--verbose" || key == "--times") {
      (key == "--times" ? o.times : o.verbose) = true;
      continue;
    }
    if (k + 1 >= argc) throw ModelError("command line", key, "has no value", accepted);
    const std::string value = argv[++k];
    if (key == "--op") o.op = find_operator(value).name;
    else if (key == "--family") o.family = generators::find_family(value).name;
    else if (key == "--law") o.law = find_law(value).name;
    else if (key == "--seeds") o.seeds = std::stoull(value);
    else if (key == "--shard") read_shard(value, o);
    else if (key == "--table" && (value == "ratios" || value == "promises")) o.table = value;
    else throw ModelError("command line", key, "is unknown", accepted);
  }
  return o;
}

/// What a run is reduced to.
struct Tables {
  Summary summary;
  Ratios ratios;
  Promises promises;
};

void check_case(const Options& o, std::string_view family, const Case& c, Tables& to) {
  for (const OperatorRow& op : operators())
    for (const LawRow& law : laws::laws()) {
      if ((!o.op.empty() && op.name != o.op) || (!o.law.empty() && law.name != o.law)) continue;
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
  Tables to;
  int cell = 0;
  for (const generators::FamilyRow& family : generators::families()) {
    if (!o.family.empty() && family.name != o.family) continue;
    std::vector<Index> sizes = family.sizes;
    const bool listed = std::find(sizes.begin(), sizes.end(), family.exact_size) != sizes.end();
    if (family.exact_size >= 0 && !listed) sizes.push_back(family.exact_size);
    for (const Index n : sizes)
      for (std::uint64_t seed = 1; seed <= o.seeds; ++seed)
        if (cell++ % o.shards == o.shard) {
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
  try {
    return run(read(argc, argv));
  } catch (const std::exception& e) {
    std::cerr << "property_tests: " << e.what() << '\n';
    return 2;
  }
}
