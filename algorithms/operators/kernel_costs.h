// The table of kernels: what choose.h counts with. `delassus bench --calibrate` measures it and prints kernel_costs.cpp.
#pragma once

#include <vector>

#include "algorithms/operators/choose.h"

namespace delassus {

/// A phase of a row: nanoseconds per unit of each quantity.
struct KernelCost {
  std::string_view op;
  Phase phase;
  struct Term {
    Quantities::Name quantity;
    double nanoseconds;
  };
  std::vector<Term> terms;
};
[[nodiscard]] const std::vector<KernelCost>& kernel_costs();

}  // namespace delassus
