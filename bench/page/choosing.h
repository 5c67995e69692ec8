// Which operator for which case: the cheapest of those measured, scene by scene.
#pragma once

#include <string>
#include <vector>

#include "bench/results.h"

namespace delassus::bench {

/// What is asked again and again.
struct UseCase {
  const char* name;
  double (*cost)(const Cell&);  ///< [µs]; NaN where the operator has no such answer
  bool certified;               ///< with an error bound: operators of class refined only
};
[[nodiscard]] const std::vector<UseCase>& use_cases();

struct Choice {
  std::string best, second;   ///< names; empty: none
  double lead = 0;            ///< cost of the second over that of the best
  double by_default = 0;      ///< cost of the default over that of the best; NaN where it has no such answer
};
[[nodiscard]] Choice choose(const SceneResult& scene, const UseCase& use, const std::vector<OperatorInfo>& operators);

}  // namespace delassus::bench
