// `delassus accuracy --simulate`: what accuracy costs in a whole simulation.
#pragma once

#include "bench/accuracy/accuracy_simulation.h"
#include "cli/common.h"
#include "cli/program/options.h"

namespace delassus::cli {

/// What is asked of `accuracy --simulate`, beside what it shares with the other forms.
struct SimulateOptions {
  std::string duration = "1s", picture;
  accuracy::SimulationOptions measured;
};

/// --duration, --step, --halvings, --integrator, --solver, --tolerance, --longest, --picture: each needs --simulate.
void add_simulate_options(options::Command& command, SimulateOptions& options, const options::Option* simulate);

[[nodiscard]] json simulated_json(const accuracy::SimulatedScene& s);
void print_simulated(const accuracy::SimulatedScene& s);

}  // namespace delassus::cli
