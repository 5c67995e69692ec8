// What the programs that kill mutants (mutant_killer.cpp, models_killer.cpp) share: checks in children, unit tests as checks.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// Which of the mutants compiled in (mutant_batch.py) runs; 0: none.
extern int delassus_mutant;

namespace delassus::laws {

/// What does not hold, in words; empty: everything does.
using Words = std::string;
using Check = std::function<Words()>;

/// Every unit test that is compiled in, of the suites whose names begin so, as a check: it says what fails first.
[[nodiscard]] std::vector<Check> unit_tests(std::string_view begin);

/// Runs the checks unchanged, then on mutants 1 … count, each in a process of its own; for each a line «number outcome
/// reason». Cheap checks come first, and of the short ones what killed last. `limit`: seconds of processor time a check may take where a mutant runs.
/// Exit code 1: the unchanged one does not pass.
[[nodiscard]] int kill_mutants(int count, std::vector<Check> checks, int limit);

}  // namespace delassus::laws
