// `delassus accuracy --steps`: what a convergence (bench/accuracy/accuracy_steps.h) looks like as text and as JSON.
#pragma once

#include "bench/accuracy/accuracy_steps.h"
#include "cli/common.h"

namespace delassus::cli {

void print_steps(const accuracy::Convergence& c);
[[nodiscard]] json steps_json(const accuracy::Convergence& c);

}  // namespace delassus::cli
