// This library's simulation, told as that of any other program (bench/peers/simulator.h).
#pragma once

#include "bench/peers/simulator.h"

namespace delassus::bench {

/// Euler at `step` with a residual asked of the solver of cones [m/s]. @throws ModelError as Simulation.
[[nodiscard]] std::unique_ptr<Simulator> own_simulator(const Scene& scene, double step, double residual, const std::vector<std::string>& without = {});

}  // namespace delassus::bench
