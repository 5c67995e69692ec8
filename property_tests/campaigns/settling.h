// Boxes that settle, measured step by step: what a step costs per contact.
#pragma once

#include <map>

#include "models/box_piles.h"
#include "property_tests/laws/laws.h"
#include "simulation/step.h"

namespace delassus {

struct Settling {
  Index islands = 0, last_contacts = 0;             ///< of the last step
  std::int64_t contacts = 0;                        ///< of all steps together
  std::int64_t iterations = 0;                      ///< of solvers, of all islands
  double iterations_at_end = 0;                     ///< of an island, mean of the steps with as many islands as the last
  std::int64_t allocations = -1;                    ///< −1: not counted
  double seconds = 0, speed = 0;                    ///< [s]; largest joint velocity at the end
  std::string wrong;                                ///< of a step that did not end well
};

/// Steps of 1 ms; those without contacts are left out of the sums.
template <class Clock> Settling settle(const Scene& scene, int steps, double residual, Clock&& clock) {
  simulation::Settings settings;
  settings.residual = residual;
  simulation::Simulation<double> s(scene, settings);
  Settling out;
  std::map<Index, std::pair<double, int>> by_islands;  // iterations of an island, steps
  for (int k = 0; k < steps; ++k) {
    const auto before = laws::allocation_count != nullptr ? laws::allocation_count() : 0;
    const double start = clock();
    const simulation::StepReport& r = s.step();
    if (!r.ok()) {
      out.wrong = r.message;
      return out;
    }
    if (r.rows == 0) continue;
    out.seconds += clock() - start;
    if (laws::allocation_count != nullptr) out.allocations = std::max<std::int64_t>(out.allocations, 0) + laws::allocation_count() - before;
    out.last_contacts = static_cast<Index>(s.rows().size()), out.islands = r.islands;
    out.contacts += out.last_contacts, out.iterations += r.iterations;
    auto& [iterations, count] = by_islands[r.islands];
    iterations += static_cast<double>(r.iterations) / static_cast<double>(r.islands), ++count;
  }
  if (const auto it = by_islands.find(out.islands); it != by_islands.end()) out.iterations_at_end = it->second.first / it->second.second;
  out.speed = s.state().nu.cwiseAbs().maxCoeff();
  return out;
}

}  // namespace delassus
