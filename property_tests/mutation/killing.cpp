#include "property_tests/mutation/killing.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include <gtest/gtest.h>

int delassus_mutant = 0;

namespace delassus::laws {
namespace {

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

/// What a child leaves behind.
struct Last {
  std::size_t check;
  char words[200];
};

bool all_hold(const std::vector<Check>& all, Last& last, int seconds) {
  const itimerval limit{{0, 0}, {seconds, 0}};
  for (last.check = 0; last.check < all.size(); ++last.check) {
    if (delassus_mutant != 0) setitimer(ITIMER_PROF, &limit, nullptr);
    const Words words = all[last.check]();
    if (words.empty()) continue;
    std::strncpy(last.words, words.c_str(), sizeof(last.words) - 1);
    return false;
  }
  return true;
}

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// Runs a mutant in a child; its wait status.
int run_child(int mutant, const std::vector<Check>& all, Last& last, int seconds) {
  last = {};
  const pid_t child = fork();
  if (child == 0) {
    alarm(600);
    delassus_mutant = mutant;
    _exit(all_hold(all, last, seconds) ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

const char* outcome(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? "survived" : WEXITSTATUS(status) == 1 ? "failed" : "crashed";
  return WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGALRM ? "time" : "crashed";
}

void kill_all(int count, std::vector<Check> all, std::size_t short_ones, int seconds) {
  Last& last = *static_cast<Last*>(mmap(nullptr, sizeof(Last), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  for (int mutant = 1; mutant <= count; ++mutant) {
    const int status = run_child(mutant, all, last, seconds);
    if (last.check < short_ones) std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(last.check), all.begin() + static_cast<std::ptrdiff_t>(last.check) + 1);
    std::replace(std::begin(last.words), std::end(last.words), '\n', ' ');
    std::cout << mutant << ' ' << outcome(status) << ' ' << last.words << std::endl;
  }
}

}  // namespace

std::vector<Check> unit_tests(std::string_view begin) {
  std::vector<Check> out;
  for (const std::string& test : FirstFailure::tests(begin)) out.push_back([test] { return FirstFailure::of(test); });
  return out;
}

int kill_mutants(int count, std::vector<Check> checks, int limit) {
  std::vector<std::pair<double, Check>> timed;
  for (Check& check : checks) {
    const double before = cpu_seconds();
    if (const Words words = check(); !words.empty()) {
      std::cout << "0 failed " << words << std::endl;
      return EXIT_FAILURE;
    }
    timed.emplace_back(cpu_seconds() - before, std::move(check));
  }
  std::cout << "0 survived " << cpu_seconds() << " s" << std::endl;
  std::stable_sort(timed.begin(), timed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(timed.begin(), timed.end(), checks.begin(), [](auto& one) { return std::move(one.second); });
  const auto short_ones = std::count_if(timed.begin(), timed.end(), [](const auto& one) { return one.first < 0.1; });
  kill_all(count, std::move(checks), static_cast<std::size_t>(short_ones), limit);
  return EXIT_SUCCESS;
}

}  // namespace delassus::laws
