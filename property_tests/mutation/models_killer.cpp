// What kills mutants (mutate.py) of the way in: unit tests of readers, scenes, contacts, kinematics and loop closing.
//
//   models_killer [--mutants N] SUITE …      suites whose names begin so
#include <cstdlib>

#include "property_tests/mutation/killing.h"

int main(int argc, char** argv) {
  int count = 0;
  std::vector<delassus::laws::Check> checks;
  for (int k = 1; k < argc; ++k)
    if (std::string_view(argv[k]) == "--mutants" && k + 1 < argc) count = std::atoi(argv[++k]);
    else
      for (auto& test : delassus::laws::unit_tests(argv[k])) checks.push_back(std::move(test));
  return delassus::laws::kill_mutants(count, checks, 20);
}
