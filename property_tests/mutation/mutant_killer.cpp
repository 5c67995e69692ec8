// What kills mutants (mutate.py): every law on small pinned problems, until one fails. It also holds what no law looks at:
// refusals of misuse, that what an operator was used for before leaves no trace, that a lost pivot is named in every phase
// until there are better numbers; and, when named like operators: every number of a plan (`plans`), the functions of Factor
// and KktResidual (`kernels`), those of Refinement (`refinement`), cg on known spectra (`krylov`), dependent hard rows (`dependent`),
// what solves (K) once (`capped`, `elimination`, `square_root`), suites of unit tests (`Householder`, `Rungs`, …).
//
//   mutant_killer [--mutants N] OPERATOR …
//
// runs the program unchanged, then mutants 1 … N that are compiled in (mutant_batch.py), each in a process of its own that
// inherits the references' answers. For each a line «number outcome reason». What killed last is tried first.
// Exit code 1: the unchanged one does not pass.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <string>

#include "generators/build.h"
#include "property_tests/unit/allocations.h"
#include "property_tests/unit/operators/kernels.h"
#include "property_tests/mutation/killing.h"
#include "property_tests/laws/known.h"
#include "property_tests/unit/operators/krylov.h"
#include "property_tests/laws/laws.h"
#include "property_tests/unit/operators/misuse.h"
#include "property_tests/unit/operators/one_solve.h"
#include "property_tests/unit/operators/plan_model.h"
#include "property_tests/unit/operators/rank.h"
#include "property_tests/unit/operators/refinement_model.h"
#include "property_tests/unit/operators/reuse.h"
#include "property_tests/laws/summary.h"
#include "property_tests/unit/operators/wrong_damping.h"

namespace {

using namespace delassus;

struct Pinned {
  const char* family;
  Index n;
  std::uint64_t seed;
};
constexpr Pinned problems[] = {
    {"generic", 2, 1},     {"chain", 1, 1},       {"chain", 2, 1},       {"generic", 5, 1},        {"several_trees", 4, 1}, {"random_tree", 5, 1}, {"massless", 5, 1},
    {"four_bar", 4, 1},    {"redundant", 2, 1},   {"joint_friction", 4, 1}, {"block_damping", 3, 1}, {"hard", 3, 1},        {"partly_hard", 3, 1},
    {"hard_redundant", 2, 1}, {"no_rows", 4, 1},  {"no_bodies", 0, 1},      {"contacts", 1, 1},      {"star", 4, 2},        {"comb", 6, 1},
    {"mass_ratio", 4, 1},  {"near_singular", 3, 1}, {"generic", 8, 1}};
/// Structures whose plans are looked at.
constexpr Pinned plans[] = {{"generic", 5, 1}, {"generic", 13, 1},     {"lattice", 16, 1},      {"comb", 20, 1},    {"random_tree", 24, 1}, {"ring", 12, 1},
                            {"humanoid", 26, 1}, {"several_trees", 4, 1}, {"no_rows", 4, 1}, {"no_bodies", 0, 1}};

using laws::Check;
using laws::Words;

Words law_broken(const laws::LawRow& law, const OperatorRow& op, const laws::Case& c) {
  const laws::Outcome o = laws::check(law, op, c);
  if (!o.failed()) return {};
  std::ostringstream words;
  laws::print(words, o);
  return words.str();
}

/// Exact laws of every problem first: they need no bound and know no excuse.
std::vector<Check> checks(std::vector<std::string_view> names) {
  std::vector<std::string_view> suites;
  std::copy_if(names.begin(), names.end(), std::back_inserter(suites), [](std::string_view name) { return std::isupper(name[0]); });
  std::erase_if(names, [](std::string_view name) { return std::isupper(name[0]); });
  const auto asked = [&names](std::string_view part) { return std::erase(names, part) > 0; };
  const bool of_plans = asked("plans"), of_kernels = asked("kernels"), of_refinement = asked("refinement"), of_krylov = asked("krylov"), of_dependent = asked("dependent"),
             of_capped = asked("capped"), of_elimination = asked("elimination"), of_square_root = asked("square_root");
  static std::vector<laws::Case> cases;
  for (const Pinned& pinned : problems) cases.push_back(laws::make_case(pinned.family, pinned.n, pinned.seed));
  cases.push_back(laws::with_partial_blocks(laws::make_case("generic", 4, 1), 1));
  cases.push_back(laws::with_partial_blocks(laws::make_case("joint_friction", 3, 1), 4));
  cases.push_back(laws::without_freedoms());
  cases.push_back(laws::rows_on_a_free_joint());
  cases.push_back(laws::three_rows_on_one_freedom());
  std::vector<Check> all, rest;
  for (const Pinned& planned : plans) {
    if (!of_plans) break;
    const auto s = generators::build(generators::find_family(planned.family).make(planned.n, planned.seed)).problem.structure;
    for (const Matrix matrix : {Matrix::M, Matrix::M_R})
      for (const Branches branches : {Branches::with_rows, Branches::all})
        all.push_back([s, matrix, branches] { return plan_broken(make_plan(*s, matrix, branches), *s, matrix, branches); });
  }
  if (of_refinement) all.push_back(laws::stray_motion_wrong);
  if (of_refinement) all.push_back(laws::factored_mass_wrong);
  if (of_refinement) all.push_back([hard_last = laws::three_rows_on_one_freedom(2)] { return laws::refinement_wrong(hard_last); });
  if (of_refinement) all.push_back([long_chain = laws::make_case("chain", 12, 1)] { return laws::refinement_wrong(long_chain); });
  for (const std::string_view op_name : names)
    if (of_dependent) all.push_back([op_name] { return laws::dependent_rows_wrong(find_operator(op_name)); });
  for (const std::string_view op_name : names)
    if (of_krylov && op_name.starts_with("cg")) all.push_back([op_name] { return laws::krylov_wrong(find_operator(op_name)); });
  if (of_capped) all.push_back(laws::capped_inverse_limits_wrong);
  for (const laws::Case& c : cases) {
    if (!c.exact || why_no_bound(laws::Function::apply, c)) continue;
    if (of_capped) all.push_back([&c] { return laws::capped_inverse_wrong(c); });
    if (of_elimination) all.push_back([&c] { return laws::elimination_wrong(c); });
    if (of_square_root && damped(c)) all.push_back([&c] { return laws::square_root_wrong(c); });
  }
  if (of_square_root) all.push_back(laws::square_root_limits_wrong);
  for (const char* family : {"mixed_damping", "mixed_contacts", "stiff_redundant", "unequal_stack", "quadruped_feet"})
    if (of_square_root) all.push_back([c = laws::make_case(family, 6, 1)] { return laws::square_root_wrong(c); });
  for (const std::string_view suite : suites)
    for (Check& test : laws::unit_tests(suite)) all.push_back(std::move(test));
  for (const laws::Case& c : cases)
    if (of_kernels && c.exact) all.push_back([&c] { return laws::kernel_wrong(c); });
  for (const laws::Case& c : cases)
    if (of_refinement && c.exact && c.rows() > 0 && !why_no_bound(laws::Function::solve, c) && condition(c) < 1e4)
      all.push_back([&c] { return laws::refinement_wrong(c); });
  for (const laws::Case& c : cases)
    for (const std::string_view op_name : names)
      for (const laws::LawRow& law : laws::laws())
        (law.name.starts_with("exact ") ? all : rest).push_back([&law, &c, op_name] { return law_broken(law, find_operator(op_name), c); });
  for (const std::string_view op_name : names)
    for (std::size_t k = 0; k < cases.size(); ++k)
      rest.push_back([op_name, k] { return laws::trace_of_use(find_operator(op_name), cases[(k + cases.size() - 1) % cases.size()], cases[k]); });
  for (const std::string_view op_name : names) rest.push_back([op_name] { return misuse_accepted(find_operator(op_name)); });
  for (const std::string_view op_name : names) rest.push_back([op_name] { return wrong_damping_taken(find_operator(op_name)); });
  for (const std::string_view op_name : names)
    for (const bool held : {true, false})
      rest.push_back([op_name, held] { return laws::lost_pivot_forgotten(find_operator(op_name), held); });
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  int count = 0;
  std::vector<std::string_view> names;
  for (int k = 1; k < argc; ++k)
    if (std::string_view(argv[k]) == "--mutants" && k + 1 < argc) count = std::atoi(argv[++k]);
    else names.emplace_back(argv[k]);
  laws::count_allocations();
  return laws::kill_mutants(count, checks(names), 3);  // unchanged, no check takes a tenth of the three seconds
}
