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
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "generators/build.h"
#include "property_tests/allocations.h"
#include "property_tests/kernels.h"
#include "property_tests/known.h"
#include "property_tests/krylov.h"
#include "property_tests/laws.h"
#include "property_tests/misuse.h"
#include "property_tests/one_solve.h"
#include "property_tests/plan_model.h"
#include "property_tests/rank.h"
#include "property_tests/refinement_model.h"
#include "property_tests/reuse.h"
#include "property_tests/summary.h"

/// Which of the mutants compiled in runs; 0: none.
int delassus_mutant = 0;

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

/// What does not hold, in words; empty: everything does.
using Words = std::string;

using Check = std::function<Words()>;

Words law_broken(const laws::LawRow& law, const OperatorRow& op, const laws::Case& c) {
  const laws::Outcome o = laws::check(law, op, c);
  if (!o.failed()) return {};
  std::ostringstream words;
  laws::print(words, o);
  return words.str();
}

/// What a unit test says first; empty: it passes.
class FirstFailure : public testing::EmptyTestEventListener {
 public:
  static Words of(const std::string& test) {
    static FirstFailure* const one = listening();
    one->words_.clear();
    testing::GTEST_FLAG(filter) = test;
    return RUN_ALL_TESTS() == 0 ? "" : test + ": " + one->words_;
  }
  /// Names of the unit tests that are compiled in, of the suites whose names begin so.
  static std::vector<std::string> tests(std::string_view begin) {
    std::vector<std::string> names;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int k = 0; k < all.total_test_suite_count(); ++k)
      for (int l = 0; std::string_view(all.GetTestSuite(k)->name()).starts_with(begin) && l < all.GetTestSuite(k)->total_test_count(); ++l)
        names.push_back(std::string(all.GetTestSuite(k)->name()) + "." + all.GetTestSuite(k)->GetTestInfo(l)->name());
    return names;
  }

 private:
  static FirstFailure* listening() {
    int count = 1;
    char program[] = "mutant_killer", *arguments[] = {program, nullptr};
    testing::InitGoogleTest(&count, arguments);
    testing::TestEventListeners& all = testing::UnitTest::GetInstance()->listeners();
    delete all.Release(all.default_result_printer());
    auto* const one = new FirstFailure;
    all.Append(one);  // which owns it
    return one;
  }
  void OnTestPartResult(const testing::TestPartResult& r) override {
    if (r.failed() && words_.empty()) words_ = r.summary();
  }
  Words words_;
};

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
    for (const std::string& test : FirstFailure::tests(suite)) all.push_back([test] { return FirstFailure::of(test); });
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
  for (const std::string_view op_name : names)
    for (const bool held : {true, false})
      rest.push_back([op_name, held] { return laws::lost_pivot_forgotten(find_operator(op_name), held); });
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

/// What a child leaves behind.
struct Last {
  std::size_t check;
  char words[200];
};

/// A check may take three seconds of processor time where a mutant runs; unchanged, none takes a tenth of it.
bool all_hold(const std::vector<Check>& all, Last& last) {
  const itimerval limit{{0, 0}, {3, 0}};
  for (last.check = 0; last.check < all.size(); ++last.check) {
    if (delassus_mutant != 0) setitimer(ITIMER_PROF, &limit, nullptr);
    const Words words = all[last.check]();
    if (words.empty()) continue;
    std::strncpy(last.words, words.c_str(), sizeof(last.words) - 1);
    return false;
  }
  return true;
}

double cpu_seconds(int who) {
  rusage used{};
  getrusage(who, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// Runs a mutant in a child; its wait status.
int run_child(int mutant, const std::vector<Check>& all, Last& last) {
  last = {};
  const pid_t child = fork();
  if (child == 0) {
    alarm(600);
    delassus_mutant = mutant;
    _exit(all_hold(all, last) ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

const char* outcome(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? "survived" : WEXITSTATUS(status) == 1 ? "failed" : "crashed";
  return WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGALRM ? "time" : "crashed";
}

int kill_mutants(int count, std::vector<Check> all) {
  Last& last = *static_cast<Last*>(mmap(nullptr, sizeof(Last), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  const int usual = run_child(0, all, last);
  const double unchanged = cpu_seconds(RUSAGE_CHILDREN);
  std::cout << "0 " << outcome(usual) << ' ' << unchanged << " s, and once " << cpu_seconds(RUSAGE_SELF) << " s" << std::endl;
  for (int mutant = 1; mutant <= count; ++mutant) {
    const int status = run_child(mutant, all, last);
    if (last.check < all.size()) std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(last.check), all.begin() + static_cast<std::ptrdiff_t>(last.check) + 1);
    std::replace(std::begin(last.words), std::end(last.words), '\n', ' ');
    std::cout << mutant << ' ' << outcome(status) << ' ' << last.words << std::endl;
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  int count = 0;
  std::vector<std::string_view> names;
  for (int k = 1; k < argc; ++k)
    if (std::string_view(argv[k]) == "--mutants" && k + 1 < argc) count = std::atoi(argv[++k]);
    else names.emplace_back(argv[k]);
  laws::count_allocations();
  const std::vector<Check> all = checks(names);
  Last last{};
  if (!all_hold(all, last)) {
    std::cout << "0 failed " << last.words << std::endl;
    return EXIT_FAILURE;
  }
  return kill_mutants(count, all);
}
